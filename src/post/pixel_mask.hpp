// Sets of pixels: what signatures are measured over.
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "film/spectral_film.hpp"

namespace kiloband {

class PixelMask {
 public:
  /// No pixel of an image of this size.
  PixelMask(uint32_t width, uint32_t height)
      : width_(width), height_(height), in_(std::size_t{width} * height) {}
  /// rect lies in the image.
  static PixelMask of_rectangle(uint32_t width, uint32_t height, const PixelRect& rect);
  /// Pixels whose value in a plane [y][x] is one of `ids`; what is no whole number of 32 bits is none of them.
  static PixelMask of_ids(uint32_t width, uint32_t height, const std::vector<float>& plane,
                          const std::set<uint32_t>& ids);

  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }
  bool at(uint32_t x, uint32_t y) const { return in_[std::size_t{y} * width_ + x]; }
  void insert(uint32_t x, uint32_t y) { in_[std::size_t{y} * width_ + x] = true; }
  std::size_t count() const;
  bool empty() const { return count() == 0; }

  /// With all pixels at most `pixels` columns and rows away.
  PixelMask grown(uint32_t pixels) const;
  /// Without the pixels of another mask of the same size.
  PixelMask without(const PixelMask& other) const;
  /// Rows that have pixels of the mask: [first, last + 1); an empty mask gives [0, 0).
  struct Rows {
    uint32_t begin = 0, end = 0;
  };
  Rows rows() const;

 private:
  uint32_t width_, height_;
  std::vector<bool> in_;
};

}  // namespace kiloband
