#include "spectral/channel_knots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "base/error.hpp"

namespace kiloband {
namespace {

constexpr std::size_t kMaxKnots = std::size_t{1} << 28;
constexpr double kTableError = 1e-5;

/// Piecewise linear data over wavelength.
struct Curve {
  std::vector<double> lambda_nm, value;
  bool extrapolates = false;
};

Curve curve_of(const Spectrum& spectrum, const ChannelList& channels) {
  const auto knots = spectrum.knots_nm();
  const auto values = spectrum.knot_values();
  if (!knots.empty())
    return {{knots.begin(), knots.end()}, {values.begin(), values.end()}, spectrum.extrapolates()};
  const Channel range = hull(channels);
  const RegularTable table =
      resample(spectrum, range.min_nm, range.max_nm, ResampleOptions{.relative_error = kTableError});
  Curve curve{{}, table.values, table.extrapolate};
  for (std::size_t i = 0; i < table.values.size(); ++i)
    curve.lambda_nm.push_back(table.min_nm + table.step_nm * static_cast<double>(i));
  return curve;
}

/// Collects the knots of one channel after the other.
class Builder {
 public:
  explicit Builder(ChannelKnots& out) : out_(out) { out_.first.push_back(0); }

  void add(double mu, double value) {
    out_.mu.push_back(mu);
    out_.value.push_back(value);
  }
  void end_channel() { out_.first.push_back(static_cast<uint32_t>(out_.mu.size())); }

 private:
  ChannelKnots& out_;
};

/// The curve's value at lambda, taken between the knots i - 1 and i.
double value_before(const Curve& curve, std::size_t i, double lambda_nm) {
  if (i == 0) return curve.extrapolates ? curve.value.front() : 0;
  if (i == curve.lambda_nm.size()) return curve.extrapolates ? curve.value.back() : 0;
  const double t = (lambda_nm - curve.lambda_nm[i - 1]) / (curve.lambda_nm[i] - curve.lambda_nm[i - 1]);
  return (1 - t) * curve.value[i - 1] + t * curve.value[i];
}

/// A knot of the data inside the channel; at an end of data that are not continued, two.
void add_knot(Builder& builder, const Curve& curve, std::size_t i, double mu) {
  const bool ends = !curve.extrapolates;
  if (ends && i == 0) builder.add(mu, 0);
  builder.add(mu, curve.value[i]);
  if (ends && i + 1 == curve.lambda_nm.size()) builder.add(mu, 0);
}

void add_channel(Builder& builder, const Curve& curve, const Channel& c) {
  const std::vector<double>& lambda = curve.lambda_nm;
  auto i = static_cast<std::size_t>(std::ranges::upper_bound(lambda, c.min_nm) - lambda.begin());
  builder.add(0, value_before(curve, i, c.min_nm));
  for (; i < lambda.size() && lambda[i] < c.max_nm; ++i)
    add_knot(builder, curve, i, std::clamp((lambda[i] - c.min_nm) / c.width_nm(), 0.0, 1.0));
  builder.add(1, value_before(curve, i, c.max_nm));
  builder.end_channel();
}

void check_size(std::size_t knots, const std::string& name) {
  if (knots > kMaxKnots)
    throw InputError(name + ": the channels together contain more than 268435456 points of its data");
}

struct Weighted {
  double value, weight;
};

/// The values of a channel with the fractions of it that have them:
/// each piece in equal parts, by their middles.
std::vector<Weighted> values_of_channel(const ChannelKnots& sampled, std::size_t k) {
  constexpr std::size_t kParts = 8, kFewest = 4096;
  const uint32_t first = sampled.first[k], end = sampled.first[k + 1];
  const std::size_t parts = std::max(kParts, kFewest / (end - first));
  std::vector<Weighted> values;
  for (uint32_t i = first; i + 1 < end; ++i) {
    const double width = sampled.mu[i + 1] - sampled.mu[i];
    if (!(width > 0)) continue;
    for (std::size_t j = 0; j < parts; ++j) {
      const double t = (static_cast<double>(j) + 0.5) / static_cast<double>(parts);
      values.push_back(
          {(1 - t) * sampled.value[i] + t * sampled.value[i + 1], width / static_cast<double>(parts)});
    }
  }
  std::ranges::sort(values, {}, &Weighted::value);
  return values;
}

/// Drops points of an ascending curve that lie within a tolerance of the straight line between those that
/// stay. The slopes that keep within it, seen from the last point that stays, form an interval that shrinks
/// from point to point.
class Thinner {
 public:
  Thinner(Builder& builder, double mu, double value, double least)
      : builder_(builder), mu_(mu), value_(value), last_mu_(mu), last_value_(value), least_(least) {
    builder_.add(mu, value);
  }

  void add(double mu, double value) {
    const double slope = (value - value_) / (mu - mu_);
    if (slope < low_ || slope > high_) keep_last();
    const double tolerance = kTolerance * value + least_;
    low_ = std::max(low_, (value - tolerance - value_) / (mu - mu_));
    high_ = std::min(high_, (value + tolerance - value_) / (mu - mu_));
    last_mu_ = mu;
    last_value_ = value;
  }
  void finish() { builder_.add(1, last_value_); }

 private:
  static constexpr double kTolerance = 3e-4;
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  void keep_last() {
    builder_.add(last_mu_, last_value_);
    mu_ = last_mu_;
    value_ = last_value_;
    low_ = -kInfinity;
    high_ = kInfinity;
  }

  Builder& builder_;
  double mu_, value_, last_mu_, last_value_, least_;
  double low_ = -kInfinity, high_ = kInfinity;
};

}  // namespace

double ChannelKnots::operator()(std::size_t channel, double at_mu) const {
  const auto begin = mu.begin() + first[channel], end = mu.begin() + first[channel + 1];
  const auto above = std::upper_bound(begin, end, at_mu);
  if (above == begin) return value[first[channel]];
  if (above == end) return value[first[channel + 1] - 1];
  const auto i = static_cast<std::size_t>(above - mu.begin());
  const double t = (at_mu - mu[i - 1]) / (mu[i] - mu[i - 1]);
  return std::lerp(value[i - 1], value[i], t);  // never descends between ascending knots
}

ChannelKnots sampled_knots(const Spectrum& spectrum, const ChannelList& channels, const std::string& name) {
  const Curve curve = curve_of(spectrum, channels);
  ChannelKnots knots;
  Builder builder(knots);
  for (const Channel& channel : channels) {
    add_channel(builder, curve, channel);
    check_size(knots.mu.size(), name);
  }
  return knots;
}

ChannelKnots sorted_knots(const ChannelKnots& sampled) {
  constexpr double kNothing = 1e-9;  // of the largest value
  ChannelKnots sorted;
  Builder builder(sorted);
  for (std::size_t k = 0; k + 1 < sampled.first.size(); ++k) {
    const std::vector<Weighted> values = values_of_channel(sampled, k);
    double below = 0;
    Thinner thinner(builder, 0, values.front().value, kNothing * values.back().value);
    for (const Weighted& v : values) {
      thinner.add(below + 0.5 * v.weight, v.value);
      below += v.weight;
    }
    thinner.finish();
    builder.end_channel();
  }
  return sorted;
}

}  // namespace kiloband
