// Pixels of an image in the order in which they are rendered: block after block.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "film/spectral_film.hpp"

namespace kiloband::opencl {

/// A pixel in full-film coordinates.
struct ImagePixel {
  uint32_t x, y;
};

/// Do they share wavelength offsets?
inline bool same_block(const ImagePixel& a, const ImagePixel& b) {
  return a.x / kBlockSize == b.x / kBlockSize && a.y / kBlockSize == b.y / kBlockSize;
}

/// Those of one rectangle after the other, each row by row.
inline std::vector<ImagePixel> pixels_of(std::span<const PixelRect> rects) {
  std::vector<ImagePixel> pixels;
  for (const PixelRect& rect : rects)
    for (uint32_t i = 0; i < rect.pixels(); ++i)
      pixels.push_back({rect.x0 + i % rect.width, rect.y0 + i / rect.width});
  return pixels;
}

/// Pixels from `at` on that a group takes: whole blocks where at least one fits, else a part of one.
inline std::size_t whole_blocks(const std::vector<ImagePixel>& pixels, std::size_t at, std::size_t room) {
  const std::size_t end = std::min(pixels.size(), at + room);
  if (end == pixels.size()) return end - at;
  std::size_t boundary = end;
  while (boundary > at && same_block(pixels[boundary - 1], pixels[boundary])) --boundary;
  return (boundary > at ? boundary : end) - at;
}

}  // namespace kiloband::opencl
