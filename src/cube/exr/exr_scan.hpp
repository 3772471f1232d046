// A first look at an EXR file that allocates nothing: OpenEXR itself believes the sizes that a header states.
#pragma once

#include <OpenEXR/ImfHeader.h>

#include <cstdint>

#include "files/input_file.hpp"

namespace kiloband {

/// How the pixels of a single-part file are stored.
struct ExrStorage {
  Imf::Header header;
  bool tiled = false;
  uint32_t tile_width = 0, tile_height = 0;  // tiled only
  uint64_t chunks = 0;                       // tiles or blocks of lines at full resolution
};

/// Checks the header's attribute sizes, the image's size, the table of chunk offsets and the last chunk
/// against the file's size.
/// throws InputError  not an EXR file, damaged, truncated, deep or multi-part, or larger than a cube may be
ExrStorage scan_exr(const InputFileBytes& file);

}  // namespace kiloband
