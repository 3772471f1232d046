#include "viewer/live/live_film.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace kiloband::viewer {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr uint32_t kLongest = 64;

/// Samples of a replicate.
uint32_t length_of(uint32_t replicate) {
  constexpr uint32_t kShort[] = {1, 1, 2, 4, 8};
  constexpr uint32_t kOfOneLength = 12;
  if (replicate < std::size(kShort)) return kShort[replicate];
  return std::min(16u << std::min((replicate - 5) / kOfOneLength, 2u), kLongest);
}

FilmOptions film_options(std::size_t channels, const SumRule& rule, bool variance) {
  FilmOptions options;
  options.channels = channels;
  options.replicates = LiveFilm::kReplicates;
  options.variance = variance;
  options.memory_bytes =
      std::numeric_limits<std::size_t>::max();  // in memory: who makes the film has looked at bytes()
  options.sums = rule;
  options.most_samples = kLongest;
  return options;
}

}  // namespace

LiveFilm::LiveFilm(const PixelRect& rect, std::vector<Band> bands, std::vector<double> units,
                   const SumRule& rule, bool variance)
    : film_(rect, film_options(bands.size(), rule, variance)),
      bands_(std::move(bands)),
      units_(std::move(units)),
      additions_(film_.blocks().size()) {
  film_.observe([this](uint32_t block) { add_block(block); });
}

std::size_t LiveFilm::bytes(const PixelRect& rect, std::size_t channels, const SumRule& rule, bool variance) {
  return rect.pixels() * SpectralFilm::bytes_per_pixel(film_options(channels, rule, variance));
}

uint64_t LiveFilm::most_samples() {
  uint64_t sum = 0;
  for (uint32_t r = 0; r < kReplicates; ++r) sum += length_of(r);
  return sum;
}

void LiveFilm::restart() {
  film_.restart();
  kept_.clear();
  replicate_ = first_ = 0;
  passes_ = 0;
}

std::vector<uint32_t> LiveFilm::next_blocks(std::size_t most) const {
  std::vector<uint32_t> some;
  for (uint32_t block = 0; block < blocks() && some.size() < most; ++block)
    if (film_.attempted(replicate_, block) <= first_) some.push_back(block);
  return some;
}

bool LiveFilm::finish_pass() {
  if (!next_blocks(1).empty()) return false;
  ++passes_;
  if (++first_ == length_of(replicate_)) {
    ++replicate_;
    first_ = 0;
  }
  return true;
}

/// The mean of the closed replicates becomes that of all samples. NaN without any.
void LiveFilm::add_open(uint32_t y, uint32_t x, std::span<float> mean) const {
  const PixelSumsView open = film_.pixel_sums(0, std::size_t{y} * film_.rect().width + x);
  const uint64_t closed = film_.samples(x, y);
  const double count = static_cast<double>(closed) + open.count;
  if (count == 0) return void(std::ranges::fill(mean, kNothing));
  if (open.count == 0) return;
  const auto a = static_cast<float>(static_cast<double>(closed) / count);
  const SumRule& rule = *film_.options().sums;
  if (open.closed.empty() && rule.kind == SumRule::Kind::kFolded) {
    const auto b = static_cast<float>(1 / count);
    for (std::size_t k = 0; k < mean.size(); ++k) mean[k] = a * mean[k] + b * open.open[k];
    return;
  }
  std::vector<float> of_open(mean.size());
  mean_of_sums(rule, kLongest, open, of_open);
  const auto share = static_cast<float>(open.count / count);
  for (std::size_t k = 0; k < mean.size(); ++k) mean[k] = a * mean[k] + share * of_open[k];
}

void LiveFilm::means(uint32_t y, std::span<float> out) const {
  film_.row(y, out, {});
  const std::size_t channels = bands_.size();
  for (uint32_t x = 0; x < width(); ++x) add_open(y, x, out.subspan(x * channels, channels));
}

