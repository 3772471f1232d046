#include "stats/comparison/moment_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>

#include "stats/comparison/comparison_verdict.hpp"
#include "stats/random.hpp"

namespace kiloband::stats {
namespace {

/// The moments of one pixel's replicates, of which `lost` are not finite; appended. zero: of all channels
void add_moments(const UnitSample& pixel, std::size_t lost, const TruthValues& zero, MomentImage& moments) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  const std::size_t sampled = pixel.sampled();
  moments.pixel_dof.push_back(static_cast<double>(sampled) - 1);
  const Contrast contrast = truth_contrast(pixel, zero, 0);
  const auto only = static_cast<std::size_t>(
      std::ranges::find_if(pixel.weights, [](double w) { return w > 0; }) - pixel.weights.begin());
  for (std::size_t c = 0; c < pixel.channels; ++c) {
    double mean = kNone;
    if (contrast.valid) mean = contrast.a[c];
    if (sampled == 1) mean = pixel.mean_at(only, c);
    if (lost > 0) mean = std::numeric_limits<float>::infinity();
    moments.mean.push_back(static_cast<float>(mean));
    moments.variance.push_back(contrast.valid ? contrast.variance[c] : kNone);
  }
}

}  // namespace

MomentImage moments_of(const ReplicateImage& image) {
  MomentImage moments{image.width, image.height, image.channels, image.replicates - 1.0, {}, {}};
  UnitSample pixel;
  const TruthValues zero{std::vector<double>(image.channels), {}};
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    const std::size_t lost = gather_pixel(image, p, pixel);
    add_moments(pixel, lost, zero, moments);
  }
  return moments;
}

MomentComparison::MomentComparison(uint32_t width, uint32_t height, std::size_t channels,
                                   bool independent_pixels, const ComparisonOptions& options)
    : width_(width),
      height_(height),
      channels_(channels),
      independent_(independent_pixels),
      options_(options),
      pixels_(width, height, mix_seed(options.seed, 1)),
      tiles_(tiles_along(width), tiles_along(height), mix_seed(options.seed, 2)),
      whole_(1, 1, mix_seed(options.seed, 3)),
      image_area_(channels) {}

void MomentComparison::add_sums(Sums& sums, const Contrast& pixel, const std::vector<bool>& wanted) const {
  for (auto* numbers : {&sums.pixels, &sums.a, &sums.b, &sums.variance, &sums.spread})
    numbers->resize(channels_);
  for (std::size_t c = 0; c < channels_; ++c) {
    if (!wanted[c]) continue;
    ++sums.pixels[c];
    sums.a[c] += pixel.a[c];
    sums.b[c] += pixel.b[c];
    sums.variance[c] += pixel.variance[c];
    sums.spread[c] += pixel.variance[c] * pixel.variance[c] / pixel.dof[c];
  }
}

Contrast MomentComparison::contrast_of(const Sums& sums) const {
  Contrast contrast;
  contrast.channels = channels_;
  contrast.valid = !sums.pixels.empty();
  for (std::size_t c = 0; c < channels_ && contrast.valid; ++c) {
    const double n = std::max(1.0, sums.pixels[c]), a = sums.a[c] / n, b = sums.b[c] / n;
    contrast.a.push_back(a);
    contrast.b.push_back(b);
    contrast.difference.push_back(a - b);
    contrast.variance.push_back(sums.variance[c] / (n * n));
    const double v = sums.variance[c];
    contrast.dof.push_back(sums.spread[c] > 0 ? v * v / sums.spread[c]
                                              : std::numeric_limits<double>::infinity());
    contrast.slack.push_back(options_.rounding * std::max(std::abs(a), std::abs(b)));
  }
  return contrast;
}

void MomentComparison::add_unit(ScaleTest& scale, std::ptrdiff_t index, const UnitPlace& place,
                                const Sums& sums, const AgreeingArea& area) const {
  std::vector<bool> wanted;
  for (const double n : sums.pixels) wanted.push_back(n > 0);
  if (!wanted.empty()) scale.count_unsampled(static_cast<std::size_t>(std::ranges::count(wanted, false)));
  Contrast contrast = contrast_of(sums);
  for (const double variance : contrast.variance) contrast.agreement.push_back(variance > 0 ? 0 : chance_);
  area.settle(contrast);
  scale.add(index, place, contrast, wanted);
}

/// Of finite means. wanted: the channels with a variance; if there is none it is not valid.
Contrast MomentComparison::pixel_contrast(const MomentImage& a, const MomentImage& b, std::size_t pixel,
                                          std::vector<bool>& wanted) const {
  Contrast contrast;
  contrast.channels = channels_;
  contrast.dof_a = a.dof_of(pixel);
  contrast.dof_b = b.dof_of(pixel);
  for (std::size_t i = pixel * channels_; i < (pixel + 1) * channels_; ++i) {
    const bool known =
        a.variance[i] >= 0 && b.variance[i] >= 0 && std::isfinite(a.variance[i] + b.variance[i]);
    const double va = known ? a.variance[i] : 0, vb = known ? b.variance[i] : 0;
    wanted.push_back(known);
    contrast.valid = contrast.valid || known;
    contrast.a.push_back(a.mean[i]);
    contrast.b.push_back(b.mean[i]);
    contrast.difference.push_back(double{a.mean[i]} - b.mean[i]);
    contrast.slack.push_back(options_.rounding * std::max(std::abs(a.mean[i]), std::abs(b.mean[i])));
    add_variances(va, vb, contrast);
  }
  return contrast;
}

