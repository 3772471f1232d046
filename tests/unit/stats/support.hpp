// What the tests of comparisons ask of them.
#pragma once

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <string>
#include <vector>

#include "stats/comparison/comparison.hpp"

namespace kiloband::stats {

/// Names of the tests that a comparison made, in their order.
inline std::vector<std::string> names_of(const Comparison& c) {
  std::vector<std::string> names;
  for (const TestVerdict& test : c.tests) names.push_back(test.name);
  return names;
}

/// Two-sided p that m of n or more extreme successes have under probability p0 (twice the smaller tail).
inline double binomial_p(double successes, double trials, double p0) {
  const boost::math::binomial law(trials, p0);
  const double lower = boost::math::cdf(law, successes);
  const double upper = successes <= 0 ? 1 : boost::math::cdf(boost::math::complement(law, successes - 1));
  return std::min(1.0, 2 * std::min(lower, upper));
}

}  // namespace kiloband::stats
