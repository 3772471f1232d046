#include "stats/uniformity.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stats/distributions.hpp"
#include "stats/random.hpp"

namespace kiloband::stats {
namespace {

struct Sums {
  double n = 0, x = 0, squares = 0;

  void add(double value) {
    ++n;
    x += value;
    squares += value * value;
  }
  double mean() const { return x / n; }
  double variance_of_mean() const { return std::max(0.0, squares - x * x / n) / (n * (n - 1)); }
};

/// The order in which replicates are dealt to sides, or their signs: one for all units.
struct Division {
  std::vector<std::size_t> order;
  std::vector<double> signs;
};

Division draw(std::size_t count, bool shuffled, Random& random) {
  Division d{std::vector<std::size_t>(count), std::vector<double>(count, 1.0)};
  std::iota(d.order.begin(), d.order.end(), std::size_t{0});
  if (!shuffled) return d;
  for (std::size_t k = count - 1; k > 0; --k) std::swap(d.order[k], d.order[random.below(k + 1)]);
  for (double& sign : d.signs) sign = random.uniform() < 0.5 ? -1 : 1;
  return d;
}

/// |t| of a unit whose values are dealt so; sizes of the sides: first_side, the rest (none: one-sample).
double t_of(const std::vector<double>& values, std::size_t first_side, const Division& division) {
  Sums a, b;
  const bool one_sample = first_side == values.size();
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double value = one_sample ? division.signs[k] * values[k] : values[division.order[k]];
    (k < first_side ? a : b).add(value);
  }
  const double difference = a.mean() - (one_sample ? 0 : b.mean());
  const double variance = a.variance_of_mean() + (one_sample ? 0 : b.variance_of_mean());
  return variance > 0 ? std::abs(difference) / std::sqrt(variance) : 0;
}

/// sup |F - G| of two sorted samples.
double distance(const std::vector<double>& f, const std::vector<double>& g) {
  double largest = 0;
  std::size_t j = 0;
  for (std::size_t i = 0; i < f.size();) {
    const double x = f[i];
    const double before = static_cast<double>(i) / static_cast<double>(f.size());
    while (j < g.size() && g[j] < x) ++j;
    largest = std::max(largest, std::abs(before - static_cast<double>(j) / static_cast<double>(g.size())));
    while (i < f.size() && f[i] == x) ++i;
    while (j < g.size() && g[j] == x) ++j;
    const double after = static_cast<double>(i) / static_cast<double>(f.size());
    largest = std::max(largest, std::abs(after - static_cast<double>(j) / static_cast<double>(g.size())));
  }
  return largest;
}

}  // namespace

Uniformity::Uniformity(std::size_t units, uint64_t seed)
    : keep_(static_cast<double>(kUniformityMostUnits) / static_cast<double>(std::max<std::size_t>(1, units))),
      seed_(seed) {}

std::ptrdiff_t Uniformity::choose(const Contrast& contrast, const std::vector<bool>& wanted) {
  Random random(mix_seed(seed_, ++seen_));
  if (!contrast.valid || random.uniform() > keep_) return -1;
  std::vector<std::size_t> channels;
  for (std::size_t c = 0; c < contrast.channels; ++c) {
    if ((wanted.empty() || wanted[c]) && !contrast.constant(c)) channels.push_back(c);
  }
  return channels.empty() ? -1 : static_cast<std::ptrdiff_t>(channels[random.below(channels.size())]);
}

// Values are centred and scaled, so that sums of squares lose no digits.
void Uniformity::add(const Contrast& contrast, const UnitSample& a, const UnitSample& b,
                     const std::vector<bool>& wanted) {
  const std::ptrdiff_t chosen = choose(contrast, wanted);
  if (chosen < 0 || a.sampled() < a.replicates() || b.sampled() < b.replicates()) return;
  const auto c = static_cast<std::size_t>(chosen);
  const double scale = 1 / std::sqrt(contrast.variance[c]);
  Unit unit;
  for (std::size_t r = 0; r < a.replicates(); ++r)
    unit.a.push_back(scale * (a.mean_at(r, c) - contrast.b[c]));
  for (std::size_t r = 0; r < b.replicates(); ++r)
    unit.b.push_back(scale * (b.mean_at(r, c) - contrast.b[c]));
  units_.push_back(std::move(unit));
  result_.p_values.push_back(student_p(scale * contrast.difference[c], contrast.dof[c]));
}

void Uniformity::add(const Contrast& contrast, const UnitSample& a, const std::vector<bool>& wanted) {
  UnitSample none{a.channels, {}, {}};
  add(contrast, a, none, wanted);
}

UniformityResult Uniformity::finish() {
  result_.units = units_.size();
  if (units_.size() < kUniformityUnits) return std::move(result_);
  const std::size_t first = units_.front().a.size();
  for (Unit& unit : units_) unit.a.insert(unit.a.end(), unit.b.begin(), unit.b.end());
  Random random(mix_seed(seed_, 0));
  std::vector<std::vector<double>> t(kDivisions + 1);  // the first: as observed
  std::vector<double> reference;
  for (int d = 0; d <= kDivisions; ++d) {
    const Division division = draw(units_.front().a.size(), d > 0, random);
    for (const Unit& unit : units_) t[d].push_back(t_of(unit.a, first, division));
    std::ranges::sort(t[d]);
    if (d > 0) reference.insert(reference.end(), t[d].begin(), t[d].end());
  }
  std::ranges::sort(reference);
  result_.distance = distance(t[0], reference);
  double mean = 0;
  for (int d = 1; d <= kDivisions; ++d) mean += distance(t[d], reference) / kDivisions;
  const double root = kKolmogorovMean / mean;  // of n_eff
  result_.p = kolmogorov_p(root * result_.distance);
  return std::move(result_);
}

}  // namespace kiloband::stats
