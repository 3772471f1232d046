// Suns: directional lights with an angular radius.
//
// A sun fills the cone of directions w within an angle r of the axis a towards it with a constant radiance L. A plane that
// faces a gets E = L int cos = pi L sin^2 r: spectra are those of E, KbEmitter::scale is L / E. Light samples are uniform in
// the cone, of density 1 / (2 pi (1 - cos r)): the height 1 - cos theta is uniform in [0, 1 - cos r). Rays that escape find
// the sun where 2 (1 - cos theta) = |w - a|^2 is not above 2 (1 - cos r). Cosines themselves would be 1 in float: for
// the sun of the Earth 1 - cos r is 1e-5, and |w - a| is known to 2e-5 of r.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_SUN_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_SUN_INL
#undef KILOBAND_SUN_INL
#else
#define KILOBAND_SUN_INL
#endif

#include "src_cpu/geometry/surface_hit-inl.hpp"
#include "src_cpu/light/delta-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// A direction of the sun's disc, unit; u, v uniform in [0,1)^2.
KB_INLINE V3 sample_sun_direction(const FlatScene& scene, U emitter, F u, F v) {
  const F cone = KB_GATHER_FLOAT(scene.emitters.data(), KbEmitter, one_minus_cos, emitter);
  const Frame frame = make_frame(-normalize(emitter_column(scene, emitter, 2)));
  const F height = u * cone;
  const F sin_theta = sqrt(height * (F(2) - height));
  const SinCos phi = sin_cos_of_turns(v);
  return normalize(frame.to_world({phi.cos * sin_theta, phi.sin * sin_theta, F(1) - height}));
}

/// Density of the directions above, with the probability of selection [1/sr].
KB_INLINE F sun_density(F one_minus_cos, F select_pdf) {
  return select_pdf * (F(0.5f * KB_INV_PI) / one_minus_cos);
}

/// Whether a ray that escapes in this direction, a unit vector, meets the sun.
KB_INLINE M meets_sun(const KbEmitter& sun, V3 direction) {
  const float* m = sun.to_world;
  const V3 off = direction + normalize(V3{F(m[2]), F(m[6]), F(m[10])});
  return dot(off, off) <= F(2 * sun.one_minus_cos);
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
