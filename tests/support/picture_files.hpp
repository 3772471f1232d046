// Pictures as the bytes of simple files.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

namespace kiloband::test {

/// A greyscale (1 component) or RGB (3) float image, rows from the top, as PFM.
inline std::string pfm_image(uint32_t width, uint32_t height, uint32_t components,
                             const std::vector<float>& values) {
  static_assert(std::endian::native == std::endian::little);
  std::string text =
      (components == 3 ? "PF\n" : "Pf\n") + std::to_string(width) + " " + std::to_string(height) + "\n-1.0\n";
  const std::size_t row = std::size_t{width} * components;
  for (uint32_t y = height; y-- > 0;)  // the format begins with the bottom row
    text.append(reinterpret_cast<const char*>(&values[y * row]), row * sizeof(float));
  return text;
}

}  // namespace kiloband::test
