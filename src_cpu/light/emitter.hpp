// Light selection, sampling and densities on the CPU.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "scene/compile/flat_scene.hpp"
#include "shared/environment.h"
#include "src_cpu/geometry/surface_hit.hpp"

namespace kiloband::cpu {

/// What is seen at an emitting point or direction: a spectrum row or a texture sample,
/// both without MIS weight.
struct EmittedRadiance {
  uint16_t row = 0;
  bool textured = false;
  KbTextureSample texture{};  // if textured
};

/// A point of a thermally emitting shape, for thermal_surface().
struct ThermalPoint {
  uint32_t shape = KB_NONE;
  uint32_t triangle = 0;  // meshes: in the shape, and the point's weights of its second and third vertex
  glm::vec2 barycentric{0};
  glm::vec3 position{0};
};

/// One sample of direct light at a point.
struct LightSample {
  glm::vec3 direction{0};  // unit, from the shaded point towards the light
  /// Area and positional lights: the point on the light, moved off its surface towards its front.
  glm::vec3 target{0};
  bool infinite = false;  // environment and directional lights, suns: no target
  bool delta = false;     // cannot be hit by BSDF sampling
  /// Solid angle times selection probability [1/sr]; delta lights: selection probability; 0: no sample.
  float pdf = 0;
  /// Incident radiance (or, for delta lights, irradiance) = factor * spectrum; about 1 for area lights.
  float factor = 0;
  EmittedRadiance radiance;
  bool thermal = false;  // `radiance` is not set: the surface there emits towards -direction (thermal.hpp)
  ThermalPoint on;       // if thermal
};

/// Selects an emitter by FlatScene::emitter_cdf (u_select.x) and a triangle of a mesh (u_select.y), or both by the light
/// tree if there is one (shared/light_tree.h), then a point or direction on it (u_position). Spheres are sampled over the cone that they subtend from outside, over their
/// area from inside; other shapes over their area; environment maps by their texels; constant environments
/// over the sphere; suns over their discs. Points that a one-sided area light does not shine to give pdf 0.
/// facing  of the receiver (shared/environment.h): environment maps are sampled for it, and take finer digits from u_select.y
LightSample sample_light(const FlatScene& scene, glm::vec3 point, glm::vec2 u_select, glm::vec2 u_position,
                         uint32_t facing = KB_ALL_FACINGS);

/// An emitter that has been selected.
struct SelectedLight {
  uint32_t emitter;
  float probability;
  uint32_t triangle;  // of a mesh, by the light tree; KB_NONE: not yet
  float area;         // of the triangle, m^2
};
/// The same of an area light or a thermal one that has been selected. Lanes (light-inl.hpp) sample meshes themselves.
LightSample sample_shape_light(const FlatScene& scene, const SelectedLight& selected, glm::vec3 point,
                               float u_triangle, glm::vec2 u);

/// The surface that a thermal light's sample lies on; apart from the sample, which most lights do without.
SurfaceHit thermal_surface(const FlatScene& scene, const ThermalPoint& on);

/// Density with which sample_light() gives the direction from `origin` to a hit of an area light (its shape,
/// point and normals); selection included [1/sr]. 0 where the light does not emit to there (on_front()) or
/// cannot be sampled.
/// origin  the `point` that was given to sample_light(): for spheres the density depends on its side
float area_light_pdf(const FlatScene& scene, const SurfaceHit& hit, glm::vec3 origin);

/// Density with which sample_light() gives a receiver of this facing a direction that escapes to the environment;
/// 0 without environment [1/sr].
float environment_pdf(const FlatScene& scene, glm::vec3 direction, uint32_t facing = KB_ALL_FACINGS);
/// The same of a sun, by its index; 0 beside its disc. direction: a unit vector towards it
float sun_pdf(const FlatScene& scene, uint32_t emitter, glm::vec3 direction);
/// What the environment sends from `direction` (a unit vector towards it); scene.environment must exist.
EmittedRadiance environment_radiance(const FlatScene& scene, glm::vec3 direction);

}  // namespace kiloband::cpu
