// The largest values that scenes may have: far above what exists, far below where single precision overflows.
// A value beyond them is a slip (a wrong unit, a missing exponent) and an error; the rest is counted where
// images are written (CubeOutput).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "scene/read/object/object.hpp"

namespace kiloband {

/// Sensor responses, weights of endmembers, factors of light.
inline constexpr double kMaxQuantity = 1e15;
/// n and k of conductors: metals have about 1000 at 1 mm. Fresnel's formulas need the fourth power.
inline constexpr double kMaxMetalIndex = 1e5;
/// n of what is transparent: 1 to 6.
inline constexpr double kMaxIndex = 1000, kMinIndex = 1e-3;
/// Beyond this no material exists, and Planck's law would not need what is special about emission here.
inline constexpr double kMaxTemperatureK = 1e5;
inline constexpr const char* kTemperatureRule = "must be from 0 to 100000 K";
/// Metals have 1e8 1/m. Times the medium's scale and a node's.
inline constexpr double kMaxAbsorption = 1e15;
/// Factors of an absorption, which may be a number density (1/m^3) on a cross section (m^2).
inline constexpr double kMaxAbsorptionScale = 1e30;
/// Width of a lobe: slopes are of the order of alpha.
inline constexpr double kMaxAlpha = 100, kMinAlpha = 1e-6;
/// Heights of bump maps, m.
inline constexpr double kMaxBumpScale = 1e6;
/// Angular radii of suns, degrees: directions of single precision resolve 0.4 % of the smallest.
inline constexpr double kMinSunRadius = 1e-3, kMaxSunRadius = 90;
/// Lengths in m: places and sizes, see check_places().
inline constexpr double kMaxLength = 1e9;
/// Samples per pixel, as of --spp, and what is counted like them.
inline constexpr uint64_t kMaxSamples = 0xffffffff;

/// "must be <= 1e+15 W m^-2".
std::string at_most(double limit, std::string_view unit = {});
/// throws InputError  at the value of a parameter whose size is above the limit
void check_at_most(const ObjectReader& object, std::string_view name, double value, double limit,
                   std::string_view unit = {});

}  // namespace kiloband
