// Points, spots and directional lights, which BSDF samples cannot find.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_DELTA_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_DELTA_LIGHT_INL
#undef KILOBAND_DELTA_LIGHT_INL
#else
#define KILOBAND_DELTA_LIGHT_INL
#endif

#include "scene/compile/flat_scene.hpp"
#include "src_cpu/lanes/lane_math-inl.hpp"
#include "src_cpu/light/area-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// The light that reaches a point.
struct DeltaSample {
  V3 direction;  // unit, towards the light
  V3 target;     // of points and spots: where the light is
  F factor;      // irradiance on a surface that faces the light over its spectrum; 0: none
};

/// A column of the emitters' to_world; column 3 is where they are.
KB_INLINE V3 emitter_column(const FlatScene& scene, U emitter, uint32_t column) {
  const std::size_t at = offsetof(KbEmitter, to_world) + 4 * column;
  const KbEmitter* emitters = scene.emitters.data();
  return {gather_float(emitters, at, emitter), gather_float(emitters, at + 16, emitter),
          gather_float(emitters, at + 32, emitter)};
}

/// Full intensity inside the beam, then linear in the angle down to 0 at the cutoff (Mitsuba 3).
/// from_light  unit vector away from the light
KB_INLINE F spot_falloff(const FlatScene& scene, U emitter, V3 from_light) {
  const V3 axis = normalize(emitter_column(scene, emitter, 2));
  const F beam = KB_GATHER_FLOAT(scene.emitters.data(), KbEmitter, beam_width, emitter);
  const F cutoff = KB_GATHER_FLOAT(scene.emitters.data(), KbEmitter, cutoff_angle, emitter);
  // The angle of a point instead of an arc cosine: beams may be far narrower than the resolution of a cosine near 1.
  const F angle = arc_tangent(length(cross(axis, from_light)), dot(axis, from_light));
  const F between = max((cutoff - angle) / (cutoff - beam), F(0));
  return select(angle <= beam, F(1), select(angle < cutoff, between, F(0)));
}

/// Points and spots: irradiance = intensity * falloff / distance^2 (the receiver's cosine is the caller's).
KB_INLINE DeltaSample sample_position(const FlatScene& scene, U emitter, M spot, V3 point) {
  DeltaSample sample;
  sample.target = emitter_column(scene, emitter, 3);
  const V3 to_light = sample.target - point;
  const F distance2 = dot(to_light, to_light);
  const F inverse = F(1) / distance2;
  const M apart = (distance2 > F(0)) & (inverse < F(kInfinity));  // else at the light itself
  sample.direction = to_light * select(apart, F(1) / sqrt(distance2), F(0));
  sample.factor = select(apart, inverse, F(0));
  if (any(spot)) {
    const F falloff = spot_falloff(scene, emitter, -sample.direction);
    sample.factor = select(apart & spot, sample.factor * falloff, sample.factor);
  }
  return sample;
}

KB_INLINE DeltaSample sample_directional(const FlatScene& scene, U emitter) {
  return {-normalize(emitter_column(scene, emitter, 2)), {F(0), F(0), F(0)}, F(1)};
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
