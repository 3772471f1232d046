#include "stats/variance_test.hpp"

#include <algorithm>
#include <cmath>

namespace kiloband::stats {
namespace {

double mean_weight(const UnitSample& sample) {
  double total = 0;
  for (const double w : sample.weights) total += w;
  return total / std::max<double>(1, static_cast<double>(sample.sampled()));
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

UnitSample per_replicate(const std::vector<double>& sums, const std::vector<std::size_t>& counts) {
  UnitSample sample{counts.size(), sums, std::vector<double>(sums.size() / counts.size(), 1.0)};
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const std::size_t n = counts[i % counts.size()];
    sample.means[i] = n > 0 ? sums[i] / static_cast<double>(n) : 0;
  }
  return sample;
}

/// One number per replicate: the mean over the channels that have any.
UnitSample mean_over_channels(const UnitSample& sample, const std::vector<std::size_t>& counts) {
  UnitSample one{1, std::vector<double>(sample.replicates()), sample.weights};
  const auto used = static_cast<double>(std::ranges::count_if(counts, [](std::size_t n) { return n > 0; }));
  for (std::size_t i = 0; i < sample.means.size(); ++i)
    one.means[i / sample.channels] += sample.means[i] / used;
  return one;
}

}  // namespace

UnitSample deviations_from_median(const UnitSample& sample) {
  UnitSample result{sample.channels, std::vector<double>(sample.means.size()), sample.weights};
  const double usual = mean_weight(sample);
  for (std::size_t c = 0; c < sample.channels; ++c) {
    std::vector<double> values;
    for (std::size_t r = 0; r < sample.replicates(); ++r) {
      if (sample.weights[r] > 0) values.push_back(sample.mean_at(r, c));
    }
    if (values.empty()) break;
    const double median = median_of(std::move(values));
    for (std::size_t r = 0; r < sample.replicates(); ++r)
      result.means[r * sample.channels + c] =
          std::sqrt(sample.weights[r] / usual) * std::abs(sample.mean_at(r, c) - median);
  }
  for (double& w : result.weights) w = w > 0;
  return result;
}

Contrast deviation_contrast(const UnitSample& a, const UnitSample& b, double rounding) {
  const Contrast means = independent_contrast(a, b, rounding);
  Contrast contrast = independent_contrast(deviations_from_median(a), deviations_from_median(b), 0);
  contrast.slack = means.slack;
  return contrast;
}

bool variance_pseudo_values(const UnitSample& sample, std::size_t channel, double floor,
                            std::vector<double>& q) {
  const std::size_t count = sample.replicates();
  if (count < 4 || sample.sampled() < count) return false;
  const auto n = static_cast<double>(count);
  const double usual = mean_weight(sample);
  double mean = 0, squares = 0;
  for (std::size_t r = 0; r < count; ++r) mean += sample.mean_at(r, channel) / n;
  q.assign(count, 0);
  for (std::size_t r = 0; r < count; ++r) {
    const double d = sample.mean_at(r, channel) - mean;
    q[r] = d * d * sample.weights[r] / usual;
    squares += q[r];
  }
  const double least = std::max(n * floor * floor, 1e-9 * squares);
  for (double& value : q) {
    const double without = squares - value * n / (n - 1);
    if (!(without > least)) return false;
    value = n * std::log(squares / (n - 1)) - (n - 1) * std::log(without / (n - 2));
  }
  return true;
}

PooledVarianceTest::PooledVarianceTest(std::size_t channels, std::size_t replicates_a,
                                       std::size_t replicates_b)
    : channels_(channels),
      sums_a_(channels * replicates_a),
      sums_b_(channels * replicates_b),
      counts_(channels) {}

void PooledVarianceTest::add(const UnitSample& a, const UnitSample& b, const std::vector<bool>& wanted,
                             double rounding) {
  std::vector<double> qa, qb;
  for (std::size_t c = 0; c < channels_; ++c) {
    if (!wanted.empty() && !wanted[c]) continue;
    double level = 0;
    for (std::size_t r = 0; r < a.replicates(); ++r) level = std::max(level, std::abs(a.mean_at(r, c)));
    if (!variance_pseudo_values(a, c, rounding * level, qa) ||
        !variance_pseudo_values(b, c, rounding * level, qb)) {
      ++skipped_;
      continue;
    }
    ++counts_[c];
    for (std::size_t r = 0; r < qa.size(); ++r) sums_a_[r * channels_ + c] += qa[r];
    for (std::size_t r = 0; r < qb.size(); ++r) sums_b_[r * channels_ + c] += qb[r];
  }
}

PooledVariance PooledVarianceTest::finish(uint64_t seed) const {
  PooledVariance result;
  result.skipped = skipped_;
  std::vector<bool> used;
  for (const std::size_t n : counts_) {
    result.entries += n;
    used.push_back(n > 0);
  }
  if (result.entries == 0) return result;
  const UnitSample a = per_replicate(sums_a_, counts_), b = per_replicate(sums_b_, counts_);
  const Contrast contrast = independent_contrast(a, b, 0);
  const Strongest strongest = strongest_channel(contrast, used);
  const std::size_t c = result.channel = strongest.channel;
  result.p = max_t_p(contrast, used, strongest, seed);
  result.ratio = std::exp(contrast.difference[c]);
  result.log_error = std::sqrt(contrast.variance[c]);
  result.t = strongest.t;
  result.dof = contrast.dof[c];
  const Contrast all =
      independent_contrast(mean_over_channels(a, counts_), mean_over_channels(b, counts_), 0);
  result.ratio_all = std::exp(all.difference[0]);
  result.log_error_all = std::sqrt(all.variance[0]);
  for (std::size_t k = 0; k < channels_; ++k) {
    const RelativeError e{static_cast<float>(std::sqrt(contrast.variance[k])), 0,
                          static_cast<float>(contrast.dof[k]), static_cast<uint32_t>(k)};
    if (used[k]) result.errors.add(e, e);
  }
  return result;
}

}  // namespace kiloband::stats
