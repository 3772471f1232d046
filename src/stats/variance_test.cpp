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

/// Numbers of the replicates of both sides, relative to the mean of the two sides.
struct RelativeNumbers {
  std::vector<double> a, b;

  /// Scales to a mean of `mean`; false if that of the numbers is not above `floor`.
  bool normalise(double mean, double floor) {
    double s = 0;
    for (const std::vector<double>* side : {&a, &b}) {
      for (const double x : *side) s += x / (2 * static_cast<double>(side->size()));
    }
    if (!(s > floor)) return false;
    for (std::vector<double>* side : {&a, &b}) {
      for (double& x : *side) x *= mean / s;
    }
    return true;
  }
};

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
  contrast.share.clear();  // sides that agree have one distribution
  contrast.dof.assign(contrast.channels, static_cast<double>(a.sampled() + b.sampled()) - 2);
  return contrast;
}

PooledReplicates::PooledReplicates(std::size_t channels, std::size_t replicates_a, std::size_t replicates_b,
                                   double power)
    : channels_(channels),
      power_(power),
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
  result.ratio = ratio_of(contrast.difference[c]);
  result.log_error = std::sqrt(contrast.variance[c]);
  result.t = strongest.t;
  result.dof = contrast.dof[c];
  result.ratio_all = ratio_of(contrast.difference[channels_]);
  result.log_error_all = std::sqrt(contrast.variance[channels_]);
  for (std::size_t k = 0; k <= channels_; ++k) {
    RelativeError e{static_cast<float>(std::sqrt(contrast.variance[k])), 0,
                    static_cast<float>(contrast.dof[k]), static_cast<uint32_t>(k)};
    set_sides(contrast, k, e);
    if (used[k]) result.errors.add(e, e);
  }
  return result;
}

// a and b are the means of the two sides, p (a + b) / 2 was scaled to p: a - b = D gives a / b.
double PooledReplicates::ratio_of(double difference) const {
  return std::pow((2 * power_ + difference) / (2 * power_ - difference), power_);
}

PooledVarianceTest::PooledVarianceTest(std::size_t channels, std::size_t replicates_a,
                                       std::size_t replicates_b)
    : channels_(channels),
      scatter_(channels, replicates_a, replicates_b, 2),
      variance_(channels, replicates_a, replicates_b, 1) {}

void PooledVarianceTest::add(const UnitSample& a, const UnitSample& b, const std::vector<bool>& wanted,
                             double rounding) {
  if (a.sampled() < a.replicates() || b.sampled() < b.replicates()) return;
  const UnitSample da = deviations_from_median(a, &b), db = deviations_from_median(b, &a);
  for (std::size_t c = 0; c < channels_; ++c) {
    if (!wanted.empty() && !wanted[c]) continue;
    double level = 0;
    for (std::size_t r = 0; r < a.replicates(); ++r) level = std::max(level, std::abs(a.mean_at(r, c)));
    const double floor = rounding * level;
    RelativeNumbers cut{sampled_values(da, c), sampled_values(db, c)}, squares = cut;
    const double most = kScatterCut * median_of_both(cut.a, cut.b);
    for (std::vector<double>* side : {&cut.a, &cut.b}) {
      for (double& d : *side) d = std::min(d, most);
    }
    for (std::vector<double>* side : {&squares.a, &squares.b}) {
      for (double& d : *side) d *= d;
    }
    if (cut.normalise(2, floor))
      scatter_.add(c, cut.a, cut.b);
    else
      scatter_.skip();
    if (squares.normalise(1, floor * floor))
      variance_.add(c, squares.a, squares.b);
    else
      variance_.skip();
  }
}

}  // namespace kiloband::stats
