// Thermal emission along paths: of what is hit, and of what light is sampled from.
#include "shared/sampler.h"
#include "src_cpu/light/thermal.hpp"
#include "src_cpu/path/rare_features.hpp"

namespace kiloband::cpu::one_lane {
namespace {

KbFloat4 thermal_numbers(const Shading& s) {
  const uint32_t pixel = s.wave.paths[s.path.v].film_pixel;
  return kb_thermal_sample(s.bounce.settings.seed, pixel, s.bounce.id.sample, s.bounce.number);
}

Resolved to_lanes(const EmittedRadiance& radiance) {
  const KbTextureSample& t = radiance.texture;
  return {U(radiance.row), {radiance.textured}, {U(t.texture), U(t.xy), F(t.fx), F(t.fy)}};
}

Light to_lanes(const LightSample& light) {
  return {to_lane(light.direction),
          to_lane(light.target),
          light.pdf,
          light.factor,
          {light.infinite},
          {light.delta},
          to_lanes(light.radiance)};
}

}  // namespace

SurfaceHit surface_hit(const Shading& s) {
  const RayQueue& rays = s.wave.rays();
  SurfaceHit hit;
  hit.point = to_glm(s.hit.point);
  hit.geometric_normal = to_glm(s.hit.geometric_normal);
  hit.shading_normal = to_glm(s.hit.shading_normal);
  hit.tangent = to_glm(s.hit.tangent);
  hit.offset = s.hit.offset.v;
  hit.departure = to_glm(s.hit.departure);
  hit.uv = to_glm(s.hit.uv);
  hit.shape = s.hit.shape.v;
  hit.triangle = rays.primitive[s.first];
  hit.barycentric = {rays.u[s.first], rays.v[s.first]};
  return hit;
}

/// What has only the ambient temperature is not sampled as a light: it is found by this ray alone.
bool add_thermal_emission(Shading& s) {
  const FlatScene& scene = s.scene();
  const KbShape& shape = scene.shapes[s.hit.shape.v];
  if (!(scene.surfaces[shape.surface].flags & KB_SURFACE_THERMAL)) return false;
  const bool light = shape.emitter != KB_NONE;
  if (light && s.bounce.number == 0 && scene.integrator.hide_emitters) return true;
  const KbFloat4 u = thermal_numbers(s);
  const ThermalRadiance emitted = thermal_radiance(scene, surface_hit(s), -to_glm(s.direction), {u.x, u.y});
  if (!(emitted.weight > 0)) return true;
  F weight = emitted.weight;
  if (light && !s.previous_delta().v) {
    const U triangle = s.wave.rays().primitive[s.first];
    const F pdf = area_light_pdf(scene, s.hit, U(shape.emitter), triangle, s.previous_point(), {true});
    weight = weight * power_heuristic(s.previous_pdf(), pdf);
  }
  s.vertex.set({true}, KB_VERTEX_EMIT);
  s.vertex.set({emitted.radiance.textured}, KB_VERTEX_TEX_EMIT);
  s.vertex.emit_weight = weight;
  s.vertex.emission = to_lanes(emitted.radiance);
  return true;
}

void choose_compensation(Shading& s) {
  const KbMaterial& material = s.scene().materials[s.side.v];
  if (!(material.flags & KB_MATERIAL_COMPENSATED) || cpu::eval_kind(material) != KB_KIND_CONDUCTOR) return;
  if (s.u.x.v < lobe_albedo(s.material, s.wi, {true}).v) return;
  s.vertex.a = s.vertex.b;
  s.material.bound_a = s.material.bound_b;
}

/// What a thermally emitting surface sends is known once its direction is.
Light choose_thermal_light(const Shading& s) {
  const F4 u = s.numbers(kb_block_light(s.bounce.number));
  LightSample light =
      sample_light(s.scene(), to_glm(s.hit.point), {u.x.v, u.y.v}, {u.z.v, u.w.v}, s.receiver().facing.v);
  if (!light.thermal) return to_lanes(light);
  const KbFloat4 v = thermal_numbers(s);
  const ThermalRadiance emitted =
      thermal_radiance(s.scene(), thermal_surface(s.scene(), light.on), -light.direction, {v.z, v.w});
  light.factor *= emitted.weight;
  light.radiance = emitted.radiance;
  return to_lanes(light);
}

}  // namespace kiloband::cpu::one_lane
