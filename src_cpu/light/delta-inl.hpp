// Points, spots, projectors and directional lights, which BSDF samples cannot find.
//
// Spots and projectors throw pictures: with (x, y, z) the direction away from the light in the coordinates of to_object, whose x and y
// are scaled so that the picture's borders are at x, y = +-z, the picture is looked up at 1/2 + (x, y) / 2z. A spot's intensity is
// multiplied by it. A projector's picture P says what a plane across its axis gets at distance 1, E = scale P at every place. That
// plane is seen from the lamp at the distance 1 / cos theta, tilted by theta, cos theta = z: its intensity is I = E / cos^3 theta, and a
// surface at distance d that faces it gets I / d^2.
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
  V2 uv;         // of the spectrum, where it is a picture
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

/// A direction away from the light in the coordinates of to_object.
KB_INLINE V3 to_picture(const FlatScene& scene, U emitter, V3 from_light) {
  const KbEmitter* emitters = scene.emitters.data();
  const auto row = [&](std::size_t i) KB_LAMBDA {
    const std::size_t at = offsetof(KbEmitter, to_object) + 16 * i;
    return dot(V3{gather_float(emitters, at, emitter), gather_float(emitters, at + 4, emitter),
                  gather_float(emitters, at + 8, emitter)},
               from_light);
  };
  return {row(0), row(1), row(2)};
}

/// Where in the picture the point is, and for projectors whether it is in it at all, and how much light.
KB_INLINE void look_up_picture(const FlatScene& scene, U emitter, M pictured, M projector,
                               DeltaSample& sample) {
  const V3 local = to_picture(scene, emitter, -sample.direction);
  const F inverse = F(1) / local.z;
  const V2 uv{F(0.5f) + F(0.5f) * (local.x * inverse), F(0.5f) + F(0.5f) * (local.y * inverse)};
  sample.uv = {select(pictured, uv.x, F(0)), select(pictured, uv.y, F(0))};
  if (!any(projector)) return;
  const M inside = (local.z > F(0)) & (uv.x >= F(0)) & (uv.x <= F(1)) & (uv.y >= F(0)) & (uv.y <= F(1));
  const F scale = KB_GATHER_FLOAT(scene.emitters.data(), KbEmitter, scale, emitter);
  const F lit = sample.factor * (scale * (inverse * inverse * inverse));
  sample.factor = select(projector, select(inside & (lit < F(kInfinity)), lit, F(0)), sample.factor);
}

/// Points and spots: irradiance = intensity * falloff / distance^2 (the receiver's cosine is the caller's); projectors as above.
KB_INLINE DeltaSample sample_position(const FlatScene& scene, U emitter, M spot, M projector, V3 point) {
  DeltaSample sample;
  sample.uv = {F(0), F(0)};
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
  if (!scene.features.projected_light) return sample;
  const U ref = KB_GATHER_WORD(scene.emitters.data(), KbEmitter, ref, emitter);
  const M pictured = apart & (projector | (spot & has_bits(ref, KB_REF_KIND_MASK)));
  if (any(pictured)) look_up_picture(scene, emitter, pictured, apart & projector, sample);
  return sample;
}

KB_INLINE DeltaSample sample_directional(const FlatScene& scene, U emitter) {
  return {-normalize(emitter_column(scene, emitter, 2)), {F(0), F(0), F(0)}, F(1), {F(0), F(0)}};
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
