// An image in memory, for tests of what is shown of it.
#pragma once

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "viewer/display/plane.hpp"

namespace kiloband::test {

class ArraySource final : public viewer::PixelSource {
 public:
  /// values: [y][x][band]
  ArraySource(uint32_t width, uint32_t height, std::vector<Band> bands, std::vector<float> values)
      : width_(width),
        height_(height),
        bands_(std::move(bands)),
        units_(bands_.size(), 1.0),
        means_(std::move(values)) {}

  void set_units(std::vector<double> units) { units_ = std::move(units); }
  void set_variances(std::vector<float> variances) { variances_ = std::move(variances); }

  uint32_t width() const override { return width_; }
  uint32_t height() const override { return height_; }
  const std::vector<Band>& bands() const override { return bands_; }
  const std::vector<double>& units() const override { return units_; }
  void means(uint32_t y, std::span<float> out) const override { copy_row(means_, y, out); }
  bool has_variances() const override { return !variances_.empty(); }
  void variances(uint32_t y, std::span<float> out) const override {
    if (variances_.empty())
      std::ranges::fill(out, std::numeric_limits<float>::quiet_NaN());
    else
      copy_row(variances_, y, out);
  }

 private:
  void copy_row(const std::vector<float>& from, uint32_t y, std::span<float> out) const {
    const std::size_t row = width_ * bands_.size();
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(y * row), row, out.begin());
  }

  uint32_t width_, height_;
  std::vector<Band> bands_;
  std::vector<double> units_;
  std::vector<float> means_, variances_;
};

}  // namespace kiloband::test
