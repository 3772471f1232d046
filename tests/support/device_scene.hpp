// A FlatScene in the buffers of an OpenclProbe, in the order of KB_SCENE_PARAMS (kernels/base/scene.clh).
#pragma once

#include <array>
#include <tuple>
#include <vector>

#include "film/filter_table.hpp"
#include "scene/compile/flat_scene.hpp"
#include "shared/pipeline.h"
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
    buffers_ = {up(std::vector{probe_constants(scene)}),
                up(scene.materials),
                up(scene.tables),
                up(scene.surfaces),
                up(scene.shapes),
                up(scene.textures),
                up(scene.checkerboards),
                up(scene.texels),
                up(scene.texel_bounds),
                up(bounds),
                up(scene.normals),
                up(scene.uvs),
                up(scene.positions),
                up(scene.triangles),
                up(scene.area_cdf),
                up(scene.emitters),
                up(scene.emitter_cdf),
                up(scene.envmap.marginal_cdf),
                up(scene.envmap.row_cdf),
                up(scene.media),
                up(scene.plume_nodes),
                up(scene.interiors),
                up(filter),
                up(scene.thermals)};
  }

  template <class... Args>
  void run(const char* name, std::size_t items, const Args&... args) {
    std::apply([&](const auto&... buffers) { probe_.run(name, items, buffers..., args...); }, buffers_);
  }

 private:
  Probe& probe_;
  std::array<cl::Buffer, 24> buffers_;
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
