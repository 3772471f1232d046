#include "stats/comparison/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stats/comparison/comparison_verdict.hpp"
#include "stats/comparison/sides.hpp"
#include "stats/random.hpp"

namespace kiloband::stats {
namespace {

/// Everything about one of the fine scales.
struct FineScale {
  FineScale(Kind kind, uint32_t columns, uint32_t rows, std::size_t channels, uint32_t ra, uint32_t rb,
            uint64_t seed)
      : means(columns, rows, mix_seed(seed, 1)),
        variances(columns, rows, mix_seed(seed, 2)),
        uniformity(mix_seed(seed, 3)),
        thin(kind, channels, ra, rb) {}

  ScaleTest means, variances;
  Uniformity uniformity;
  SidesPool thin;
  bool any_thin = false;
};

}  // namespace

struct StripComparison::State {
  State(Kind kind_, const ReplicateImage& shape, uint32_t rb, const ComparisonOptions& options_)
      : kind(kind_),
        options(options_),
        replicates_b(rb),
        shape_(shape),
        pixels(kind, shape.width, shape.height, shape.channels, shape.replicates, rb,
               mix_seed(options.seed, 1)),
        tiles(kind, tiles_along(shape.width), tiles_along(shape.height), shape.channels, shape.replicates, rb,
              mix_seed(options.seed, 2)),
        whole(1, 1, mix_seed(options.seed, 3)),
        tile(kind, shape.channels, shape.replicates, rb),
        image(kind, shape.channels, shape.replicates, rb),
        tile_area(shape.channels),
        image_area(shape.channels),
        pooled(shape.channels, shape.replicates, rb),
        tails_a(shape.channels),
        tails_b(shape.channels) {}

  bool has_variances() const {
    return kind == Kind::kIndependent && options.variances && same_sizes && replicates_b == shape_.replicates;
  }

  uint32_t fewest_replicates() const {
    return kind == Kind::kTruth ? shape_.replicates : std::min(shape_.replicates, replicates_b);
  }

  bool has_pixel_means() const { return options.fine_scales && fewest_replicates() >= kPixelReplicates; }

  bool has_unit_variances() const { return has_variances() && replicates_b >= kVarianceReplicates; }

  /// Not of pairs, nor of a truth that is known to a bound only.
  bool has_uniformity() const { return options.fine_scales && kind != Kind::kPaired && exact; }

  void add_uniformity(FineScale& scale, const Contrast& contrast, const Sides& sides,
                      const std::vector<bool>& wanted);
  void add_means(FineScale& scale, std::ptrdiff_t index, const UnitPlace& place, const Sides& sides,
                 const Contrast& contrast, const std::vector<bool>& wanted, std::size_t thin);
  void add_area(const Contrast& pixel);
  void add_rows(const PixelSource& source);
  void add_pixel(const PixelSource& source, std::size_t in_strip, uint32_t x, uint32_t y);
  void add_unit(FineScale& scale, std::ptrdiff_t index, const UnitPlace& place, const Sides& sides);
  void flush_thin(FineScale& scale, const UnitPlace& place);
  void finish_tile(const UnitPlace& place);
  void finish_uniformity(Comparison& c);

