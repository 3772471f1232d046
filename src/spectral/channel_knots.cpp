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

double largest_value(const ChannelKnots& knots, std::size_t k) {
  double largest = 0;
  for (uint32_t i = knots.first[k]; i < knots.first[k + 1]; ++i)
    largest = std::max(largest, std::abs(knots.value[i]));
  return largest;
}

/// What begins or ends at a value: the parts of the channel that have values between two of them, or an atom,
/// the part that has this very value.
struct LevelEvent {
  double value;
  double density = 0;  // added to the fraction of the channel per value / scale
  int pieces = 0;      // added to the number of pieces that rise or fall through the values above
  double atom = 0;     // fraction of the channel
};

/// The distribution of a channel's values: a piece that runs straight from a to b has all values between them
/// with the same density, whatever its width, so nothing is sampled. scale: the largest value.
std::vector<LevelEvent> level_events(const ChannelKnots& sampled, std::size_t k, double scale) {
  constexpr double kFlat = 1e-14;      // of the values: their rounding
  constexpr double kSteepest = 1e290;  // so that sums are finite
  std::vector<LevelEvent> events;
  for (uint32_t i = sampled.first[k]; i + 1 < sampled.first[k + 1]; ++i) {
    const double width = sampled.mu[i + 1] - sampled.mu[i];
    if (!(width > 0)) continue;
    const auto [low, high] = std::minmax(sampled.value[i], sampled.value[i + 1]);
    const double density = width / ((high - low) / scale);
    if (high - low <= kFlat * std::max(std::abs(low), std::abs(high)) || !(density < kSteepest)) {
      events.push_back({.value = low, .atom = width});
    } else {
      events.push_back({.value = low, .density = density, .pieces = 1});
      events.push_back({.value = high, .density = -density, .pieces = -1});
    }
  }
  std::ranges::sort(events, {}, &LevelEvent::value);
  return events;
}

/// A sum whose error does not grow with terms that come and go: the steep density of a piece that is almost flat
/// would else leave its rounding behind (Neumaier 1974).
class CompensatedSum {
 public:
  void add(double x) {
    const double sum = sum_ + x;
    rest_ += std::abs(sum_) >= std::abs(x) ? (sum_ - sum) + x : (x - sum) + sum_;
    sum_ = sum;
  }
  void clear() { sum_ = rest_ = 0; }
  double value() const { return sum_ + rest_; }

 private:
  double sum_ = 0, rest_ = 0;
};

/// Drops points of an ascending curve that lie within a tolerance of the straight line between those that
/// stay. The slopes that keep within it, seen from the last point that stays, form an interval that shrinks
/// from point to point. Between the points the curve is straight, so that the tolerance holds there, too.
class Thinner {
 public:
  Thinner(Builder& builder, double value, double least) : builder_(builder), least_(least) {
    begin(0, value);
  }

  /// mu, value: not below the last; another value at the same mu is a jump.
  void add(double mu, double value) {
    const double tolerance = kTolerance * std::abs(value) + least_;
    if (mu == mu_) {
      if (value - value_ > tolerance) begin(mu, value);
      return;
    }
    const double slope = (value - value_) / (mu - mu_);
    if (slope < low_ || slope > high_) {
      begin(last_mu_, last_value_);
      add(mu, value);
      return;
    }
    low_ = std::max(low_, (value - tolerance - value_) / (mu - mu_));
    high_ = std::min(high_, (value + tolerance - value_) / (mu - mu_));
    last_mu_ = mu;
    last_value_ = value;
  }
  void finish() {
    if (mu_ < 1) builder_.add(1, last_value_);
  }

 private:
  static constexpr double kTolerance = 3e-4;
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  void begin(double mu, double value) {
    builder_.add(mu, value);
    mu_ = last_mu_ = mu;
    value_ = last_value_ = value;
    low_ = -kInfinity;
    high_ = kInfinity;
  }

  Builder& builder_;
  double mu_ = 0, value_ = 0, last_mu_ = 0, last_value_ = 0, least_;
  double low_ = -kInfinity, high_ = kInfinity;
};

/// The inverse of the distribution: mu is the fraction of the channel with smaller values. It is straight
/// between the values of the data, level at atoms, and jumps where the channel has no values between two.
void add_sorted(Builder& builder, const std::vector<LevelEvent>& events, double scale) {
  constexpr double kNothing = 1e-9;  // of the largest value
  Thinner thinner(builder, events.front().value, kNothing * scale);
  CompensatedSum below, density;
  int pieces = 0;
  double mu = 0, value = events.front().value;
  const auto add = [&] {
    mu = std::clamp(below.value(), mu, 1.0);  // never descends, however sums round
    thinner.add(mu, value);
  };
  for (const LevelEvent& event : events) {
    if (event.value > value) {
      if (pieces > 0) below.add(std::max(density.value(), 0.0) * ((event.value - value) / scale));
      value = event.value;
      add();
    }
    density.add(event.density);
    pieces += event.pieces;
    if (pieces == 0) density.clear();
    if (event.atom > 0) {
      below.add(event.atom);
      add();
    }
  }
  thinner.finish();
}

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
  ChannelKnots sorted;
  Builder builder(sorted);
  for (std::size_t k = 0; k + 1 < sampled.first.size(); ++k) {
    const double scale = largest_value(sampled, k);
    add_sorted(builder, level_events(sampled, k, scale), scale);
    builder.end_channel();
  }
  return sorted;
}

}  // namespace kiloband
