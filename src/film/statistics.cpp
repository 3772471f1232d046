#include "film/statistics.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "film/moment_kernels.hpp"

namespace kiloband {
namespace {

std::size_t checked_product(std::size_t units, std::size_t channels) {
  if (channels != 0 && units > std::numeric_limits<std::size_t>::max() / sizeof(float) / channels)
    throw std::length_error("ReplicateMoments: units times channels is too large");
  return units * channels;
}

}  // namespace

ReplicateMoments::ReplicateMoments(std::size_t units, std::size_t channels, bool variance)
    : channels_(channels),
      variance_(variance),
      mean_(checked_product(units, channels)),
      m2_(variance ? units * channels : 0),
      samples_(units),
      replicates_(units) {}

void ReplicateMoments::add(std::size_t unit, uint64_t n, std::span<const float> means, float factor) {
  if (unit >= samples_.size() || means.size() != channels_)
    throw std::logic_error("ReplicateMoments::add: unit or number of channels out of range");
  if (n == 0) return;
  const film::MomentWeights w = film::moment_weights(samples_[unit], n);
  const film::ScaledMeans x{channels_, means.data(), factor};
  float* const mean = mean_.data() + unit * channels_;
  if (samples_[unit] == 0) {
    film::set_mean(x, mean);
    if (variance_) std::fill_n(m2_.data() + unit * channels_, channels_, 0.0f);
  } else if (variance_) {
    film::update_moments(x, w, mean, m2_.data() + unit * channels_);
  } else {
    film::update_mean(x, w.mean, mean);
  }
  samples_[unit] += n;
  ++replicates_[unit];
}

void ReplicateMoments::set(std::size_t unit, uint64_t samples, uint32_t replicates,
                           std::span<const float> mean, std::span<const float> m2) {
  if (unit >= samples_.size() || mean.size() != channels_ || m2.size() != (variance_ ? channels_ : 0))
    throw std::logic_error("ReplicateMoments::set: unit or number of channels out of range");
  std::ranges::copy(mean, mean_.begin() + static_cast<std::ptrdiff_t>(unit * channels_));
  std::ranges::copy(m2, m2_.begin() + static_cast<std::ptrdiff_t>(variance_ ? unit * channels_ : 0));
  samples_[unit] = samples;
  replicates_[unit] = replicates;
}

/// Means and M2 are set by the first replicate that follows.
void ReplicateMoments::restart() {
  std::ranges::fill(samples_, 0);
  std::ranges::fill(replicates_, 0);
}

std::size_t ReplicateMoments::units() const {
  return samples_.size();
}
std::size_t ReplicateMoments::channels() const {
  return channels_;
}
uint64_t ReplicateMoments::samples(std::size_t unit) const {
  return samples_.at(unit);
}
uint32_t ReplicateMoments::replicates(std::size_t unit) const {
  return replicates_.at(unit);
}

std::span<const float> ReplicateMoments::mean(std::size_t unit) const {
  if (unit >= samples_.size()) throw std::logic_error("ReplicateMoments::mean: unit out of range");
  return {mean_.data() + unit * channels_, channels_};
}

void ReplicateMoments::variance_of_mean(std::size_t unit, std::span<float> out) const {
  if (!variance_ || unit >= samples_.size() || out.size() != channels_)
    throw std::logic_error(
        "ReplicateMoments::variance_of_mean: no variance is kept, or unit or size out of range");
  if (replicates_[unit] < 2) {
    std::fill(out.begin(), out.end(), std::numeric_limits<float>::quiet_NaN());
    return;
  }
  const double divisor = static_cast<double>(samples_[unit]) * (replicates_[unit] - 1.0);
  const float scale = static_cast<float>(1.0 / divisor);
  const float* const m2 = m2_.data() + unit * channels_;
  for (std::size_t k = 0; k < channels_; ++k) out[k] = m2[k] * scale;
}

ReplicatePlan ReplicatePlan::deal(uint64_t samples, uint32_t wanted_replicates) {
  const uint64_t most = std::max<uint64_t>(samples / 2, 1);  // at least 2 samples in each
  const uint64_t wanted = std::max<uint64_t>(wanted_replicates, 1);
  return {samples, static_cast<uint32_t>(std::min(most, wanted))};
}

uint64_t ReplicatePlan::size(uint32_t replicate) const {
  if (replicate >= replicates) throw std::logic_error("ReplicatePlan::size: no such replicate");
  return samples / replicates + (replicate < samples % replicates ? 1 : 0);
}

}  // namespace kiloband