  Kind kind;
  ComparisonOptions options;
  uint32_t replicates_b, next_row = 0;
  ReplicateImage shape_;  // without arrays
  FineScale pixels, tiles;
  ScaleTest whole;
  SidesPool tile, image;
  AgreeingArea tile_area, image_area;
  PooledVarianceTest pooled;
  Tails tails_a, tails_b;
  std::size_t non_finite = 0;
  bool same_sizes = true;  // of the replicates, in samples
  bool exact = true;       // no bound on a truth
  Sides sides;
};

void StripComparison::State::add_uniformity(FineScale& scale, const Contrast& contrast, const Sides& unit,
                                            const std::vector<bool>& wanted) {
  if (!has_uniformity()) return;
  if (kind == Kind::kTruth)
    scale.uniformity.add(contrast, unit.a, wanted);
  else if (options.variances && same_sizes)
    scale.uniformity.add(contrast, unit.a, unit.b);
}

/// Means of a pixel or tile; its thin channels to the pool.
void StripComparison::State::add_means(FineScale& scale, std::ptrdiff_t index, const UnitPlace& place,
                                       const Sides& unit, const Contrast& contrast,
                                       const std::vector<bool>& wanted, std::size_t thin) {
  scale.means.add(index, place, contrast, wanted);
  if (!contrast.valid) return;
  scale.means.count_thin(thin, kind != Kind::kTruth);
  if (thin == 0 || kind == Kind::kTruth) return;
  std::vector<bool> marked = wanted;
  marked.flip();
  scale.thin.add_marked(unit, marked);
  scale.any_thin = true;
}

void StripComparison::State::add_area(const Contrast& pixel) {
  tile_area.add(pixel);
  image_area.add(pixel);
}

/// A pixel or tile: means, variances, uniformity.
void StripComparison::State::add_unit(FineScale& scale, std::ptrdiff_t index, const UnitPlace& place,
                                      const Sides& unit) {
  std::size_t thin = 0;
  const std::vector<bool> wanted = testable_channels(kind, unit, thin);
  Contrast contrast = contrast_of(kind, unit, options.rounding);
  const bool is_pixel = &scale == &pixels;
  if (is_pixel)
    add_area(contrast);
  else
    tile_area.settle(contrast);
  if (!is_pixel || has_pixel_means()) add_means(scale, index, place, unit, contrast, wanted, thin);
  if (!contrast.valid) return;
  add_uniformity(scale, contrast, unit, wanted);
  if (!has_variances()) return;
  if (has_unit_variances())
    scale.variances.add(index, place, deviation_contrast(unit.a, unit.b, options.rounding), wanted);
  if (is_pixel) pooled.add(unit.a, unit.b, wanted, options.rounding);
}

/// What was too thin, together; what still is stays with the larger unit, which has it anyway.
void StripComparison::State::flush_thin(FineScale& scale, const UnitPlace& place) {
  if (!scale.any_thin) return;
  std::size_t thin = 0;
  const Sides unit = scale.thin.mean();
  std::vector<bool> wanted = testable_channels(kind, unit, thin);
  for (std::size_t c = 0; c < wanted.size(); ++c)
    wanted[c] = wanted[c] && contributions(unit.a, c) + contributions(unit.b, c) > 0;
  UnitPlace pool = place;
  pool.pooled = true;
  scale.means.add(-1, pool, contrast_of(kind, unit, options.rounding), wanted);
  scale.thin.clear();
  scale.any_thin = false;
}

void StripComparison::State::add_pixel(const PixelSource& source, std::size_t in_strip, uint32_t x,
                                       uint32_t y) {
  non_finite += source.gather(in_strip, sides);
  tile.add(sides);
  image.add(sides);
  tails_a.add(sides.a);
  if (kind != Kind::kTruth) tails_b.add(sides.b);
  if (kind == Kind::kIndependent && same_sizes) same_sizes = replicates_have_same_sizes(sides.a, sides.b);
  if (!options.fine_scales) return add_area(contrast_of(kind, sides, options.rounding));
  add_unit(pixels, static_cast<std::ptrdiff_t>(std::size_t{y} * shape_.width + x), {x, y, 1, 1}, sides);
}

void StripComparison::State::finish_tile(const UnitPlace& place) {
  if (options.fine_scales) {
    flush_thin(pixels, place);
    const std::size_t index =
        std::size_t{place.y / kTileEdge} * tiles_along(shape_.width) + place.x / kTileEdge;
    add_unit(tiles, static_cast<std::ptrdiff_t>(index), place, tile.mean());
  }
  tile.clear();
  tile_area.clear();
}

/// Where the verdict is known already its p need not be small.
void StripComparison::State::finish_uniformity(Comparison& c) {
  if (!has_uniformity()) return;
  const double least = options.alpha / kMostTests;
  const double level = is_different(c, least) ? std::max(least, kUniformityCoarse) : least;
  if (std::ranges::count(c.scales, Scale::kPixel) > 0) c.uniform_pixels = pixels.uniformity.finish(level);
  if (std::ranges::count(c.scales, Scale::kTile) > 0) c.uniform_tiles = tiles.uniformity.finish(level);
}

void StripComparison::State::add_rows(const PixelSource& source) {
  const ReplicateImage& strip = source.image();
  check_shape(strip);
  const bool last = next_row + strip.height == shape_.height;
  if (strip.width != shape_.width || strip.channels != shape_.channels ||
      strip.replicates != shape_.replicates || next_row + strip.height > shape_.height ||
      (!last && strip.height % kTileEdge != 0))
    throw std::logic_error("StripComparison: the strip does not fit the image");
  for (uint32_t y0 = 0; y0 < strip.height; y0 += kTileEdge) {
    for (uint32_t x0 = 0; x0 < strip.width; x0 += kTileEdge) {
      const UnitPlace place{x0, next_row + y0, std::min(kTileEdge, strip.width - x0),
                            std::min(kTileEdge, strip.height - y0)};
      for (uint32_t y = y0; y < y0 + place.height; ++y) {
        for (uint32_t x = x0; x < x0 + place.width; ++x)
          add_pixel(source, std::size_t{y} * strip.width + x, x, next_row + y);
      }
      finish_tile(place);
    }
  }
  next_row += strip.height;
}

StripComparison::StripComparison(Kind kind, uint32_t width, uint32_t height, std::size_t channels,
                                 uint32_t replicates_a, uint32_t replicates_b,
                                 const ComparisonOptions& options) {
  const ReplicateImage shape{width, height, channels, replicates_a, {}, {}};
  state_ = std::make_unique<State>(kind, shape, kind == Kind::kTruth ? 0 : replicates_b, options);
}

StripComparison::~StripComparison() = default;

void StripComparison::add(const ReplicateImage& a, const ReplicateImage& b) {
  check_shape(b);
  if (state_->kind == Kind::kTruth || b.width != a.width || b.height != a.height ||
      b.channels != a.channels || b.replicates != state_->replicates_b)
    throw std::logic_error("StripComparison: the sides differ in shape");
  state_->add_rows(PixelSource(a, &b, nullptr));
}

void StripComparison::add(const ReplicateImage& a, const Truth& truth) {
  const std::size_t values = truth.per_pixel ? a.pixels() * a.channels : a.channels;
  if (state_->kind != Kind::kTruth || truth.value.size() != values ||
      (!truth.bound.empty() && truth.bound.size() != values))
    throw std::logic_error("StripComparison: the truth does not fit the image");
  if (std::ranges::any_of(truth.bound, [](double v) { return v != 0; })) state_->exact = false;
  state_->add_rows(PixelSource(a, nullptr, &truth));
}

Comparison StripComparison::finish() {
  State& s = *state_;
  if (s.next_row != s.shape_.height) throw std::logic_error("StripComparison: rows are missing");
  const Sides whole = s.image.mean();
  Contrast contrast = contrast_of(s.kind, whole, s.options.rounding);
  s.image_area.settle(contrast);
  s.flush_thin(s.tiles, {0, 0, s.shape_.width, s.shape_.height});
  s.whole.add(0, {0, 0, s.shape_.width, s.shape_.height}, contrast, {});
  Comparison c;
  c.kind = s.kind;
  if (s.has_pixel_means()) c.scales.push_back(Scale::kPixel);
  if (s.options.fine_scales) c.scales.push_back(Scale::kTile);
  c.scales.push_back(Scale::kImage);
  c.width = s.shape_.width;
  c.height = s.shape_.height;
  c.channels = s.shape_.channels;
  c.replicates_a = s.shape_.replicates;
  c.replicates_b = s.replicates_b;
  c.non_finite = s.non_finite;
  if (s.options.fine_scales) {
    if (s.has_pixel_means()) c.means.push_back(s.pixels.means.finish());
    c.means.push_back(s.tiles.means.finish());
    if (s.has_unit_variances()) {
      c.variances.push_back(s.pixels.variances.finish());
      c.variances.push_back(s.tiles.variances.finish());
    }
    if (s.has_variances()) {
      c.pooled_scatter = s.pooled.scatter(mix_seed(s.options.seed, 4));
      c.pooled_variance = s.pooled.variance(mix_seed(s.options.seed, 5));
    }
  }
  c.means.push_back(s.whole.finish());
  c.tails_a = s.tails_a.finish();
  if (s.kind != Kind::kTruth) c.tails_b = s.tails_b.finish();
  add_image_means(contrast, c);
  if (s.kind == Kind::kTruth) leave_out_skewed(c);
  s.finish_uniformity(c);
  judge(c, s.options, s.same_sizes);
  return c;
}

namespace {

Comparison compare_whole(Kind kind, const ReplicateImage& a, const ReplicateImage* b, const Truth* truth,
                         const ComparisonOptions& options) {
  StripComparison comparison(kind, a.width, a.height, a.channels, a.replicates,
                             b != nullptr ? b->replicates : 0, options);
  if (b != nullptr)
    comparison.add(a, *b);
  else
    comparison.add(a, *truth);
  return comparison.finish();
}

}  // namespace

Comparison compare_independent(const ReplicateImage& a, const ReplicateImage& b,
                               const ComparisonOptions& options) {
  return compare_whole(Kind::kIndependent, a, &b, nullptr, options);
}

Comparison compare_paired(const ReplicateImage& a, const ReplicateImage& b,
                          const ComparisonOptions& options) {
  return compare_whole(Kind::kPaired, a, &b, nullptr, options);
}

Comparison compare_truth(const ReplicateImage& a, const Truth& truth, const ComparisonOptions& options) {
  return compare_whole(Kind::kTruth, a, nullptr, &truth, options);
}

}  // namespace kiloband::stats
