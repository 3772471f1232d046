#include "stats/variance_test.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

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

/// Means per replicate, and the mean over the channels that have any as the last channel.
UnitSample per_replicate(const std::vector<double>& sums, const std::vector<std::size_t>& counts) {
  const std::size_t channels = counts.size(), replicates = sums.size() / channels;
  const auto used = static_cast<double>(std::ranges::count_if(counts, [](std::size_t n) { return n > 0; }));
  UnitSample sample{channels + 1, {}, std::vector<double>(replicates, 1.0)};
  for (std::size_t r = 0; r < replicates; ++r) {
    double total = 0;
    for (std::size_t c = 0; c < channels; ++c) {
      const auto n = static_cast<double>(counts[c]);
      sample.means.push_back(n > 0 ? sums[r * channels + c] / n : 0);
      total += sample.means.back();
    }
    sample.means.push_back(total / used);
  }
  return sample;
}

std::vector<double> sampled_values(const UnitSample& sample, std::size_t channel) {
  std::vector<double> values;
  for (std::size_t r = 0; r < sample.replicates(); ++r) {
    if (sample.weights[r] > 0) values.push_back(sample.mean_at(r, channel));
  }
  return values;
}

double median_of_both(std::vector<double> a, const std::vector<double>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return median_of(std::move(a));
}

/// 2 d_r / s of both sides, large d_r cut; false if nothing scatters beyond `floor`.
bool relative_scatter(const UnitSample& sa, const UnitSample& sb, std::size_t channel, double floor,
                      std::vector<double>& a, std::vector<double>& b) {
  a = sampled_values(sa, channel);
  b = sampled_values(sb, channel);
  const double median = median_of_both(a, b);
  for (std::size_t r = 0; r < a.size(); ++r) a[r] = std::sqrt(sa.weights[r]) * std::abs(a[r] - median);
  for (std::size_t r = 0; r < b.size(); ++r) b[r] = std::sqrt(sb.weights[r]) * std::abs(b[r] - median);
  floor *= std::sqrt(mean_weight(sa));
  const double most = kScatterCut * median_of_both(a, b);
  double s = 0;
  for (std::vector<double>* side : {&a, &b}) {
    for (double& d : *side) s += (d = std::min(d, most)) / (2 * static_cast<double>(side->size()));
  }
  if (!(s > floor)) return false;
  for (std::vector<double>* side : {&a, &b}) {
    for (double& d : *side) d *= 2 / s;
  }
  return true;
}

}  // namespace

UnitSample deviations_from_median(const UnitSample& sample, const UnitSample* other) {
  UnitSample result{sample.channels, std::vector<double>(sample.means.size()), sample.weights};
  const double usual = mean_weight(sample);
  for (std::size_t c = 0; c < sample.channels; ++c) {
    std::vector<double> values = sampled_values(sample, c);
    if (other != nullptr) std::ranges::copy(sampled_values(*other, c), std::back_inserter(values));
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
  if (!means.valid) return means;
  UnitSample da = deviations_from_median(a, &b), db = deviations_from_median(b, &a);
  for (UnitSample* side : {&da, &db}) {
    for (std::size_t i = 0; i < side->means.size(); ++i)
      side->means[i] = std::sqrt(std::max(0.0, side->means[i] - means.slack[i % side->channels]));
  }
  Contrast contrast = independent_contrast(da, db, 0);
  contrast.dof.assign(contrast.channels, static_cast<double>(a.sampled() + b.sampled()) - 2);
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
  double mean_log = 0;
  for (double& value : q) {
    const double without = squares - value * n / (n - 1);
    if (!(without > least)) return false;
    value = -(n - 1) * std::log(without / (n - 2));
    mean_log += value / n;
  }
  for (double& value : q) value += std::log(squares / (n - 1)) - mean_log;
  return true;
}

PooledReplicates::PooledReplicates(std::size_t channels, std::size_t replicates_a, std::size_t replicates_b)
    : channels_(channels),
      sums_a_(channels * replicates_a),
      sums_b_(channels * replicates_b),
      counts_(channels) {}

void PooledReplicates::add(std::size_t channel, const std::vector<double>& a, const std::vector<double>& b) {
  ++counts_[channel];
  for (std::size_t r = 0; r < a.size(); ++r) sums_a_[r * channels_ + channel] += a[r];
  for (std::size_t r = 0; r < b.size(); ++r) sums_b_[r * channels_ + channel] += b[r];
}

PooledVariance PooledReplicates::finish(uint64_t seed) const {
  PooledVariance result;
  result.skipped = skipped_;
  std::vector<bool> used;
  for (const std::size_t n : counts_) {
    result.entries += n;
    used.push_back(n > 0);
  }
  if (result.entries == 0) return result;
  used.push_back(true);
  const Contrast contrast =
      independent_contrast(per_replicate(sums_a_, counts_), per_replicate(sums_b_, counts_), 0);
  const Strongest strongest = strongest_channel(contrast, used);
  const std::size_t c = strongest.channel;
  result.channel = c == channels_ ? kAllChannels : c;
  result.p = max_t_p(contrast, used, strongest, seed);
  result.ratio = std::exp(contrast.difference[c]);
  result.log_error = std::sqrt(contrast.variance[c]);
  result.t = strongest.t;
  result.dof = contrast.dof[c];
  result.ratio_all = std::exp(contrast.difference[channels_]);
  result.log_error_all = std::sqrt(contrast.variance[channels_]);
  for (std::size_t k = 0; k <= channels_; ++k) {
    const RelativeError e{static_cast<float>(std::sqrt(contrast.variance[k])), 0,
                          static_cast<float>(contrast.dof[k]), static_cast<uint32_t>(k)};
    if (used[k]) result.errors.add(e, e);
  }
  return result;
}

PooledVarianceTest::PooledVarianceTest(std::size_t channels, std::size_t replicates_a,
                                       std::size_t replicates_b)
    : channels_(channels),
      scatter_(channels, replicates_a, replicates_b),
      variance_(channels, replicates_a, replicates_b) {}

void PooledVarianceTest::add(const UnitSample& a, const UnitSample& b, const std::vector<bool>& wanted,
                             double rounding) {
  if (a.sampled() < a.replicates() || b.sampled() < b.replicates()) return;
  std::vector<double> qa, qb;
  for (std::size_t c = 0; c < channels_; ++c) {
    if (!wanted.empty() && !wanted[c]) continue;
    double level = 0;
    for (std::size_t r = 0; r < a.replicates(); ++r) level = std::max(level, std::abs(a.mean_at(r, c)));
    const double floor = rounding * level;
    if (relative_scatter(a, b, c, floor, qa, qb))
      scatter_.add(c, qa, qb);
    else
      scatter_.skip();
    if (variance_pseudo_values(a, c, floor, qa) && variance_pseudo_values(b, c, floor, qb))
      variance_.add(c, qa, qb);
    else
      variance_.skip();
  }
}

}  // namespace kiloband::stats
