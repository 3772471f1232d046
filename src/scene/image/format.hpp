// What a file is and whether its size can be true, found out before an image library touches it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace kiloband {

enum class ImageFormat { kExr, kHdr, kPng, kJpeg, kTiff, kBmp, kPnm, kTarga };

struct ImageFile {
  std::string name;  // as given by the caller
  uint64_t bytes = 0;
  ImageFormat format = ImageFormat::kExr;

  /// throws InputError  "name: message"
  [[noreturn]] void fail(const std::string& message) const;
};

/// Opens a regular file and recognises its format; a JPEG file is also checked for its end marker, because
/// decoders fill what is missing with grey and call that a warning.
/// throws InputError  missing, not a regular file, empty, of no known format, truncated (JPEG)
ImageFile examine_image(const std::filesystem::path& path);

/// Checks the dimensions that the header states, before anything of that size is allocated.
/// throws InputError  zero, above 65535, or more pixels than PNG or JPEG could encode in the file's bytes
void check_image_size(const ImageFile& file, int64_t width, int64_t height);

}  // namespace kiloband
