// Sampling of reconstruction filters that may be negative.
//
// A pixel's value is I = (integral of f(x) f(y) L(x, y)) / (integral of f)^2. Offsets are drawn from |f| / A with
// A = integral of |f|, so each sample is sign(f(x) f(y)) L times c^2, c = A / (integral of f): paths carry the sign
// (KB_VERTEX_NEGATIVE), the film multiplies by c^2. Variance grows by c^4 at most; where L is constant the
// signs alone leave (c^4 - 1) L^2 (Ernst, Stamminger, Greiner 2006).
//
// f is symmetrical and tabulated by kFilterPieces cells of equal width over [0, radius]: a cell is chosen by the
// modulus of its integral, the offset is uniform in it and its sign is that of the integral. What is sampled is thus f's mean
// over each cell: where L has an edge of height h, I is wrong by at most h |f'| w^2 / 8 with cells of w pixels (1e-6 h at
// a radius of 2).
#pragma once

#include <functional>
#include <vector>

#include "film/filter_table.hpp"

namespace kiloband {

struct SignedFilter {
  /// kFilterPieces + 1 probabilities of all cells before, so 0 first and 1 last; then the kFilterPieces signs of the cells'
  /// integrals, 1 or -1.
  std::vector<float> cells;
  double scale = 1;       // c^2
  bool negative = false;  // whether any cell is
};

/// Cubics of Mitchell and Netravali (1988) at x >= 0 in pixels; 0 from 2 on. b = 0, c = 1/2: Catmull and Rom's spline.
double mitchell(double x, double b, double c);
/// sinc(x) sinc(x / radius), sinc(x) = sin(pi x) / (pi x), at x >= 0 in pixels; 0 from the radius on.
double lanczos(double x, double radius);

/// f  at x in [0, radius], smooth within cells
/// throws  std::logic_error  the integral of f is not positive
SignedFilter make_signed_filter(const std::function<double(double)>& f, double radius);

}  // namespace kiloband
