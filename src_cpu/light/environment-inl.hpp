// Environment emitters: constant radiance and lat-long maps, and what escaped rays find. A scene has one at most.
// Densities are without the probability of selection.
//
// The map (emitter's local frame, +Y up): u = atan2(x, -z) / 2 pi mod 1, v = acos(y) / pi, as in Mitsuba 3.
// The emitter's to_world is a rotation or reflection (uniform scale does not matter).
// How maps are sampled: scene/compile/light/envmap_sampling.hpp.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_ENVIRONMENT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_ENVIRONMENT_INL
#undef KILOBAND_ENVIRONMENT_INL
#else
#define KILOBAND_ENVIRONMENT_INL
#endif

#include "shared/environment.h"
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

/// Facing (shared/environment.h) of receivers in an environment's frame.
KB_INLINE U facing_of(const KbEmitter& emitter, V3 normal) {
  const V3 n = transform_vector(emitter.to_object, normal);
  const F scale = F(1) / (abs(n.x) + abs(n.y) + abs(n.z));
  const F x = n.x * scale, z = n.z * scale;
  const M below = n.y < F(0);
  const auto fold = [](F a, F b) KB_LAMBDA { return select(a < F(0), abs(b) - F(1), F(1) - abs(b)); };
  const auto cell = [](F c) KB_LAMBDA {
    constexpr float kAcross = KB_FACINGS_ACROSS;
    const F place = (c + F(1)) * F(0.5f * kAcross);
    const F inside = select(place > F(0), place, F(0));  // NaN, too
    return to_words(select(inside < F(kAcross - 1), inside, F(kAcross - 1)));
  };
  return cell(select(below, fold(x, z), x)) + cell(select(below, fold(z, x), z)) * U(KB_FACINGS_ACROSS);
}

/// A value drawn from a piecewise constant distribution: the cell and where u fell in it, in [0, 1).
struct CellSample {
  U cell;
  F fraction;
};

/// first: where in cdf the distribution begins; digits: of u beyond its 24 bits, in [0, 1)
KB_INLINE CellSample sample_cell(const float* cdf, U first, uint32_t count, F u, F digits) {
  const U cell = find_interval(cdf, first, U(count), u);
  const F low = gather(cdf, first + cell), high = gather(cdf + 1, first + cell);
  return {cell, min(((u - low) + digits * F(0x1p-24f)) / (high - low), F(KB_ONE_MINUS_EPSILON))};
}

/// Where the distributions of a map begin in their arrays.
struct EnvmapPlaces {
  const EnvmapSampling& sampling;
  uint32_t down, across, rows, columns;  // regions of the map, cells of a region

  KB_INLINE explicit EnvmapPlaces(const EnvmapSampling& of)
      : sampling(of),
        down(of.regions_down()),
        across(of.regions_across()),
        rows(1u << of.row_shift),
        columns(1u << of.column_shift) {}
  KB_INLINE U region_rows(U facing) const { return facing * U(down + 1 + down * (across + 1)); }
  KB_INLINE U region_columns(U facing, U region_row) const {
    return region_rows(facing) + U(down + 1) + region_row * U(across + 1);
  }
  KB_INLINE U cell_rows(U region_row, U region_column) const {
    return (region_row * U(across) + region_column) * U(rows + 1);
  }
  /// Of an array that may have 2^32 entries.
  KB_INLINE U cell_columns(U row, U region_column) const {
    return (row * U(across) + region_column) * U(columns + 1);
  }
};

