// Writes image files for the tests, through OpenImageIO or byte by byte.
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/messages.hpp"

namespace kiloband::test {

/// Writes pixels [y][x][channel] in the file's format, stored as `type`.
inline std::filesystem::path write_image(const std::filesystem::path& path, int width, int height,
                                         const std::vector<std::string>& channels,
                                         const std::vector<float>& pixels, OIIO::TypeDesc type,
                                         const std::function<void(OIIO::ImageSpec&)>& adjust = {}) {
  OIIO::ImageSpec spec(width, height, static_cast<int>(channels.size()), type);
  spec.channelnames = channels;
  for (size_t i = 0; i < channels.size(); ++i) {
    if (channels[i] == "A") spec.alpha_channel = static_cast<int>(i);
  }
  if (adjust) adjust(spec);
  const auto output = OIIO::ImageOutput::create(path.string());
  if (!output || !output->open(path.string(), spec) || !output->write_image(OIIO::TypeFloat, pixels.data()) ||
      !output->close()) {
    throw std::logic_error("cannot write " + path.string() + ": " +
                           (output ? output->geterror() : OIIO::geterror()));
  }
  return path;
}

/// A picture without symmetry: values 0, 1/n, 2/n ... in file order.
inline std::vector<float> ramp(size_t count) {
  std::vector<float> values(count);
  for (size_t i = 0; i < count; ++i) values[i] = static_cast<float>(i) / static_cast<float>(count);
  return values;
}

inline const std::vector<std::string> kRgb = {"R", "G", "B"};

}  // namespace kiloband::test
