// Adaptive quadrature of functions that are smooth between known points.
#pragma once

#include <functional>
#include <span>

namespace kiloband {

/// Relative, of integrals of spectra, whose interface promises 1e-9.
inline constexpr double kSpectrumTolerance = 1e-10;

/// Integral of f from breaks.front() to breaks.back(). f is smooth between neighbouring breaks and is never
/// evaluated AT a break, so that it may jump there.
/// breaks              ascending, at least 2
/// relative_tolerance  of the integral of |f|; pieces with the largest estimated error are halved until their
///                     sum meets it
/// source              Gauss-Kronrod pair (7, 15): QUADPACK, Piessens et al. 1983
double integrate(const std::function<double(double)>& f, std::span<const double> breaks,
                 double relative_tolerance);

}  // namespace kiloband
