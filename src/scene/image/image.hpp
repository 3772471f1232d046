// Images for textures and environment maps, behind an interface so that a build without
// OpenImageIO is possible.
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
  uint32_t channels = 0;      // 1 or 3 (alpha is dropped)
  std::vector<float> pixels;  // [y][x][channel], finite and >= 0
  float lowest = 0;           // the smallest value of the file where that was negative and became 0
};

/// Reads an image file: OpenEXR, Radiance HDR, PNG, JPEG, TIFF, BMP, PNM, PFM (told by their first bytes) and
/// Targa (by its name). Integer values are scaled to [0, 1]; 8- and 16-bit ones are decoded by the sRGB curve
/// of IEC 61966-2-1 whatever the file says of its gamma, 32-bit integers are refused. Float formats are
/// linear. Colours are never multiplied by alpha. Channels by name: R, G, B; else Y; else the R, G, B of the
/// first layer that has them ("layer.R" ...); else the only channel besides alpha. Anything else (X Y Z,
/// window. Slightly negative values (negative_values.hpp; the mean is that of all channels) become
/// 0, with one warning.
/// A spectral EXR file is read by its RGB picture, with a warning.
/// raw  true: no colour conversion of integer formats
/// throws InputError  naming the file: missing, unreadable, truncated, values that are not finite or clearly
///                    negative, larger than 65535 in a dimension
Image read_image(const std::filesystem::path& file, bool raw, const DiagnosticSink& sink = {});

}  // namespace kiloband
