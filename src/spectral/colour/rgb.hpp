// RGB to spectrum: Jakob & Hanika 2019, "A Low-Dimensional Function Space for Efficient Spectral Upsampling".
#pragma once

#include <array>
#include <vector>

#include "spectral/spectrum.hpp"

namespace kiloband {

using Rgb = std::array<double, 3>;

/// Coefficients c such that S(c0 x^2 + c1 x + c2), x in nm, has under D65 the linear sRGB colour `rgb` (each
/// in [0,1]). Solved for (damped Gauss-Newton in CIELAB as in the paper, from grey), not looked up. Grey
/// gives c0 = c1 = 0; black and white have c2 = -1e5 and 1e5, where S is 0 and 1 to single precision. The
/// residual is below 1e-4 in each component everywhere in the cube; nearly all of it is the white of S = 1
/// under the CIE's tables, (1.000095, 0.999982, 0.999906), by which colours are divided so
/// that greys are flat.
std::array<double, 3> solve_sigmoid(const Rgb& rgb);

/// Reflectance of a linear sRGB colour; components in [0,1], InputError otherwise.
Spectrum rgb_reflectance(const Rgb& rgb);
/// Emission as in Mitsuba 3: D65 * sigmoid(rgb / (2 max)) * 2 max; components >= 0, InputError otherwise.
Spectrum rgb_emission(const Rgb& rgb);

/// As solve_sigmoid(), but of S(c0 y^2 + c1 y + c2), y in nm from the middle of the colour matching functions, 595 nm.
/// Solves many colours at once (textures), over a million per second and core: a coarse table of solutions
/// over the RGB cube in the paper's parametrisation (built once per process, 0.1 s), interpolated
/// trilinearly, then Newton steps per colour until the residual is below 1e-3. components in [0,1],
/// std::logic_error otherwise. Safe to share between threads.
class SigmoidTable {
 public:
  SigmoidTable();
  std::array<float, 3> operator()(const std::array<float, 3>& rgb) const;

 private:
  std::vector<float> coefficients_;
};

}  // namespace kiloband