/// Unit world direction for a facing. u, v uniform in [0,1)^2; spare: another such number, for finer digits of both
KB_INLINE V3 sample_envmap_direction(const EnvmapSampling& sampling, const KbEmitter& emitter, U facing, F u,
                                     F v, F spare) {
  const EnvmapPlaces at(sampling);
  const float* facings = sampling.facing_cdf.data();
  const F scaled = spare * F(KB_FINER_DIGITS), whole = floor(scaled);
  const CellSample down = sample_cell(facings, at.region_rows(facing), at.down, v, scaled - whole);
  const CellSample across = sample_cell(facings, at.region_columns(facing, down.cell), at.across, u,
                                        whole * F(1 / KB_FINER_DIGITS));
  const CellSample row = sample_cell(sampling.row_cdf.data(), at.cell_rows(down.cell, across.cell), at.rows,
                                     down.fraction, F(0));
  const U map_row = down.cell * U(at.rows) + row.cell;
  const CellSample column =
      sample_cell(sampling.column_cdf.data() + kArrayMiddle,
                  at.cell_columns(map_row, across.cell) - U(kArrayMiddle), at.columns, across.fraction, F(0));

  // Uniform in solid angle within the row: h = sin^2(theta / 2) = (1 - cos theta) / 2 is uniform. Rows of the
  // lower half are mirrored, so that h stays small near either pole
  // and sin theta = 2 sqrt(h (1 - h)) keeps its digits.
  const auto height = static_cast<float>(sampling.height);
  const F upper_row = to_floats(map_row);
  const M lower = F(2) * upper_row >= F(height);
  const F from_pole = select(lower, F(height - 1) - upper_row, upper_row);
  const F step(0.25f / height);  // theta / 2 of a row, in turns
  const F sin0 = sin_cos_of_turns(step * from_pole).sin,
          sin1 = sin_cos_of_turns(step * (from_pole + F(1))).sin;
  const F h0 = sin0 * sin0, h1 = sin1 * sin1;
  const F h = h0 + (h1 - h0) * row.fraction;
  const F sin_theta = F(2) * sqrt(h * (F(1) - h)), cos_upper = F(1) - F(2) * h;

  const F map_column = to_floats(across.cell * U(at.columns) + column.cell);
  const F map_u = (map_column + F(0.5f) + column.fraction) / F(static_cast<float>(sampling.width));
  const SinCos phi = sin_cos_of_turns(map_u);
  const V3 local{phi.sin * sin_theta, select(lower, -cos_upper, cos_upper), -(phi.cos * sin_theta)};
  return normalize(transform_vector(emitter.to_world, local));
}

/// Of an entry of a distribution.
KB_INLINE F difference(const float* cdf, U index) {
  return gather(cdf + 1, index) - gather(cdf, index);
}

/// Density at map coordinates, for a facing [1/sr].
KB_INLINE F envmap_density(const EnvmapSampling& sampling, V2 uv, U facing) {
  const EnvmapPlaces at(sampling);
  const auto rows = static_cast<float>(sampling.height);
  const auto columns = static_cast<float>(sampling.width);
  const F row = min(max(floor(uv.y * F(rows)), F(0)), F(rows - 1));
  const F shifted = floor(uv.x * F(columns) - F(0.5f));
  const F column = select(shifted < F(0), F(columns - 1), min(shifted, F(columns - 1)));
  const U i = to_words(row), j = to_words(column);
  const U down = shift_right(i, sampling.row_shift), across = shift_right(j, sampling.column_shift);
  const U k = at.cell_columns(i, across) + (j & U(at.columns - 1));
  const float* facings = sampling.facing_cdf.data();
  const float* column_cdf = sampling.column_cdf.data();
  const F probability =
      difference(facings, at.region_rows(facing) + down) *
      difference(facings, at.region_columns(facing, down) + across) *
      difference(sampling.row_cdf.data(), at.cell_rows(down, across) + (i & U(at.rows - 1))) *
      (gather_from_large(column_cdf + 1, k) - gather_from_large(column_cdf, k));
  // Solid angle of the cell: 2 pi / columns * (cos theta0 - cos theta1), the difference as a product of sines. The
  // sine of a row's middle is that of its mirror image in the upper half, where the angle has more digits.
  const F half_step(0.25f / rows);  // in turns
  const F middle = (F(2) * min(row, F(rows - 1) - row) + F(1)) * half_step;
  return probability * F(columns) /
         (F(4 * KB_PI) * sin_cos_of_turns(middle).sin * sin_cos_of_turns(half_step).sin);
}

/// A direction towards the scene's environment for receivers of a facing; u, v, spare uniform in [0,1)^3.
KB_INLINE V3 sample_environment_direction(const FlatScene& scene, U facing, F u, F v, F spare) {
  const KbEmitter& emitter = scene.emitters[scene.environment];
  if (emitter.type == KB_EMITTER_CONSTANT) return uniform_sphere(u, v);
  return sample_envmap_direction(scene.envmap, emitter, facing, u, v, spare);
}

/// Where a direction lies on the scene's environment; constant ones have no coordinates.
KB_INLINE V2 environment_coordinates(const FlatScene& scene, V3 direction) {
  const KbEmitter& emitter = scene.emitters[scene.environment];
  if (emitter.type == KB_EMITTER_CONSTANT) return {F(0), F(0)};
  return envmap_coordinates(emitter, direction);
}

/// Density with which light is sampled from there for a facing, selection included [1/sr].
KB_INLINE F environment_pdf(const FlatScene& scene, V2 uv, U facing) {
  const KbEmitter& emitter = scene.emitters[scene.environment];
  if (emitter.type == KB_EMITTER_CONSTANT) return F(0.25f * KB_INV_PI * emitter.select_pdf);
  return F(emitter.select_pdf) * envmap_density(scene.envmap, uv, facing);
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
