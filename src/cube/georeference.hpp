// Where a cube lies on the ground, as ENVI headers say it.
#pragma once

#include <cstdint>

#include "base/diagnostics.hpp"
#include "cube/cube_io.hpp"

namespace kiloband {

/// The metadata of a cube after it was cropped at (x0, y0): `map info`, `x start` and `y start` move with the corner. What cannot
/// (`geo points`, `rpc info`, what is not understood) is left out with a note; without a corner that moves all stays.
void crop_georeference(CubeInfo& info, uint32_t x0, uint32_t y0, const DiagnosticSink& sink);

}  // namespace kiloband
