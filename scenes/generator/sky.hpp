// A sky for the visible range, as an environment image.
#pragma once

#include "scenes/generator/image.hpp"

namespace kiloband::generator {

/// Latitude-longitude, linear RGB; times D65 it is W m^-2 sr^-1 nm^-1: blue with thin clouds, a hazy sun of
/// about 4 degrees across, haze below the horizon.
/// sun     direction towards it, any length
/// clouds  0 (none) to 1
Image clear_sky(Vec3 sun, double clouds);

}  // namespace kiloband::generator
