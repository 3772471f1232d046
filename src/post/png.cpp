#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cmath>

#include "cube/cube_layout.hpp"
#include "files/atomic_file.hpp"
#include "spectral/colour.hpp"

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
  OIIO::Filesystem::IOVecOutput memory;
  const auto output = OIIO::ImageOutput::create("png", &memory);
  OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  if (!output || !output->open(file.string(), spec) ||
      !output->write_image(OIIO::TypeDesc::UINT8, pixels.data()) || !output->close())
    throw DeviceError("cannot write '" + file.string() +
                      "': " + (output ? output->geterror() : OIIO::geterror()));
  const auto& bytes = memory.buffer();
  write_file_atomically(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace kiloband
