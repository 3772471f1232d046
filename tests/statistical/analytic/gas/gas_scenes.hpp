// Pieces of scenes with gas, a spectrum of lines, and its line-by-line quadrature.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "tests/statistical/analytic/analytic_test.hpp"

namespace kiloband::test {

/// A comb of Lorentz lines, taken at a step of a fiftieth of their half width as piecewise linear data: both
/// the scene and the quadrature mean these very data, so that no line shape is approximated.
struct LineComb {
  double first_nm = 4500, last_nm = 4510;
  double spacing_nm = 1, half_width_nm = 0.05;
  double peak = 1;  // 1/m
  std::vector<double> lambda_nm, kappa;

  explicit LineComb(double peak_per_m, double half_width = 0.05, double least = 0)
      : half_width_nm(half_width), peak(peak_per_m) {
    const double step = half_width_nm / 10;
    for (double x = first_nm; x <= last_nm + 1e-9; x += step) {
      double sum = least;
      for (double line = first_nm + 0.5; line < last_nm; line += spacing_nm)
        sum += peak / (1 + std::pow((x - line) / half_width_nm, 2));
      lambda_nm.push_back(x);
      kappa.push_back(sum);
    }
  }

  std::string text() const {
    std::string lambdas, values;
    for (std::size_t i = 0; i < kappa.size(); ++i) {
      lambdas += vec_number(lambda_nm[i]);
      values += vec_number(kappa[i]);
    }
    return "<spectrum type=\"irregular\" name=\"absorption\"><string name=\"wavelengths\" value=\"" +
           lambdas + "\"/><string name=\"values\" value=\"" + values + "\"/></spectrum>";
  }

  /// Integral over the channel of f(lambda, kappa), f smooth in both:
  /// Simpson's rule on eight parts of every piece.
  template <class F>
  double integral(const Channel& channel, const F& f) const {
    double sum = 0;
    for (std::size_t i = 1; i < kappa.size(); ++i) {
      const double low = std::max(lambda_nm[i - 1], channel.min_nm),
                   high = std::min(lambda_nm[i], channel.max_nm);
      if (!(low < high)) continue;
      constexpr int kParts = 8;
      const double step = (high - low) / kParts;
      for (int j = 0; j <= kParts; ++j) {
        const double x = low + j * step;
        const double t = (x - lambda_nm[i - 1]) / (lambda_nm[i] - lambda_nm[i - 1]);
        const double weight = j == 0 || j == kParts ? 1 : j % 2 ? 4 : 2;
        sum += weight * step / 3 * f(x, (1 - t) * kappa[i - 1] + t * kappa[i]);
      }
    }
    return sum;
  }

 private:
  static std::string vec_number(double x) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.17g ", x);
    return buffer;
  }
};

inline std::string medium(const std::string& type, const std::string& name, const std::string& content) {
  return "<medium type=\"" + type + "\"" + (name.empty() ? "" : " name=\"" + name + "\"") + ">" + content +
         "</medium>";
}
/// Gas that absorbs, and emits at a temperature above 0.
inline std::string gas(const std::string& name, const std::string& absorption, double temperature_k = 0) {
  return medium("absorbing", name,
                absorption + (temperature_k > 0 ? real("temperature", temperature_k) : ""));
}
inline const std::string kNull = bsdf("null");

/// A rectangle at z = 0 that faces +z and radiates without reflecting.
inline std::string black_lamp(const std::string& radiance) {
  return shape("rectangle", diffuse(0) + emitter("area", radiance));
}
inline std::string black_wall() {
  return shape("rectangle", diffuse(0));
}
/// A box [-1, 1]^2 across, from z0 to z1.
inline std::string slab(double z0, double z1, const std::string& content) {
  return shape("cube", to_world(scale(1, 1, (z1 - z0) / 2) + translate(0, 0, (z1 + z0) / 2)) + content);
}
/// Looks down on the origin from z = 2.0001: rays begin at z = 2 and arrive perpendicularly within 1e-6.
inline std::string straight_camera(uint32_t size) {
  return perspective(lookat("0.0123, 0.0057, 2.0001", "0.0123, 0.0057, 0"), 0.05, film(size));
}

}  // namespace kiloband::test
