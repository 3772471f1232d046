// CIE 1931 2-degree colorimetry.
#pragma once

#include <array>

#include "spectral/spectrum.hpp"

namespace kiloband {

inline constexpr double kCieMinNm = 360;
inline constexpr double kCieMaxNm = 830;
/// Integral of ybar over 360-830 nm as Mitsuba 3 uses it.
inline constexpr double kCieYIntegral = 106.7502593994140625;

const Spectrum& cie_x();
const Spectrum& cie_y();
const Spectrum& cie_z();
/// CIE standard illuminant D65, 360-830 nm, divided by 98.99741751876255 so that emission of rgb(1,1,1) has Y 1 as in Mitsuba 3.
const Spectrum& illuminant_d65();

/// Linear sRGB (D65 white) of XYZ, IEC 61966-2-1 matrix.
std::array<double, 3> xyz_to_linear_srgb(const std::array<double, 3>& xyz);
/// The sRGB transfer function, [0,1] to [0,1]; clamps.
double srgb_encode(double linear);
double srgb_decode(double encoded);

}  // namespace kiloband
