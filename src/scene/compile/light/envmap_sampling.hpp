// Importance sampling of lat-long environment maps: building EnvmapSampling.
//
// Cells are the patches of the bilinear interpolation, not texels: for a map of W x H texels there are
// W columns, cell j on u in [(j + 0.5) / W, (j + 1.5) / W) modulo 1 (columns are texel-centred), and
// max(H - 1, 1) rows, cell i on v in [i / rows, (i + 1) / rows) (rows align-corners). Within a cell
// directions are uniform in solid angle: v = theta / pi goes with cos theta, u linearly.
//
// Cells lie in regions of 2^row_shift rows and 2^column_shift columns, at most kMostRegionsDown x kMostRegionsAcross. A direction is chosen
// from the coarse to the fine: with a facing f (shared/environment.h) the row R of regions and the region C in it, in the region the row r of
// cells, in that the cell c. The density [1/sr] is the product of the four probabilities, differences of neighbours in
//
//   facing_cdf[f * (D + 1 + D (A + 1)) ..]      D + 1 entries over R, then A + 1 entries over C for each R
//   row_cdf[(R A + C) (2^row_shift + 1) ..]     over the rows of cells of the region
//   column_cdf[(i A + C) (2^column_shift + 1) ..]   over the cells of the region in the map's row i
//
// (A regions across, D down) over the cell's solid angle (2 pi / W) * (cos(pi i / rows) - cos(pi (i+1) / rows)).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/compile/flat_scene.hpp"

namespace kiloband {

/// The share of samples that are uniform over the sphere, but for what facings prefer: bounds radiance / density
/// where the guide bands see nothing.
inline constexpr double kEnvmapUniformShare = 0.01;

inline constexpr uint32_t kMostRegionsDown = 16, kMostRegionsAcross = 32;

/// A cell's weight is what the integral of the map over its solid angle, interpolated between its 4 texels, has above that of the map's mean,
/// else 0, mixed with kEnvmapUniformShare of the uniform density (all of it if the map is even): MIS compensation (Karlik et al.,
/// MIS Compensation: Optimizing Sampling Techniques in Multiple Importance Sampling, ACM TOG 38(6), 2019). Light that comes from
/// everywhere is found by rays that BSDFs choose, with multiple importance sampling; samples of the map go where it is brighter.
/// For a facing the weights of a region's cells are scaled by envmap_facing_weights(): a product of map and cosine.
/// Measured: validation/results/environments.md. Cumulative values are
/// multiples of 2^-24 and every cell of a region, every region but those that a facing does not see, has at least one unit: probabilities are
/// exact in float.
/// texel_weights  mean radiance of each texel over the guide bands, finite and >= 0, [row][column],
///                row 0 at v = 0
/// throws std::logic_error  width or height 0 or above 65536, a size that does not fit, more than 2^32 entries of a table, an invalid weight
EnvmapSampling build_envmap_sampling(uint32_t width, uint32_t height, std::span<const float> texel_weights);

/// What the texels of each row count in the mean of the map over the sphere: the integral over the solid
/// angle of the row's part in the interpolation, scaled so that the mean of all rows is 1. The sines of
/// the rows' own angles would not do: both rows of a map of two lie at the poles. height >= 1
std::vector<double> row_solid_angles(uint32_t height);

}  // namespace kiloband
