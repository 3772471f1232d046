// What all steps of compiling a scene share; see flatten.cpp for their order. Internal to src/scene.
#pragma once

#include "scene/compile/extent.hpp"
#include "scene/compile/flat_scene.hpp"
#include "scene/compile/spectra/spectrum_table_builder.hpp"

namespace kiloband {

/// The mesh whose shape is compiled, or null.
struct CurrentMesh {
  const Mesh* mesh = nullptr;
  std::size_t lookups = 0;  // how often something of it was asked for
};

struct CompileContext {
  const SceneDescription& in;
  const CompileOptions& options;
  FlatScene& out;
  SpectrumTableBuilder& spectra;
  CurrentMesh& mesh;
  GroupExtents& extents;
};

}  // namespace kiloband
