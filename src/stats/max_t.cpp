#include "stats/max_t.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stats/distributions.hpp"
#include "stats/random.hpp"

namespace kiloband::stats {
namespace {

/// Shares of smaller tails come near the smallest double, where there are no quantiles.
constexpr double kSmallestTail = 1e-290;

/// Channels whose degrees of freedom differ by more are held to pass each for itself (max_t.hpp).
constexpr double kAlike = 1.25;

bool is_wanted(const std::vector<bool>& wanted, std::size_t channel) {
  return wanted.empty() || wanted[channel];
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

void scale(std::vector<double>& v, double factor) {
  for (double& x : v) x *= factor;
}

/// Unit vectors of the channels that vary: the rows and, as last number, the difference itself, which is
/// D / sqrt(dof) in their scale.
class Directions {
 public:
  Directions(const Contrast& contrast, const std::vector<bool>& wanted) : contrast_(contrast) {
    for (std::size_t c = 0; c < contrast.channels; ++c) {
      if (is_wanted(wanted, c) && !contrast.constant(c)) add(c);
    }
    for (const RowGroup& group : contrast.groups) dimension_ += static_cast<double>(group.root.size()) - 1;
  }

  std::size_t count() const { return directions_.size(); }
  /// Of the space across a direction.
  double dimension() const { return dimension_ - 1; }
  double dof(std::size_t i) const { return dof_[i]; }
  const std::vector<double>& operator[](std::size_t i) const { return directions_[i]; }

  bool alike(std::size_t i, std::size_t k) const {
    return std::max(dof_[i], dof_[k]) <= kAlike * std::min(dof_[i], dof_[k]);
  }

  /// Per direction the cosine from which on its p is `p` or less.
  std::vector<double> cosines(double p) const {
    std::vector<double> cosines;
    for (std::size_t i = 0; i < count(); ++i) {
      if (i > 0 && dof_[i] == dof_[i - 1]) {  // quantiles take long; those of pairs and truths are one
        cosines.push_back(cosines.back());
        continue;
      }
      const double t = student_upper(0.5 * p, dof_[i]);
      cosines.push_back(t / std::sqrt(t * t + dof_[i]));
    }
    return cosines;
  }

  /// Uniform on the sphere, orthogonal to `axis` and to what rows cannot be (their weighted sums are 0).
  std::vector<double> draw_across(const std::vector<double>& axis, Random& random) const {
    std::vector<double> g(axis.size());
    for (double& x : g) x = random.normal();
    std::size_t first = 0;
    for (const RowGroup& group : contrast_.groups) {
      const double along = std::inner_product(group.root.begin(), group.root.end(), &g[first], 0.0);
      for (const double root : group.root) g[first++] -= along * root;
    }
    const double along = dot(g, axis);
    for (std::size_t i = 0; i < g.size(); ++i) g[i] -= along * axis[i];
    scale(g, 1 / std::sqrt(dot(g, g)));
    return g;
  }

 private:
  void add(std::size_t c) {
    const std::size_t rows = contrast_.rows.size() / contrast_.channels;
    const double root = std::sqrt(contrast_.variance[c]);
    std::vector<double> v;
    for (std::size_t r = 0; r < rows; ++r) v.push_back(contrast_.rows[r * contrast_.channels + c] / root);
    v.push_back(contrast_.t(c) / std::sqrt(contrast_.dof[c]));
    scale(v, 1 / std::sqrt(dot(v, v)));
    directions_.push_back(std::move(v));
    dof_.push_back(contrast_.dof[c]);
  }

  const Contrast& contrast_;
  std::vector<std::vector<double>> directions_;
  std::vector<double> dof_;
  double dimension_ = 1;
};

/// 1 / S of one draw: how many channels pass together with the given one. cosines: from where on they pass
double draw_share(const Directions& directions, std::size_t chosen, double p,
                  const std::vector<double>& cosines, Random& random) {
  const double dof = directions.dof(chosen);
  const double t = student_upper(0.5 * p * random.uniform(), dof);
  const double along = t / std::sqrt(t * t + dof), across = std::sqrt(dof / (t * t + dof));
  std::vector<double> g = directions.draw_across(directions[chosen], random);
  for (std::size_t i = 0; i < g.size(); ++i) g[i] = along * directions[chosen][i] + across * g[i];
  double passing = 1;
  for (std::size_t c = 0; c < directions.count(); ++c)
    passing += c != chosen && directions.alike(c, chosen) && std::abs(dot(directions[c], g)) >= cosines[c];
  return 1 / passing;
}

double largest_t(const Contrast& contrast) {
  double largest = 0;
  for (std::size_t c = 0; c < contrast.channels; ++c) largest = std::max(largest, std::abs(contrast.t(c)));
  return largest;
}

}  // namespace

// A channel with smaller |t| and fewer degrees of freedom than the best so far has a larger p: most tails
// need not be computed. One whose p has a floor (Contrast::least_p) is no such bound.
Strongest strongest_channel(const Contrast& contrast, const std::vector<bool>& wanted) {
  Strongest best;
  double best_t = -1, best_dof = 0;  // of p without a floor
  bool any = false;
  for (std::size_t c = 0; c < contrast.channels; ++c) {
    if (!is_wanted(wanted, c)) continue;
    (contrast.constant(c) ? best.constant : best.tested) += 1;
    const double t = contrast.t(c);
    if (std::abs(t) <= best_t && contrast.dof[c] <= best_dof) continue;
    const double p = std::max(student_p(t, contrast.dof[c]), contrast.least_p(c));
    if (any && (p > best.p || (p == best.p && std::abs(t) <= std::abs(best.t)))) continue;
    any = true;
    best.channel = c;
    best.t = t;
    best.p = p;
    if (contrast.least_p(c) > 0) continue;
    best_t = std::abs(t);
    best_dof = contrast.dof[c];
  }
  return best;
}

double max_t_p(const Contrast& contrast, const std::vector<bool>& wanted, const Strongest& strongest,
               uint64_t seed) {
  const auto tests = static_cast<double>(strongest.tested);
  const double p = std::max(strongest.p, contrast.p(strongest.channel));
  if (contrast.least_p(strongest.channel) > 0)  // any channel may agree by chance
    return std::min(1.0, (tests + static_cast<double>(strongest.constant)) * p);
  if (p <= 0 || strongest.tested <= 1) return p;
  if (contrast.rows.empty() || p < kSmallestTail) return std::min(1.0, tests * p);
  const Directions directions(contrast, wanted);
  if (p >= 1 || directions.dimension() < 1) return std::min(1.0, tests * p);
  const std::vector<double> cosines = directions.cosines(p);
  Random random(seed);
  double shares = 0;
  for (int i = 0; i < kRotations; ++i)
    shares += draw_share(directions, random.below(directions.count()), p, cosines, random);
  return std::clamp(tests * p * shares / kRotations, p, 1.0);
}

double label_permutation_p(const UnitSample& a, const UnitSample& b, int permutations, uint64_t seed) {
  UnitSample both = a, one = a, two = b;
  both.means.insert(both.means.end(), b.means.begin(), b.means.end());
  both.weights.insert(both.weights.end(), b.weights.begin(), b.weights.end());
  std::vector<std::size_t> order(both.replicates());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const double observed = largest_t(independent_contrast(a, b, 0));
  Random random(seed);
  int hits = 0;
  for (int i = 0; i < permutations; ++i) {
    for (std::size_t k = order.size() - 1; k > 0; --k) std::swap(order[k], order[random.below(k + 1)]);
    for (std::size_t k = 0; k < order.size(); ++k) {
      UnitSample& side = k < a.replicates() ? one : two;
      const std::size_t r = k < a.replicates() ? k : k - a.replicates();
      side.weights[r] = both.weights[order[k]];
      for (std::size_t c = 0; c < a.channels; ++c) side.means[r * a.channels + c] = both.mean_at(order[k], c);
    }
    hits += largest_t(independent_contrast(one, two, 0)) >= observed;
  }
  return (1.0 + hits) / (1.0 + permutations);
}

}  // namespace kiloband::stats
