#include <cmath>

#include "cube/cube_layout.hpp"
#include "files/atomic_file.hpp"
#include "pictures/picture_library.hpp"
#include "spectral/colour/colour.hpp"

namespace kiloband {
namespace {

/// [0, 1] to sRGB bytes; what is no number is black.
std::vector<uint8_t> encode_srgb(std::span<const float> linear) {
  std::vector<uint8_t> bytes(linear.size());
  for (std::size_t i = 0; i < linear.size(); ++i)
    bytes[i] = std::isnan(linear[i]) ? 0 : static_cast<uint8_t>(std::lround(255 * srgb_encode(linear[i])));
  return bytes;
}

}  // namespace

void write_png(const std::filesystem::path& file, uint32_t width, uint32_t height,
               std::span<const float> linear_rgb) {
  if (width == 0 || height == 0 || width > kMaxImageEdge || height > kMaxImageEdge)
    throw InputError(file.string() + ": image size " + std::to_string(width) + "x" + std::to_string(height) +
                     ": must be between 1 and " + std::to_string(kMaxImageEdge));
  if (linear_rgb.size() != std::size_t{width} * height * 3)
    throw std::logic_error("write_png: the buffer does not fit the image");
  const std::vector<uint8_t> pixels = encode_srgb(linear_rgb);
  write_file_atomically(file, png_file(width, height, pixels.data()));
}

}  // namespace kiloband
