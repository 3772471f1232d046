#include "post/pixel_mask.hpp"

#include <algorithm>
#include <cmath>

namespace kiloband {
namespace {

/// Planes of others hold what they like: NaN, infinities and fractions are of no object.
bool is_id(float value) {
  return value >= 0 && value < 0x1p32f && value == std::floor(value);
}

/// Inserts the places of a line that are at most `reach` from one that is in: a run begins `reach` before it, or where the run before
/// has ended.
template <class In, class Insert>
void grow_line(uint32_t length, uint32_t reach, const In& in, const Insert& insert) {
  uint32_t done = 0;  // places before it are in, or never will be
  for (uint32_t at = 0; at < length; ++at) {
    if (!in(at)) continue;
    const uint32_t end = at + 1 + std::min(reach, length - at - 1);
    for (done = std::max(done, at - std::min(at, reach)); done < end; ++done) insert(done);
  }
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

// A square is grown along one axis, then along the other; time does not depend on its size.
PixelMask PixelMask::grown(uint32_t pixels) const {
  PixelMask columns(width_, height_), result(width_, height_);
  for (uint32_t y = 0; y < height_; ++y)
    grow_line(
        width_, pixels, [&](uint32_t x) { return at(x, y); }, [&](uint32_t x) { columns.insert(x, y); });
  for (uint32_t x = 0; x < width_; ++x)
    grow_line(
        height_, pixels, [&](uint32_t y) { return columns.at(x, y); },
        [&](uint32_t y) { result.insert(x, y); });
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
