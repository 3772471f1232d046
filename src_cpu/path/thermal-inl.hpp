// Thermal emission along paths: of what is hit, and of what light is sampled from. What a surface emits is asked for one lane after another
// (src_cpu/light/thermal.hpp).
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_THERMAL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_THERMAL_INL
#undef KILOBAND_THERMAL_INL
#else
#define KILOBAND_THERMAL_INL
#endif

#include "shared/sampler.h"
#include "src_cpu/light/thermal.hpp"
#include "src_cpu/path/shading-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// x, y: of what is hit; z, w: of light samples. path: of one lane
inline KbFloat4 thermal_numbers(const Shading& s, uint32_t path) {
  return kb_thermal_sample(s.bounce.settings.seed, s.wave.paths[path].film_pixel, s.bounce.id.sample,
                           s.bounce.number);
}

/// What thermal_radiance() reads of hits, in memory.
struct ThermalHits {
  V3Array normal, tangent, towards;
  FloatArray u, v;  // texture coordinates
  WordArray shape;
  const RayQueue& rays;
  uint32_t first;

  KB_INLINE explicit ThermalHits(const Shading& s)
      : normal(s.hit.shading_normal),
        tangent(s.hit.tangent),
        towards(-s.direction),
        u(s.hit.uv.x),
        v(s.hit.uv.y),
        shape(s.hit.shape),
        rays(s.wave.rays()),
        first(s.first) {}

  ThermalRadiance radiance(const FlatScene& scene, uint32_t i, const KbFloat4& numbers) const {
    SurfaceHit hit{};
    hit.shading_normal = normal[i];
    hit.tangent = tangent[i];
    hit.uv = {u[i], v[i]};
    hit.shape = shape[i];
    hit.triangle = rays.primitive[first + i];
    hit.barycentric = {rays.u[first + i], rays.v[first + i]};
    return thermal_radiance(scene, hit, towards[i], {numbers.x, numbers.y});
  }
};

/// Kirchhoff's law, for surfaces that emit by it. Returns the lanes of those. What has only the ambient temperature is not sampled as a
/// light: it is found by this ray alone.
inline M add_thermal_emission(Shading& s, M hit) {
  const FlatScene& scene = s.scene();
  const U flags = KB_GATHER_WORD(scene.surfaces.data(), KbSurface, flags, s.hit.surface);
  const M thermal = hit & has_bits(flags, KB_SURFACE_THERMAL), light = s.hit.emitter != U(KB_NONE);
  const bool hides = s.bounce.number == 0 && scene.integrator.hide_emitters;
  const M asked = hides ? thermal & !light : thermal;
  if (!any(asked)) return thermal;
  const ThermalHits hits(s);
  const WordArray paths(s.path);
  FloatArray weights{F(0)};
  RadianceArrays radiances(s.vertex.emission);
  each_lane(asked, [&](uint32_t i) KB_LAMBDA {
    const ThermalRadiance emitted = hits.radiance(scene, i, thermal_numbers(s, paths[i]));
    weights[i] = emitted.weight;
    radiances.put(i, emitted.radiance);
  });
  F weight = weights;
  const M emits = asked & (weight > F(0)), weighted = emits & light & !s.previous_delta();
  if (any(weighted)) {
    const U emitter = select(weighted, s.hit.emitter, U(0u));
    const F pdf = area_light_pdf(scene, s.hit, emitter, load(s.wave.rays().primitive + s.first),
                                 s.previous_point(), weighted);
    weight = select(weighted, weight * power_heuristic(s.previous_pdf(), pdf), weight);
  }
  s.vertex.set(emits, KB_VERTEX_EMIT);
  s.vertex.emit_weight = select(emits, weight, F(0));
  s.vertex.emission = select(emits, radiances.lanes(), s.vertex.emission);
  s.vertex.set(emits & s.vertex.emission.textured, KB_VERTEX_TEX_EMIT);
  return thermal;
}

/// A metal's energy compensation has two parts, a and a F0: one of them is taken, for light and BSDF sample alike.
KB_INLINE void choose_compensation(Shading& s, M scatters) {
  const M metal = scatters & has_bits(s.material.flags, KB_MATERIAL_COMPENSATED) &
                  (eval_kind(s.material.type, s.material.flags) == U(KB_KIND_CONDUCTOR));
  if (!any(metal)) return;
  const M second = metal & !(s.u.x < lobe_albedo(s.material, s.wi, metal));
  s.vertex.a = select(second, s.vertex.b, s.vertex.a);
  s.material.bound_a = select(second, s.material.bound_b, s.material.bound_a);
}

/// A light sample in scenes with thermal emission: what a thermally emitting surface sends is known once its direction is.
inline Light sample_thermal_lights(const Shading& s, M active) {
  const FlatScene& scene = s.scene();
  const Receiver receiver = s.receiver();
  const F4 u = s.numbers(kb_block_light(s.bounce.number));
  const ChosenLight chosen = choose_light(scene, receiver.point, u, active);
  const M thermal = active & (chosen.head.type == U(KB_EMITTER_THERMAL));
  const Light light = sample_chosen({scene, s.bounce.lights}, chosen, receiver, u, active & !thermal);
  if (!any(thermal)) return light;
  const WordArray paths(s.path);
  return sample_shape_lights(
      scene, chosen, receiver.point, u, thermal, light, [&](uint32_t i, LightSample& one) KB_LAMBDA {
        if (!one.thermal) return;
        const KbFloat4 v = thermal_numbers(s, paths[i]);
        const ThermalPoint& on = one.on;
        const SurfaceHit hit = make_surface_hit(scene, on.shape, on.triangle, on.barycentric.x,
                                                on.barycentric.y, on.position, glm::vec3(0), 0);
        const ThermalRadiance emitted = thermal_radiance(scene, hit, -one.direction, {v.z, v.w});
        one.factor *= emitted.weight;
        one.radiance = emitted.radiance;
      });
}

/// A light sample, in scenes of either kind.
KB_INLINE Light sample_lights(const Shading& s, M active) {
  if (s.scene().features.thermal) return sample_thermal_lights(s, active);
  return sample_lights({s.scene(), s.bounce.lights}, s.receiver(), s.numbers(kb_block_light(s.bounce.number)),
                       active);
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
