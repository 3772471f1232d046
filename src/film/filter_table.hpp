// Sampling the truncated Gaussian reconstruction filter: the inverse of its distribution,
// exactly and as a table.
//
// The filter is Mitsuba's: f(x) = exp(-x^2/2) - exp(-r^2/2) on |x| < r, with x and r in standard deviations.
// With G(x) = integral of f from x to r, the tail probability of a distance x >= 0 is w = G(x) / G(0); x is
// found from w = 2 min(u, 1-u) and gets the sign of u - 1/2.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "shared/lang.h"

namespace kiloband {

/// Pieces of the table; it has one node more.
inline constexpr int kFilterPieces = 1024;

/// x in [0, ratio] with the tail probability w in [0, 1]; |error| < 1e-12 ratio.
/// ratio  radius / standard deviation, > 0
double invert_gaussian_tail(double w, double ratio);

/// x(q), q = sqrt(w), as cubic Hermite pieces: node i (value, slope per piece) is at q = i / kFilterPieces.
/// In q the inverse is smooth up to the end of the support, where f falls to 0 linearly and w quadratically.
/// For ratios in [0.1, 4] (4 is Mitsuba's) the error is below 1.1e-7 ratio. Below it grows to 2e-5 next to
/// the end. Above, the curve is so steep there that the first two pieces are coarse; it stays monotone, and
/// they hold one sample in 250 000.
///
/// throws  std::logic_error  ratio is not > 0
std::vector<KbFloat2> make_gaussian_filter_table(double ratio);

/// Distance from the centre in standard deviations for the tail probability w in [0, 1], from such a table.
inline float gaussian_distance(const std::vector<KbFloat2>& table, float w) {
  const float position = std::sqrt(w) * kFilterPieces;
  const int i = std::min(static_cast<int>(position), kFilterPieces - 1);
  const float t = position - static_cast<float>(i);
  const KbFloat2& a = table[static_cast<std::size_t>(i)];
  const KbFloat2& b = table[static_cast<std::size_t>(i) + 1];
  const float rise = b.x - a.x;
  const float c2 = 3 * rise - 2 * a.y - b.y, c3 = a.y + b.y - 2 * rise;
  return a.x + t * (a.y + t * (c2 + t * c3));
}

}  // namespace kiloband
