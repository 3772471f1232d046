// How far the device may be from the CPU, and counts of what is.
#pragma once

#include "probe.hpp"

namespace kiloband::test {

/// The allowances:
///   values, weights, densities  relative 2e-6 (exp, erf and sqrt of the device are within a few ulp), plus
///       what the two ways to write Fresnel's reflectance F differ by: the CPU subtracts nearly equal numbers
///       where F is small, which costs 5e-7 / sqrt(F) of F, and about eight roundings on either side leave
///       1e-6 of uncertainty in 1 - F.
///   directions  1e-5 for all but one in 10^4 (Newton's method for Beckmann's normals may stop at either side
///       of its threshold), 1e-3 for all. Weights and densities of a sample are therefore compared with the
///       CPU's for the DEVICE's direction: at alpha = 1e-4 one ulp of a direction is 1e-3 of a density.
///   decisions  (what is sampled at all, the lobe, the kind) may differ for one query in 10^4: u within
///       rounding of a probability.
class Comparison {
 public:
  explicit Comparison(const Scene& scene) : scene_(scene) {}

  /// Adds failures to the current test for what is beyond the allowances.
  void check(const std::vector<Query>& queries, const Answers& cpu, const Answers& device);

 private:
  void check_value(const Query& query, const Value& cpu, const Value& device);
  void check_sample(const Query& query, const Sample& cpu, const Sample& device, bool transmitted);

  const Scene& scene_;
  int decisions_ = 0, far_ = 0;
};

}  // namespace kiloband::test
