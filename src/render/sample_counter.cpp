#include "render/sample_counter.hpp"

#include <algorithm>

namespace kiloband {
namespace {

constexpr uint64_t kNotSeen = ~0ull;

}  // namespace

SampleCounter::SampleCounter(uint32_t replicates, bool kept)
    : samples_(kNotSeen),
      replicates_(replicates),
      fewest_(replicates + 1),
      of_replicates_(kept ? replicates : 0, kNotSeen) {}

void SampleCounter::add(const SpectralFilm& film) {
  const PixelRect& rect = film.rect();
  for (uint32_t y = 0; y < rect.height; ++y) {
    for (uint32_t x = 0; x < rect.width; ++x) {
      samples_ = std::min(samples_, film.samples(x, y));
      if (const uint32_t count = film.replicates(x, y); count >= 2) fewest_ = std::min(fewest_, count);
      for (uint32_t r = 0; r < of_replicates_.size(); ++r) {
        const uint64_t samples = film.replicate_samples(r, std::size_t{y} * rect.width + x);
        if (samples > 0) of_replicates_[r] = std::min(of_replicates_[r], samples);
      }
    }
  }
}

void SampleCounter::add_missing() {
  samples_ = 0;
}

SampleCounts SampleCounter::counts() const {
  SampleCounts counts{samples_ == kNotSeen ? 0 : samples_, fewest_ > replicates_ ? 1 : fewest_,
                      of_replicates_};
  std::ranges::replace(counts.replicate_samples, kNotSeen, uint64_t{0});
  return counts;
}

SampleCounts SampleCounter::expected(uint64_t samples_per_pixel) const {
  SampleCounts counts{samples_per_pixel, replicates_, of_replicates_};
  const ReplicatePlan plan{samples_per_pixel, replicates_};
  for (uint32_t r = 0; r < counts.replicate_samples.size(); ++r) counts.replicate_samples[r] = plan.size(r);
  return counts;
}

}  // namespace kiloband
