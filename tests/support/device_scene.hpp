// A FlatScene in the buffers of an OpenclProbe.
#pragma once

#include <vector>

#include "film/filter_table.hpp"
#include "scene/compile/flat_scene.hpp"
#include "shared/pipeline.h"
#include "src_gpu/device/kernel_groups.hpp"
#include "tests/support/opencl_probe.hpp"

namespace kiloband::test {

/// What kernels read of a scene beside its arrays.
inline KbSceneConstants probe_constants(const FlatScene& scene) {
  KbSceneConstants c{};
  c.camera = scene.camera;
  c.channels = static_cast<uint32_t>(scene.channels.size());
  c.emitter_count = static_cast<uint32_t>(scene.emitters.size());
  c.environment = scene.environment;
  c.max_depth = KB_NONE;
  c.unit_row = scene.unit_row;
  c.envmap_width = scene.envmap.width;
  c.envmap_height = scene.envmap.height;
  c.atmosphere = scene.atmosphere;
  if (scene.camera.filter == KB_FILTER_GAUSSIAN)
    c.filter_ratio = scene.camera.filter_radius / scene.camera.filter_stddev;
  return c;
}

/// Kernels take the scene first: `__kernel void f(KB_SCENE_PARAMS, __global const float* in, ...)`; run()
/// gives them the scene's buffers and then its own arguments.
/// Probe  OpenclProbe, or anything with its upload() and run()
template <class Probe>
class DeviceScene {
 public:
  DeviceScene(Probe& probe, const FlatScene& scene) : probe_(probe) {
    std::vector<float> bounds;
    for (const SpectrumRow& row : scene.spectra) bounds.push_back(row.bound);
    std::vector<KbFloat2> filter;
    if (scene.camera.filter == KB_FILTER_GAUSSIAN)
      filter = make_gaussian_filter_table(scene.camera.filter_radius / scene.camera.filter_stddev);
    const auto up = [&](const auto& values) { return probe.upload(values); };
    buffers_ = {.constants = up(std::vector{probe_constants(scene)}),
                .materials = up(scene.materials),
                .tables = up(scene.tables),
                .surfaces = up(scene.surfaces),
                .shapes = up(scene.shapes),
                .textures = up(scene.textures),
                .checkerboards = up(scene.checkerboards),
                .texels = up(scene.texels),
                .texel_values = {},
                .texel_bounds = up(scene.texel_bounds),
                .spectrum_bounds = up(bounds),
                .normals = up(scene.normals),
                .uvs = up(scene.uvs),
                .positions = up(scene.positions),
                .triangles = up(scene.triangles),
                .area_cdf = up(scene.area_cdf),
                .emitters = up(scene.emitters),
                .emitter_cdf = up(scene.emitter_cdf),
                .envmap_marginal = up(scene.envmap.marginal_cdf),
                .envmap_rows = up(scene.envmap.row_cdf),
                .media = up(scene.media),
                .plume_nodes = up(scene.plume_nodes),
                .interiors = up(scene.interiors),
                .filter_table = up(filter),
                .channel_bins = up(scene.channel_bins),
                .thermals = up(scene.thermals)};
  }

  template <class... Args>
  void run(const char* name, std::size_t items, const Args&... args) {
    probe_.run(name, items, buffers_, args...);
  }

 private:
  Probe& probe_;
  opencl::SceneArguments::Of<ProbeBuffer> buffers_;
};

/// One KbPrimitive per triangle of a mesh and per analytic shape, in the order of the shapes.
inline std::vector<KbPrimitive> primitives_of(const FlatScene& scene) {
  std::vector<KbPrimitive> primitives;
  for (uint32_t s = 0; s < scene.shapes.size(); ++s) {
    const KbShape& shape = scene.shapes[s];
    const uint32_t count = shape.type == KB_SHAPE_MESH ? shape.triangle_count : 1;
    for (uint32_t i = 0; i < count; ++i) {
      KbPrimitive primitive{};
      primitive.shape = s;
      primitive.primitive = i;
      primitive.analytic = shape.type;
      for (int k = 0; k < 3 && shape.type == KB_SHAPE_MESH; ++k) {
        const std::size_t index = 3 * (std::size_t{shape.first_triangle} + i) + static_cast<std::size_t>(k);
        const KbFloat3& p = scene.positions[scene.triangles[index]];
        primitive.corner[3 * k] = p.x;
        primitive.corner[3 * k + 1] = p.y;
        primitive.corner[3 * k + 2] = p.z;
      }
      primitives.push_back(primitive);
    }
  }
  return primitives;
}

}  // namespace kiloband::test
