// The program's own picture readers. Each opens a file of its format, whose signature the caller has seen.
// returns null for what it leaves to OpenImageIO; throws std::exception, whose what() is the reason in the reader's words.
#pragma once

#include <memory>
#include <string>

#include "pictures/picture_library.hpp"

namespace kiloband {

/// Part 0 of an OpenEXR file, in scan lines or tiles (their first level). Left to others: luminance with subsampled chroma.
std::unique_ptr<PictureInput> open_exr(const std::string& file);
/// All of PNG: 1 to 16 bits, grey, palettes, transparency as alpha, interlaced.
std::unique_ptr<PictureInput> open_png(const std::string& file);
/// Grey and colour JPEG, sequential or progressive. Left to others: CMYK.
std::unique_ptr<PictureInput> open_jpeg(const std::string& file);
/// Radiance RGBE, run lengths of both kinds. Rows must run from the top, left to right.
std::unique_ptr<PictureInput> open_radiance(const std::string& file);
/// PFM, "PF" and "Pf". Left to others: the PNM files of whole numbers.
std::unique_ptr<PictureInput> open_pfm(const std::string& file);
/// PNM of whole numbers, "P2", "P3", "P5" and "P6". Left to others: bitmaps and PFM.
std::unique_ptr<PictureInput> open_pnm(const std::string& file);

}  // namespace kiloband
