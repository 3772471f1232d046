// Compares reported standard errors with the spread that is seen over independent seeds.
//
// A unit (a pixel's channel, a tile's channel ...) has, for every seed s, a mean m_s and the reported
// variance V_s of that mean. If error bars are honest, E[V_s] = Var(m_s): the average of V_s over seeds
// estimates the same number as the sample variance S^2 of the m_s. Units are pooled as q = mean over units of
// S^2 / average V, so that bright and dark units weigh alike; the ratio of standard errors, reported over
// seen, is 1 / sqrt(q).
//
// Units of one image are dependent (they share paths, and wavelength offsets over 32 x 32 pixels); seeds are
// not. The ratio's own standard error is therefore a jackknife over groups of seeds,
// which assumes nothing about units.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace kiloband::test {

struct ErrorBarRatio {
  double value = 0;           // reported standard error over the spread that is seen
  double standard_error = 0;  // of value, by the jackknife
};

class ErrorBarStudy {
 public:
  /// groups: of the jackknife; seeds are dealt to them in turn. With 200 its own error is 5 %.
  explicit ErrorBarStudy(std::size_t groups = 200) : groups_(groups) {}

  /// The units' means and reported variances of one more seed; the same number of units each time.
  void add(std::span<const double> means, std::span<const double> variances);
  /// Needs three seeds. Groups without a seed do not count. Units whose reported variance is 0 for every seed
  /// are left out if their spread is 0 too, and make the ratio 0 if it is not.
  ErrorBarRatio ratio() const;
  /// Mean over all seeds and the standard error of it that their spread gives, of one unit.
  double grand_mean(std::size_t unit) const;
  double grand_standard_error(std::size_t unit) const;
  std::size_t seeds() const { return seeds_; }

 private:
  /// Sums over seeds; deviations are from the first seed's mean, which keeps squares from cancelling.
  struct Sums {
    double seeds = 0;
    std::vector<double> deviation, square, reported;
  };

  Sums all_but(const Sums* left_out) const;
  static double ratio_of(const Sums& sums);

  std::vector<Sums> groups_;
  std::vector<double> reference_;
  std::size_t seeds_ = 0;
};

/// The check of all tests here: the ratio is within 10 % of 1, and known to `largest_standard_error`. The
/// ratio is also noted as a property `name` of the running test.
void expect_honest(const std::string& name, const ErrorBarStudy& study, double largest_standard_error);

}  // namespace kiloband::test
