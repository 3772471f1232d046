// Some rows of an image, as an image.
#pragma once

#include "viewer/display/plane.hpp"

namespace kiloband::viewer {

class RowRange final : public PixelSource {
 public:
  /// Rows first .. first + rows - 1 of an image that outlives the object.
  RowRange(const PixelSource& image, uint32_t first, uint32_t rows)
      : image_(image), first_(first), rows_(rows) {}

  uint32_t width() const override { return image_.width(); }
  uint32_t height() const override { return rows_; }
  const std::vector<Band>& bands() const override { return image_.bands(); }
  const std::vector<double>& units() const override { return image_.units(); }
  void means(uint32_t y, std::span<float> out) const override { image_.means(first_ + y, out); }
  void band_means(uint32_t y, std::size_t band, std::span<float> out,
                  std::vector<float>& row) const override {
    image_.band_means(first_ + y, band, out, row);
  }
  bool has_variances() const override { return image_.has_variances(); }
  void variances(uint32_t y, std::span<float> out) const override { image_.variances(first_ + y, out); }
  uint32_t replicates() const override { return image_.replicates(); }
  bool has_independent_errors() const override { return image_.has_independent_errors(); }
  void sums(uint32_t y, const ThreeSums& of_row, std::span<float> out) const override {
    image_.sums(first_ + y, of_row, out);
  }
  void prepare(const ThreeSums& sums) const override { image_.prepare(sums); }

 private:
  const PixelSource& image_;
  const uint32_t first_, rows_;
};

}  // namespace kiloband::viewer
