// Pictures as the bytes that a browser decodes.
#pragma once

#include <string>

#include "viewer/display/picture_8bit.hpp"

namespace kiloband::viewer {

/// Whether a JPEG file can have so many pixels a side.
bool fits_jpeg(const Picture8& picture);

/// JPEG by libjpeg-turbo, without chroma subsampling: colour maps have edges of colour alone.
/// throws DeviceError  the library's message; the picture does not fit
std::string encode_jpeg(const Picture8& picture);

/// PNG, the very bytes of the picture, packed fast rather than small.
/// throws DeviceError  zlib has no memory
std::string encode_png(const Picture8& picture);

}  // namespace kiloband::viewer
