// Environment emitters: environment.hpp in lanes, and what escaped rays find. A scene has one at most.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_ENVIRONMENT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_ENVIRONMENT_INL
#undef KILOBAND_ENVIRONMENT_INL
#else
#define KILOBAND_ENVIRONMENT_INL
#endif

#include "src_cpu/geometry/texture/texture-inl.hpp"
#include "src_cpu/lanes/lane_sampler-inl.hpp"
#include "src_cpu/light/area-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// Map coordinates of a world direction: u in [0, 1), v in [0, 1].
KB_INLINE V2 envmap_coordinates(const KbEmitter& emitter, V3 direction) {
  const V3 d = transform_vector(emitter.to_object, direction);
  const F turn = arc_tangent(d.x, -d.z) * F(0.5f * KB_INV_PI);
  const F u = select(turn < F(0), turn + F(1), turn);
  // The angle of a point instead of an arc cosine: exact near the poles.
  const F v = arc_tangent(sqrt(d.x * d.x + d.z * d.z), d.y) * F(KB_INV_PI);
  return {select(u < F(1), u, F(0)), min(v, F(1))};
}

/// A value drawn from a piecewise constant distribution: the cell and where u fell in it, in [0, 1).
struct CellSample {
  U cell;
  F fraction;
};

/// first: where in cdf the distribution begins
KB_INLINE CellSample sample_cell(const float* cdf, U first, uint32_t count, F u) {
  const U cell = find_interval(cdf, first, U(count), u);
  const F low = gather(cdf, first + cell), high = gather(cdf + 1, first + cell);
  return {cell, min((u - low) / (high - low), F(KB_ONE_MINUS_EPSILON))};
}

/// Unit world direction; u, v uniform in [0,1)^2.
KB_INLINE V3 sample_envmap_direction(const EnvmapSampling& sampling, const KbEmitter& emitter, F u, F v) {
  const CellSample row = sample_cell(sampling.marginal_cdf.data(), U(0u), sampling.height, v);
  const CellSample column =
      sample_cell(sampling.row_cdf.data() + kArrayMiddle, row.cell * U(sampling.width + 1) - U(kArrayMiddle),
                  sampling.width, u);

  // Uniform in solid angle within the row: h = sin^2(theta / 2) = (1 - cos theta) / 2 is uniform. Rows of the
  // lower half are mirrored, so that h stays small near either pole
  // and sin theta = 2 sqrt(h (1 - h)) keeps its digits.
  const auto height = static_cast<float>(sampling.height);
  const F upper_row = to_floats(row.cell);
  const M lower = F(2) * upper_row >= F(height);
  const F from_pole = select(lower, F(height - 1) - upper_row, upper_row);
  const F step(0.25f / height);  // theta / 2 of a row, in turns
  const F sin0 = sin_cos_of_turns(step * from_pole).sin,
          sin1 = sin_cos_of_turns(step * (from_pole + F(1))).sin;
  const F h0 = sin0 * sin0, h1 = sin1 * sin1;
  const F h = h0 + (h1 - h0) * row.fraction;
  const F sin_theta = F(2) * sqrt(h * (F(1) - h)), cos_upper = F(1) - F(2) * h;

  const F map_u =
      (to_floats(column.cell) + F(0.5f) + column.fraction) / F(static_cast<float>(sampling.width));
  const SinCos phi = sin_cos_of_turns(map_u);
  const V3 local{phi.sin * sin_theta, select(lower, -cos_upper, cos_upper), -(phi.cos * sin_theta)};
  return normalize(transform_vector(emitter.to_world, local));
}

/// Density at map coordinates [1/sr].
KB_INLINE F envmap_density(const EnvmapSampling& sampling, V2 uv) {
  const auto rows = static_cast<float>(sampling.height);
  const auto columns = static_cast<float>(sampling.width);
  const F row = min(max(floor(uv.y * F(rows)), F(0)), F(rows - 1));
  const F shifted = floor(uv.x * F(columns) - F(0.5f));
  const F column = select(shifted < F(0), F(columns - 1), min(shifted, F(columns - 1)));
  const float* marginal = sampling.marginal_cdf.data();
  const float* row_cdf = sampling.row_cdf.data();
  const U i = to_words(row), j = i * U(sampling.width + 1) + to_words(column);
  const F probability = (gather(marginal + 1, i) - gather(marginal, i)) *
                        (gather_from_large(row_cdf + 1, j) - gather_from_large(row_cdf, j));
  // Solid angle of the cell: 2 pi / columns * (cos theta0 - cos theta1), the difference as a product of sines. The
  // sine of a row's middle is that of its mirror image in the upper half, where the angle has more digits.
  const F half_step(0.25f / rows);  // in turns
  const F middle = (F(2) * min(row, F(rows - 1) - row) + F(1)) * half_step;
  return probability * F(columns) /
         (F(4 * KB_PI) * sin_cos_of_turns(middle).sin * sin_cos_of_turns(half_step).sin);
}

/// A direction towards the scene's environment; u, v uniform in [0,1)^2.
KB_INLINE V3 sample_environment_direction(const FlatScene& scene, F u, F v) {
  const KbEmitter& emitter = scene.emitters[scene.environment];
  if (emitter.type == KB_EMITTER_CONSTANT) return uniform_sphere(u, v);
  return sample_envmap_direction(scene.envmap, emitter, u, v);
}

/// Where a direction lies on the scene's environment; constant ones have no coordinates.
KB_INLINE V2 environment_coordinates(const FlatScene& scene, V3 direction) {
  const KbEmitter& emitter = scene.emitters[scene.environment];
  if (emitter.type == KB_EMITTER_CONSTANT) return {F(0), F(0)};
  return envmap_coordinates(emitter, direction);
}

/// Density with which light is sampled from there, selection included [1/sr].
KB_INLINE F environment_pdf(const FlatScene& scene, V2 uv) {
  const KbEmitter& emitter = scene.emitters[scene.environment];
  if (emitter.type == KB_EMITTER_CONSTANT) return F(0.25f * KB_INV_PI * emitter.select_pdf);
  return F(emitter.select_pdf) * envmap_density(scene.envmap, uv);
}

KB_INLINE Resolved environment_radiance(const FlatScene& scene, V2 uv, M active) {
  const KbEmitter& emitter = scene.emitters[scene.environment];
  if (emitter.type == KB_EMITTER_CONSTANT) return resolve(scene, U(emitter.ref), place_at(uv), active);
  const uint32_t texture = emitter.ref & KB_REF_INDEX_MASK;
  return {U(0u), active, sample_envmap_texture(scene.textures[texture], texture, uv)};
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
