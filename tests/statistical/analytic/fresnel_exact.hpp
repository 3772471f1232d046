// Fresnel's formulas in double, written independently of the renderer's: complex amplitudes straight from the
// boundary conditions (Born, Wolf, Principles of Optics, 1.5.2 and 14.2).
#pragma once

#include <cmath>
#include <complex>

namespace kiloband::test {

/// Unpolarised reflectance of a boundary towards the (complex) relative index N = n - i k; cos_i in [0, 1].
inline double fresnel_reflectance(double cos_i, std::complex<double> index) {
  const std::complex<double> sin2 = 1 - cos_i * cos_i;
  const std::complex<double> cos_t = std::sqrt(1.0 - sin2 / (index * index));
  const std::complex<double> s = (cos_i - index * cos_t) / (cos_i + index * cos_t);
  const std::complex<double> p = (index * cos_i - cos_t) / (index * cos_i + cos_t);
  return 0.5 * (std::norm(s) + std::norm(p));
}

/// eta: transmitted over incident index; exactly 1 beyond the critical angle.
inline double dielectric_reflectance(double cos_i, double eta) {
  if (1 - cos_i * cos_i >= eta * eta) return 1;
  return fresnel_reflectance(cos_i, eta);
}

/// Diffuse reflectance 2 int_0^1 R(c) c dc by the midpoint rule, error below 1e-6 for eta > 1.
inline double diffuse_reflectance(double eta) {
  constexpr int kSteps = 100000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double c = (i + 0.5) / kSteps;
    sum += dielectric_reflectance(c, eta) * c;
  }
  return 2 * sum / kSteps;
}

}  // namespace kiloband::test
