// Texels of colours as devices evaluate them.
#pragma once

#include <vector>

#include "scene/compile/flat_scene.hpp"

namespace kiloband::opencl {

/// The scene's texels with the parabolas of colours moved: c0 x^2 + c1 x + c2 over the wavelength x in nm becomes
/// (c0 y + b) y + c over y = x - KB_TEXTURE_CENTRE_NM. The terms of saturated colours are a thousand times their sum; the move is made
/// in double, so b and c lose nothing, and work-items have no terms that cancel. Numbers, normals and what depends on no wavelength stay.
std::vector<KbFloat4> centred_texels(const FlatScene& scene);

}  // namespace kiloband::opencl
