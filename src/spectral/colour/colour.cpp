#include "spectral/colour/colour.hpp"

#include <algorithm>
#include <cmath>

#include "spectral/colour/cie_tables.hpp"

namespace kiloband {
namespace {

/// Mitsuba 3's d65 spectrum divides the CIE's table by this.
constexpr double kD65Normalisation = 98.99741751876255;

Spectrum from_table(const CieTable& values, double divisor = 1) {
  std::vector<double> lambda_nm(kCieEntries), scaled(values.begin(), values.end());
  const double step_nm = (kCieMaxNm - kCieMinNm) / (kCieEntries - 1);
  for (int i = 0; i < kCieEntries; ++i) lambda_nm[static_cast<std::size_t>(i)] = kCieMinNm + step_nm * i;
  for (double& value : scaled) value /= divisor;
  return Spectrum::tabulated(std::move(lambda_nm), std::move(scaled));
}

}  // namespace

const Spectrum& cie_x() {
  static const Spectrum spectrum = from_table(kCieX);
  return spectrum;
}

const Spectrum& cie_y() {
  static const Spectrum spectrum = from_table(kCieY);
  return spectrum;
}

const Spectrum& cie_z() {
  static const Spectrum spectrum = from_table(kCieZ);
  return spectrum;
}

const Spectrum& illuminant_d65() {
  static const Spectrum spectrum = from_table(kCieD65, kD65Normalisation);
  return spectrum;
}

std::array<double, 3> xyz_to_linear_srgb(const std::array<double, 3>& xyz) {
  const auto [x, y, z] = xyz;
  return {3.240479 * x - 1.537150 * y - 0.498535 * z, -0.969256 * x + 1.875991 * y + 0.041556 * z,
          0.055648 * x - 0.204043 * y + 1.057311 * z};
}

double srgb_decode(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

double srgb_encode(double linear) {
  linear = std::clamp(linear, 0.0, 1.0);
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace kiloband
