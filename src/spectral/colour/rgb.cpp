#include "spectral/colour/rgb.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/error.hpp"
#include "spectral/colour/colour.hpp"
#include "spectral/colour/sigmoid_solver.hpp"
#include "spectral/files/text_table.hpp"

namespace kiloband {
namespace {

const char* const kComponents[3] = {"red", "green", "blue"};

void require_components(const Rgb& rgb, double largest, const char* rule) {
  for (int k = 0; k < 3; ++k)
    if (!std::isfinite(rgb[k]) || rgb[k] < 0 || rgb[k] > largest)
      throw InputError(std::string("rgb: ") + kComponents[k] + " " + format_number(rgb[k]) + ": " + rule);
}

/// Y of a linear sRGB colour: the grey that a search starts from.
double luminance(const Rgb& rgb) {
  return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

/// From grey straight to the colour; where that gets stuck, along the line from grey
/// to the colour in small steps.
Vec3 solve_polynomial(const Rgb& rgb) {
  constexpr double kGoal = 1e-9;
  constexpr int kMaxIterations = 200, kSteps = 32;
  static const ColourQuadrature<double> quadrature(3);
  const double grey = luminance(rgb);
  const Vec3 start = {0, 0, flat_sigmoid(grey)};
  Vec3 direct = start;
  const double direct_error = fit_sigmoid(quadrature, rgb, direct, kGoal, kMaxIterations);
  if (direct_error < 1e-6) return direct;
  Vec3 stepped = start;
  double stepped_error = 0;
  for (int i = 1; i <= kSteps; ++i) {
    // Steps shrink towards the colour: near the cube's faces the coefficients run off to infinity.
    const double left = std::pow(1 - static_cast<double>(i) / kSteps, 3);
    Rgb between;
    for (int k = 0; k < 3; ++k) between[k] = rgb[k] + left * (grey - rgb[k]);
    stepped_error = fit_sigmoid(quadrature, between, stepped, kGoal, kMaxIterations);
  }
  return stepped_error < direct_error ? stepped : direct;
}

}  // namespace

std::array<double, 3> solve_sigmoid(const Rgb& rgb) {
  for (const double component : rgb)
    if (!(component >= 0 && component <= 1))
      throw std::logic_error("solve_sigmoid: components must be in [0, 1]");
  if (rgb[0] == rgb[1] && rgb[1] == rgb[2]) return {0, 0, flat_sigmoid(rgb[0])};
  return to_nanometres(solve_polynomial(rgb));
}

Spectrum rgb_reflectance(const Rgb& rgb) {
  require_components(rgb, 1, "must be in [0, 1]");
  return Spectrum::sigmoid(solve_sigmoid(rgb), 1);
}

Spectrum rgb_emission(const Rgb& rgb) {
  require_components(rgb, std::numeric_limits<double>::max() / 4, "must be finite and at least 0");
  const double scale = 2 * std::max({rgb[0], rgb[1], rgb[2]});
  if (scale == 0) return Spectrum::constant(0);
  const Rgb half = {rgb[0] / scale, rgb[1] / scale, rgb[2] / scale};
  return Spectrum::product(illuminant_d65(), Spectrum::sigmoid(solve_sigmoid(half), scale));
}

}  // namespace kiloband
