// RGB to spectrum: Jakob & Hanika 2019, "A Low-Dimensional Function Space for Efficient Spectral Upsampling".
#pragma once

#include <array>

#include "spectral/spectrum.hpp"

namespace kiloband {

using Rgb = std::array<double, 3>;

/// Coefficients c such that S(c0 x^2 + c1 x + c2), x in nm, has under D65 the linear sRGB colour `rgb` (each in [0,1]).
/// Solved for (Gauss-Newton in CIELAB as in the paper, continued from grey), not looked up. Grey gives c0 = c1 = 0.
/// The residual is below 1e-4 in each component for colours inside the sRGB cube.
std::array<double, 3> solve_sigmoid(const Rgb& rgb);

/// Reflectance of a linear sRGB colour; components in [0,1], InputError otherwise.
Spectrum rgb_reflectance(const Rgb& rgb);
/// Emission as in Mitsuba 3: D65 * sigmoid(rgb / (2 max)) * 2 max; components >= 0, InputError otherwise.
Spectrum rgb_emission(const Rgb& rgb);

/// Solves many colours at once (textures): a memoised table of coefficients over the RGB cube, trilinear in the
/// paper's parametrisation, then one Newton step per colour. Residual as solve_sigmoid's within 1e-3.
class SigmoidTable {
 public:
  SigmoidTable();
  std::array<float, 3> operator()(const std::array<float, 3>& rgb) const;

 private:
  std::vector<float> coefficients_;
};

}  // namespace kiloband