void LiveFilm::prepare(const ThreeSums& sums) const {
  constexpr std::size_t kMostKept = 4;
  if (film_.options().sums->kind != SumRule::Kind::kFolded) return;  // others have no sums that are all open
  const auto kept = std::ranges::find_if(kept_, [&](const KeptSums& k) { return k.sums == sums; });
  if (kept != kept_.end()) {
    kept->asked = passes_;
    return;
  }
  if (kept_.size() >= kMostKept) kept_.pop_front();
  const std::size_t pixels = film_.rect().pixels();
  const std::vector<float> nothing(3 * pixels);
  kept_.push_back(
      {sums, passes_, nothing, nothing, std::vector<uint32_t>(pixels), std::vector<uint64_t>(blocks())});
}

/// What nobody has asked for of late is not made.
void LiveFilm::add_block(uint32_t block) {
  constexpr uint64_t kLately = 2;  // passes
  const std::size_t channels = bands_.size();
  const PixelRect& rect = film_.blocks()[block];
  ++additions_[block];
  for (KeptSums& kept : kept_) {
    if (passes_ - kept.asked > kLately) continue;
    for (uint32_t y = 0; y < rect.height; ++y) {
      const std::size_t first = film_.pixel_index(rect, std::size_t{y} * rect.width);
      const OpenSumsView open = std::as_const(film_).open_sums(0, first, rect.width);
      for (uint32_t x = 0; x < rect.width; ++x)
        kept.sums(&open.values[x * channels], &kept.open[3 * (first + x)]);
    }
    kept.additions[block] = additions_[block];
  }
}

/// Where a replicate was closed since.
void LiveFilm::update_closed(uint32_t y, KeptSums& kept) const {
  const std::size_t first = std::size_t{y} * width(), channels = bands_.size();
  bool same = true;
  for (uint32_t x = 0; x < width(); ++x) same = same && kept.samples[first + x] == film_.samples(x, y);
  if (same) return;
  std::vector<float> row(width() * channels);
  film_.row(y, row, {});
  for (uint32_t x = 0; x < width(); ++x) {
    kept.sums(&row[x * channels], &kept.closed[3 * (first + x)]);
    kept.samples[first + x] = static_cast<uint32_t>(film_.samples(x, y));
  }
}

void LiveFilm::sums(uint32_t y, const ThreeSums& of_row, std::span<float> out) const {
  const auto kept = std::ranges::find_if(kept_, [&](const KeptSums& k) { return k.sums == of_row; });
  if (kept == kept_.end()) return PixelSource::sums(y, of_row, out);
  update_closed(y, *kept);
  const std::size_t first = std::size_t{y} * width(), channels = bands_.size();
  const OpenSumsView open = film_.open_sums(0, first, width());
  uint32_t end = 0;  // of the block
  bool made = false;
  for (uint32_t x = 0; x < width(); ++x) {
    const std::size_t pixel = first + x;
    if (x == end) {
      const uint32_t block = film_.block_of(pixel);
      end = film_.blocks()[block].x0 + film_.blocks()[block].width - film_.rect().x0;
      made = kept->additions[block] == additions_[block];
    }
    float of_open[3] = {};
    if (open.counts[x] > 0 && made)
      std::copy_n(&kept->open[3 * pixel], 3, of_open);
    else if (open.counts[x] > 0)
      of_row(&open.values[x * channels], of_open);
    const double closed = kept->samples[pixel], count = closed + open.counts[x];
    const auto a = static_cast<float>(closed / count);
    for (std::size_t c = 0; c < 3; ++c)
      out[3 * std::size_t{x} + c] =
          count > 0 ? a * kept->closed[3 * pixel + c] + of_open[c] / static_cast<float>(count) : kNothing;
  }
}

/// That of the closed replicates' mean, for as many samples as there are: the open one has no mean to compare yet.
void LiveFilm::variances(uint32_t y, std::span<float> out) const {
  if (!has_variances()) return void(std::ranges::fill(out, kNothing));
  const std::size_t channels = bands_.size();
  std::vector<float> means(out.size());
  film_.row(y, means, out);
  for (uint32_t x = 0; x < width(); ++x) {
    const PixelSumsView open = film_.pixel_sums(0, std::size_t{y} * film_.rect().width + x);
    const double closed = static_cast<double>(film_.samples(x, y));
    const auto share = static_cast<float>(closed / std::max(closed + open.count, 1.0));
    for (float& variance : out.subspan(x * channels, channels)) variance *= share;
  }
}

}  // namespace kiloband::viewer
