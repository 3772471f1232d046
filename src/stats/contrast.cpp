#include "stats/contrast.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "stats/distributions.hpp"

namespace kiloband::stats {
namespace {

/// Of the rounding: replicates whose mean has a smaller standard error agree.
constexpr double kAgreeing = 0.01;

bool agrees(double variance, double slack) {
  return variance <= kAgreeing * slack * kAgreeing * slack;
}

/// Mean and variance of the mean of one side; its rows go to the contrast.
struct Side {
  std::vector<double> mean, variance;  // [channel]
  double dof = 0;
};

double total_weight(const UnitSample& s) {
  double total = 0;
  for (const double w : s.weights) total += w;
  return total;
}

std::vector<double> mean_of(const UnitSample& s, double total) {
  std::vector<double> mean(s.channels);
  for (std::size_t r = 0; r < s.replicates(); ++r) {
    const double w = s.weights[r] / total;
    if (w == 0) continue;
    for (std::size_t c = 0; c < s.channels; ++c) mean[c] += w * s.mean_at(r, c);
  }
  return mean;
}

/// Weights that sum to 1 may miss it by a rounding error: replicates that are all the same are their mean.
void settle_constants(const UnitSample& s, std::vector<double>& mean) {
  const auto first = std::ranges::find_if(s.weights, [](double w) { return w > 0; });
  const auto r0 = static_cast<std::size_t>(first - s.weights.begin());
  for (std::size_t c = 0; c < s.channels; ++c) {
    bool same = true;
    for (std::size_t r = r0; r < s.replicates() && same; ++r)
      same = s.weights[r] == 0 || s.mean_at(r, c) == s.mean_at(r0, c);
    if (same) mean[c] = s.mean_at(r0, c);
  }
}

Side add_side(const UnitSample& s, Contrast& contrast) {
  const double total = total_weight(s);
  Side side{mean_of(s, total), std::vector<double>(s.channels), static_cast<double>(s.sampled()) - 1};
  settle_constants(s, side.mean);
  RowGroup group;
  for (std::size_t r = 0; r < s.replicates(); ++r) {
    if (s.weights[r] == 0) continue;
    group.root.push_back(std::sqrt(s.weights[r] / total));
    const double scale = std::sqrt(s.weights[r] / (total * side.dof));
    for (std::size_t c = 0; c < s.channels; ++c) {
      const double e = scale * (s.mean_at(r, c) - side.mean[c]);
      contrast.rows.push_back(e);
      side.variance[c] += e * e;
    }
  }
  contrast.groups.push_back(std::move(group));
  return side;
}

Contrast empty_contrast(std::size_t channels, bool valid) {
  Contrast contrast;
  contrast.channels = channels;
  contrast.valid = valid;
  return contrast;
}

void set_slack(Contrast& contrast, double rounding) {
  for (std::size_t c = 0; c < contrast.channels; ++c) {
    contrast.difference.push_back(contrast.a[c] - contrast.b[c]);
    contrast.slack.push_back(rounding * std::max(std::abs(contrast.a[c]), std::abs(contrast.b[c])));
  }
}

/// Of one side alone, whose mean is held against 0 or a truth. The slack is that of rounding.
void set_variances(Side side, Contrast& contrast) {
  const double chance = chance_agreement(side.dof + 1, 0);
  for (std::size_t c = 0; c < contrast.channels; ++c)
    contrast.agreement.push_back(agrees(side.variance[c], contrast.slack[c]) ? chance : 0);
  contrast.dof.assign(contrast.channels, side.dof);
  contrast.variance = std::move(side.variance);
}

}  // namespace

double Contrast::t(std::size_t c) const {
  const double beyond = std::abs(difference[c]) - slack[c];
  if (beyond <= 0) return 0;
  const double t =
      variance[c] > 0 ? beyond / std::sqrt(variance[c]) : std::numeric_limits<double>::infinity();
  return std::copysign(t, difference[c]);
}

double Contrast::p(std::size_t c) const {
  const double p = share.empty() ? student_p(t(c), dof[c]) : behrens_fisher_p(t(c), share[c], dof_a, dof_b);
  return std::max(p, least_p(c));
}

double chance_agreement(double a, double b) {
  if (!std::isfinite(a + b)) return 0;
  // max_p p^m (1 - p)^n
  const auto most = [](double m, double n) {
    return std::exp((m > 0 ? m * std::log(m / (m + n)) : 0) + n * std::log(n / (m + n)));
  };
  const double p = b == 0 ? std::exp2(1 - a) : std::min(most(a - 1, b), most(b - 1, a));
  return p < kNoChance ? 0 : p;
}

void add_variances(double va, double vb, Contrast& contrast) {
  const double slack = contrast.slack[contrast.variance.size()];
  const double dof_a = contrast.dof_a, dof_b = contrast.dof_b;
  contrast.variance.push_back(va + vb);
  // In shares, since squares of tiny variances would underflow.
  const double share = va + vb > 0 ? va / (va + vb) : 0.5;
  contrast.dof.push_back(1 / (share * share / dof_a + (1 - share) * (1 - share) / dof_b));
  const bool a = agrees(va, slack), b = agrees(vb, slack);
  const double worst = dof_a < dof_b ? 1 : 0;
  contrast.share.push_back(a != b ? worst : share);
  contrast.agreement.push_back(a && b ? chance_agreement(dof_a + 1, dof_b + 1) : 0);
}

Contrast independent_contrast(const UnitSample& a, const UnitSample& b, double rounding) {
  Contrast contrast = empty_contrast(a.channels, a.sampled() >= 2 && b.sampled() >= 2);
  if (!contrast.valid) return contrast;
  const Side sa = add_side(a, contrast), sb = add_side(b, contrast);
  contrast.a = sa.mean;
  contrast.b = sb.mean;
  contrast.dof_a = sa.dof;
  contrast.dof_b = sb.dof;
  set_slack(contrast, rounding);
  for (auto* numbers : {&contrast.variance, &contrast.dof, &contrast.share, &contrast.agreement})
    numbers->reserve(a.channels);
  for (std::size_t c = 0; c < a.channels; ++c) add_variances(sa.variance[c], sb.variance[c], contrast);
  return contrast;
}

Contrast paired_contrast(const UnitSample& a, const UnitSample& b, double rounding) {
  if (a.replicates() != b.replicates())
    throw std::logic_error("paired_contrast: other numbers of replicates");
  UnitSample d{a.channels, std::vector<double>(a.means.size()), a.weights}, a_both = a, b_both = b;
  for (std::size_t r = 0; r < a.replicates(); ++r) {
    d.weights[r] = a_both.weights[r] = b_both.weights[r] = std::min(a.weights[r], b.weights[r]);
    for (std::size_t c = 0; c < a.channels; ++c)
      d.means[r * a.channels + c] = a.mean_at(r, c) - b.mean_at(r, c);
  }
  Contrast contrast = empty_contrast(a.channels, d.sampled() >= 2);
  if (!contrast.valid) return contrast;
  Side side = add_side(d, contrast);
  contrast.a = mean_of(a_both, total_weight(d));
  contrast.b = mean_of(b_both, total_weight(d));
  set_slack(contrast, rounding);
  contrast.difference = side.mean;  // not the difference of two rounded means
  set_variances(std::move(side), contrast);
  return contrast;
}

Contrast truth_contrast(const UnitSample& a, const TruthValues& truth, double rounding) {
  Contrast contrast = empty_contrast(a.channels, a.sampled() >= 2);
  if (!contrast.valid) return contrast;
  Side side = add_side(a, contrast);
  contrast.a = side.mean;
  contrast.b = truth.value;
  set_slack(contrast, rounding);
  set_variances(std::move(side), contrast);
  for (std::size_t c = 0; c < truth.bound.size(); ++c) contrast.slack[c] += truth.bound[c];
  return contrast;
}

double contributions(const UnitSample& sample, std::size_t channel) {
  double sampled = 0, zero = 0;
  for (std::size_t r = 0; r < sample.replicates(); ++r) {
    if (sample.weights[r] == 0) continue;
    ++sampled;
    zero += sample.mean_at(r, channel) == 0;
  }
  if (sampled == 0) return 0;
  return zero == 0 ? std::numeric_limits<double>::infinity() : -sampled * std::log(zero / sampled);
}

}  // namespace kiloband::stats