/// Of a tile's pixels. Empty where there are so many replicates that none agree by chance.
AgreeingArea MomentComparison::area_of(const MomentImage& a, const MomentImage& b,
                                       const UnitPlace& place) const {
  AgreeingArea area(channels_);
  if (chance_ == 0) return area;
  for (uint32_t y = place.y; y < place.y + place.height; ++y) {
    for (uint32_t x = place.x; x < place.x + place.width; ++x) {
      std::vector<bool> wanted;
      area.add(pixel_contrast(a, b, std::size_t{y - next_row_} * width_ + x, wanted));
    }
  }
  return area;
}

void MomentComparison::add_pixel(const MomentImage& a, const MomentImage& b, uint32_t x, uint32_t y,
                                 const AgreeingArea& area) {
  const std::size_t pixel = std::size_t{y - next_row_} * width_ + x, first = pixel * channels_;
  const std::span<const float> ma(&a.mean[first], channels_), mb(&b.mean[first], channels_);
  const auto finite = [](float v) { return std::isfinite(v); };
  const auto none = [](float v) { return std::isnan(v); };
  const bool both = std::ranges::all_of(ma, finite) && std::ranges::all_of(mb, finite);
  const bool missing = std::ranges::all_of(ma, none) && std::ranges::all_of(mb, none);
  non_finite_ += !missing && !both;
  std::vector<bool> wanted;
  Contrast contrast;
  contrast.channels = channels_;
  if (both) contrast = pixel_contrast(a, b, pixel, wanted);
  area.settle(contrast);
  if (contrast.valid) pixels_.count_unsampled(static_cast<std::size_t>(std::ranges::count(wanted, false)));
  pixels_.add(static_cast<std::ptrdiff_t>(std::size_t{y} * width_ + x), {x, y, 1, 1}, contrast, wanted);
  if (!contrast.valid || !independent_) return;
  add_sums(tile_, contrast, wanted);
  add_sums(image_, contrast, wanted);
}

void MomentComparison::add(const MomentImage& a, const MomentImage& b) {
  const std::size_t values = std::size_t{a.width} * a.height * channels_;
  for (const MomentImage* side : {&a, &b}) {
    if (side->width != width_ || side->height != a.height || next_row_ + side->height > height_ ||
        side->mean.size() != values || side->variance.size() != values)
      throw std::logic_error("MomentComparison: the strip does not fit the image");
  }
  chance_ = std::max(chance_, chance_agreement(a.dof + 1, b.dof + 1));
  for (uint32_t y0 = next_row_; y0 < next_row_ + a.height; y0 += kTileEdge) {
    for (uint32_t x0 = 0; x0 < width_; x0 += kTileEdge) {
      const UnitPlace place{x0, y0, std::min(kTileEdge, width_ - x0),
                            std::min(kTileEdge, next_row_ + a.height - y0)};
      const AgreeingArea area = area_of(a, b, place);
      image_area_.add(area);
      for (uint32_t y = y0; y < y0 + place.height; ++y) {
        for (uint32_t x = x0; x < x0 + place.width; ++x) add_pixel(a, b, x, y, area);
      }
      const std::size_t index = std::size_t{y0 / kTileEdge} * tiles_along(width_) + x0 / kTileEdge;
      if (independent_) add_unit(tiles_, static_cast<std::ptrdiff_t>(index), place, tile_, area);
      tile_ = {};
    }
  }
  next_row_ += a.height;
}

Comparison MomentComparison::finish() {
  if (next_row_ != height_) throw std::logic_error("MomentComparison: rows are missing");
  Comparison c;
  c.width = width_;
  c.height = height_;
  c.channels = channels_;
  c.non_finite = non_finite_;
  c.scales = {Scale::kPixel};
  c.means.push_back(pixels_.finish());
  if (independent_) {
    add_unit(whole_, 0, {0, 0, width_, height_}, image_, image_area_);
    c.scales = {Scale::kPixel, Scale::kTile, Scale::kImage};
    c.means.push_back(tiles_.finish());
    c.means.push_back(whole_.finish());
    add_image_means(contrast_of(image_), c);
  } else {
    c.notes.push_back(
        "tiles and the image were not compared: from variances alone their errors are not known, unless "
        "pixels are "
        "independent");
  }
  c.notes.push_back("variances were not compared: that needs replicates or several renders");
  judge(c, options_, true);
  return c;
}

}  // namespace kiloband::stats
