// Samples of area lights on shapes that are no meshes, and of thermal ones: light-inl.hpp has all others, over lanes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "scene/compile/flat_scene.hpp"
#include "src_cpu/geometry/texture/texture_lookup.hpp"

namespace kiloband::cpu {

/// A point of a thermally emitting shape.
struct ThermalPoint {
  uint32_t shape = KB_NONE;
  uint32_t triangle = 0;  // meshes: in the shape, and the point's weights of its second and third vertex
  glm::vec2 barycentric{0};
  glm::vec3 position{0};
};

/// One sample of direct light at a point.
struct LightSample {
  glm::vec3 direction{0};     // unit, from the shaded point towards the light
  glm::vec3 target{0};        // the point on the light, moved off its surface towards its front
  float pdf = 0;              // solid angle times selection probability [1/sr]; 0: no sample
  float factor = 0;           // incident radiance = factor * spectrum; about 1
  ResolvedSpectrum radiance;  // without MIS weight
  bool thermal = false;  // `radiance` is not set: the surface there emits towards -direction (thermal.hpp)
  ThermalPoint on;       // if thermal
};

/// An emitter that has been selected.
struct SelectedLight {
  uint32_t emitter;
  float probability;
  uint32_t triangle;  // of a mesh, by the light tree; KB_NONE: not yet
  float area;         // of the triangle, m^2
};
/// A point on it, or a direction towards one. Spheres are sampled over the cone that they subtend from outside, over their area from
/// inside; other shapes over their area. Points that a one-sided area light does not shine to give pdf 0.
/// u_triangle  chooses the triangle of a mesh where the light tree has not
LightSample sample_shape_light(const FlatScene& scene, const SelectedLight& selected, glm::vec3 point,
                               float u_triangle, glm::vec2 u);

}  // namespace kiloband::cpu
