// CIE 1931 2-degree colorimetry.
#pragma once

#include <array>

#include "spectral/spectrum.hpp"

namespace kiloband {

inline constexpr double kCieMinNm = 360;
inline constexpr double kCieMaxNm = 830;
/// What Mitsuba 3 divides by. The integral of its own table (and ours) is 106.857028: this is 470 nm times
/// the mean of 1000 equidistant samples with both ends, 999/1000 of it, so that Y as in Mitsuba 3 is 0.1 %
/// larger than the integral's.
inline constexpr double kCieYIntegral = 106.7502593994140625;

const Spectrum& cie_x();
const Spectrum& cie_y();
const Spectrum& cie_z();
/// CIE standard illuminant D65, 360-830 nm, divided by 98.99741751876255 so that emission of rgb(1,1,1)
/// has Y 1 (to 1.1e-4) with kCieYIntegral, as in Mitsuba 3.
const Spectrum& illuminant_d65();

/// Linear sRGB of XYZ: the matrix that follows from the primaries and the white point (0.3127, 0.3290) of
/// ITU-R BT.709, to the six decimals that Mitsuba 3 uses. IEC 61966-2-1 prints it rounded to four; they
/// differ by up to 3e-4.
std::array<double, 3> xyz_to_linear_srgb(const std::array<double, 3>& xyz);
/// IEC 61966-2-1: linear value of an encoded one, both in [0, 1]; what is outside is continued.
double srgb_decode(double encoded);
/// The sRGB transfer function, [0,1] to [0,1]; clamps.
double srgb_encode(double linear);

}  // namespace kiloband
