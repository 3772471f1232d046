// A FlatScene in the buffers of an OpenclProbe.
#pragma once

#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "src_gpu/scene/scene_arguments.hpp"
#include "tests/support/opencl_probe.hpp"

namespace kiloband::test {

/// Kernels take the scene first: `__kernel void f(KB_SCENE_PARAMS, __global const float* in, ...)`; run()
/// gives them the scene's buffers and then its own arguments.
/// Probe  OpenclProbe, or anything with its upload() and run()
template <class Probe>
class DeviceScene {
 public:
  DeviceScene(Probe& probe, const FlatScene& scene)
      : probe_(probe),
        buffers_(opencl::scene_arguments<ProbeBuffer>(
            scene, [&](const char*, const auto& values) { return probe.upload(values); })) {}

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
