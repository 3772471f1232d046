#include "post/pixel_mask.hpp"

#include <algorithm>
#include <cmath>

namespace kiloband {
namespace {

/// Planes of others hold what they like: NaN, infinities and fractions are of no object.
bool is_id(float value) {
  return value >= 0 && value < 0x1p32f && value == std::floor(value);
}

}  // namespace

PixelMask PixelMask::of_rectangle(uint32_t width, uint32_t height, const PixelRect& rect) {
  PixelMask mask(width, height);
  for (uint32_t y = rect.y0; y < rect.y0 + rect.height; ++y)
    for (uint32_t x = rect.x0; x < rect.x0 + rect.width; ++x) mask.insert(x, y);
  return mask;
}

PixelMask PixelMask::of_ids(uint32_t width, uint32_t height, const std::vector<float>& plane,
                            const std::set<uint32_t>& ids) {
  PixelMask mask(width, height);
  for (std::size_t i = 0; i < plane.size(); ++i)
    mask.in_[i] = is_id(plane[i]) && ids.contains(static_cast<uint32_t>(plane[i]));
  return mask;
}

std::size_t PixelMask::count() const {
  return static_cast<std::size_t>(std::count(in_.begin(), in_.end(), true));
}

// A square is grown along one axis, then along the other.
PixelMask PixelMask::grown(uint32_t pixels) const {
  return spread(pixels, 0).spread(0, pixels);
}

PixelMask PixelMask::spread(uint32_t dx, uint32_t dy) const {
  PixelMask result(width_, height_);
  for (uint32_t y = 0; y < height_; ++y)
    for (uint32_t x = 0; x < width_; ++x) {
      if (!at(x, y)) continue;
      const uint32_t right = std::min(width_ - 1, x + std::min(dx, width_));
      const uint32_t bottom = std::min(height_ - 1, y + std::min(dy, height_));
      for (uint32_t v = y - std::min(y, dy); v <= bottom; ++v)
        for (uint32_t u = x - std::min(x, dx); u <= right; ++u) result.insert(u, v);
    }
  return result;
}

PixelMask PixelMask::without(const PixelMask& other) const {
  PixelMask result = *this;
  for (std::size_t i = 0; i < in_.size(); ++i) result.in_[i] = in_[i] && !other.in_[i];
  return result;
}

PixelMask::Rows PixelMask::rows() const {
  Rows rows;
  for (uint32_t y = 0; y < height_; ++y) {
    const auto begin = in_.begin() + static_cast<std::ptrdiff_t>(std::size_t{y} * width_);
    if (std::find(begin, begin + width_, true) == begin + width_) continue;
    if (rows.end == 0) rows.begin = y;
    rows.end = y + 1;
  }
  return rows;
}

}  // namespace kiloband
