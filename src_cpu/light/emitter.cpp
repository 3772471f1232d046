#include "src_cpu/light/emitter.hpp"

#include <cmath>

#include "src_cpu/geometry/ray_offset.hpp"
#include "src_cpu/geometry/shape_geometry_affine.hpp"
#include "src_cpu/geometry/shape_geometry_warp.hpp"
#include "src_cpu/geometry/texture_lookup.hpp"
#include "src_cpu/light/area.hpp"
#include "src_cpu/light/environment.hpp"

namespace kiloband::cpu {
namespace {

constexpr float kInvFourPi = 0.25f * KB_INV_PI;

EmittedRadiance radiance_of(const FlatScene& scene, uint32_t ref, glm::vec2 uv) {
  const ResolvedSpectrum resolved = resolve_spectrum(scene, ref, uv);
  return {resolved.row, resolved.textured, resolved.texture};
}

LightSample sample_area(const FlatScene& scene, const KbEmitter& emitter, glm::vec3 point, float u_triangle,
                        glm::vec2 u) {
  const KbShape& shape = scene.shapes[emitter.shape];
  const bool thermal = emitter.type == KB_EMITTER_THERMAL;
  const bool textured = !thermal && (emitter.ref & KB_REF_KIND_MASK) != KB_REF_SPECTRUM;
  const AreaLightSample on_light = sample_area_light(scene, shape, point, u_triangle, u, textured);
  LightSample sample;
  if (!(on_light.pdf > 0)) return sample;
  sample.direction = on_light.direction;
  sample.target = offset_ray_origin(on_light.position, on_light.normal,
                                    target_offset(on_light.offset, on_light.position - point));
  sample.pdf = on_light.pdf * emitter.select_pdf;
  sample.factor = on_light.factor;
  if (!thermal) {
    sample.radiance = radiance_of(scene, emitter.ref, on_light.uv);
    return sample;
  }
  sample.thermal = true;
  sample.on = {emitter.shape, on_light.triangle, on_light.barycentric, on_light.position};
  return sample;
}

/// Constant environments and maps. A map's density and radiance are those of the final direction, so that
/// they are the ones that a ray finds which leaves in the same direction.
LightSample sample_environment(const FlatScene& scene, const KbEmitter& emitter, glm::vec2 u) {
  LightSample sample;
  sample.infinite = true;
  sample.factor = 1;
  if (emitter.type == KB_EMITTER_CONSTANT) {
    sample.direction = warp_uniform_sphere(u);
    sample.pdf = kInvFourPi * emitter.select_pdf;
    sample.radiance = radiance_of(scene, emitter.ref, glm::vec2(0));
    return sample;
  }
  sample.direction = sample_envmap_direction(scene.envmap, emitter, u);
  const glm::vec2 uv = envmap_coordinates(emitter, sample.direction);
  const uint32_t texture = emitter.ref & KB_REF_INDEX_MASK;
  sample.pdf = envmap_density(scene.envmap, uv) * emitter.select_pdf;
  sample.radiance.textured = true;
  sample.radiance.texture = sample_envmap_texture(scene.textures[texture], texture, uv);
  return sample;
}

/// Full intensity inside the beam, then linear in the angle down to 0 at the cutoff (Mitsuba 3).
/// from_light  unit vector away from the light
float spot_falloff(const KbEmitter& emitter, glm::vec3 from_light) {
  const glm::vec3 axis = glm::normalize(affine_column<float>(emitter.to_world, 2));
  // atan2 instead of acos: beams may be far narrower than the resolution of a cosine near 1.
  const float angle = std::atan2(glm::length(glm::cross(axis, from_light)), glm::dot(axis, from_light));
  if (angle <= emitter.beam_width) return 1;
  if (angle >= emitter.cutoff_angle) return 0;
  return (emitter.cutoff_angle - angle) / (emitter.cutoff_angle - emitter.beam_width);
}

/// Points and spots: irradiance = intensity * falloff / distance^2 (the receiver's cosine is the caller's).
LightSample sample_position(const FlatScene& scene, const KbEmitter& emitter, glm::vec3 point) {
  LightSample sample;
  sample.delta = true;
  sample.target = affine_column<float>(emitter.to_world, 3);
  const glm::vec3 to_light = sample.target - point;
  const float distance2 = glm::dot(to_light, to_light);
  const float inverse = 1 / distance2;
  if (!(distance2 > 0) || std::isinf(inverse)) return sample;  // at the light itself
  sample.direction = to_light / std::sqrt(distance2);
  const float falloff = emitter.type == KB_EMITTER_SPOT ? spot_falloff(emitter, -sample.direction) : 1;
  if (!(falloff > 0)) return sample;
  sample.factor = falloff * inverse;
  sample.pdf = emitter.select_pdf;
  sample.radiance = radiance_of(scene, emitter.ref, glm::vec2(0));
  return sample;
}

LightSample sample_directional(const FlatScene& scene, const KbEmitter& emitter) {
  LightSample sample;
  sample.delta = true;
  sample.infinite = true;
  sample.direction = -glm::normalize(affine_column<float>(emitter.to_world, 2));
  sample.factor = 1;
  sample.pdf = emitter.select_pdf;
  sample.radiance = radiance_of(scene, emitter.ref, glm::vec2(0));
  return sample;
}

}  // namespace

LightSample sample_light(const FlatScene& scene, glm::vec3 point, glm::vec2 u_select, glm::vec2 u_position) {
  const auto count = static_cast<uint32_t>(scene.emitters.size());
  if (count == 0) return {};
  const uint32_t index = count == 1 ? 0 : find_interval(scene.emitter_cdf.data(), count, u_select.x);
  const KbEmitter& emitter = scene.emitters[index];
  switch (emitter.type) {
    case KB_EMITTER_AREA:
    case KB_EMITTER_THERMAL:
      return sample_area(scene, emitter, point, u_select.y, u_position);
    case KB_EMITTER_CONSTANT:
    case KB_EMITTER_ENVMAP:
      return sample_environment(scene, emitter, u_position);
    case KB_EMITTER_POINT:
    case KB_EMITTER_SPOT:
      return sample_position(scene, emitter, point);
    default:
      return sample_directional(scene, emitter);
  }
}

SurfaceHit thermal_surface(const FlatScene& scene, const ThermalPoint& on) {
  return make_surface_hit(scene, on.shape, on.triangle, on.barycentric.x, on.barycentric.y, on.position,
                          glm::vec3(0), 0);
}

float area_light_pdf(const FlatScene& scene, const SurfaceHit& hit, glm::vec3 origin) {
  const KbShape& record = scene.shapes[hit.shape];
  if (record.emitter == KB_NONE) return 0;
  const float select_pdf = scene.emitters[record.emitter].select_pdf;
  return select_pdf > 0 ? select_pdf * area_light_density(record, hit, origin) : 0;
}

float environment_pdf(const FlatScene& scene, glm::vec3 direction) {
  if (scene.environment == KB_NONE) return 0;
  const KbEmitter& emitter = scene.emitters[scene.environment];
  if (emitter.type == KB_EMITTER_CONSTANT) return kInvFourPi * emitter.select_pdf;
  if (!(emitter.select_pdf > 0)) return 0;
  return emitter.select_pdf * envmap_density(scene.envmap, envmap_coordinates(emitter, direction));
}

EmittedRadiance environment_radiance(const FlatScene& scene, glm::vec3 direction) {
  const KbEmitter& emitter = scene.emitters[scene.environment];
  if (emitter.type == KB_EMITTER_CONSTANT) return radiance_of(scene, emitter.ref, glm::vec2(0));
  const uint32_t texture = emitter.ref & KB_REF_INDEX_MASK;
  EmittedRadiance radiance;
  radiance.textured = true;
  radiance.texture =
      sample_envmap_texture(scene.textures[texture], texture, envmap_coordinates(emitter, direction));
  return radiance;
}

}  // namespace kiloband::cpu
