// Images for textures and environment maps, behind an interface so that a build without OpenImageIO is possible.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/diagnostics.hpp"

namespace kiloband {

/// Linear RGB or one channel, float, row 0 = top. 8- and 16-bit files are decoded from sRGB unless `raw`.
struct Image {
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t channels = 0;  // 1 or 3 (alpha is dropped)
  std::vector<float> pixels;  // [y][x][channel]
};

/// Reads an image file (EXR, HDR, PNG, JPEG, TIFF ...).
/// raw    true: no colour conversion of integer formats
/// throws InputError  naming the file: missing, unreadable, truncated, not finite or negative values, larger than 65535
///                    in a dimension
Image read_image(const std::filesystem::path& file, bool raw);

}  // namespace kiloband
