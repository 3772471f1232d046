// Cubes as pictures.
#pragma once

#include <vector>

#include "cube/cube_io.hpp"

namespace kiloband {

/// What red, green and blue show.
enum class PictureColours {
  kNatural,  // CIE 1931 2 degree XYZ to sRGB
  kFalse,    // thirds of the wavelength range, long waves red
  kSensor    // the first three bands as red, green, blue; a single one as grey
};

/// Linear RGB [y][x][3] without exposure.
/// throws InputError  kNatural: no channel reaches into 380-780 nm
std::vector<float> make_picture(CubeReader& cube, PictureColours colours);

}  // namespace kiloband
