// What the tests of comparisons ask of them.
#pragma once

#include <string>
#include <vector>

#include "stats/comparison.hpp"

namespace kiloband::stats {

/// Names of the tests that a comparison made, in their order.
inline std::vector<std::string> names_of(const Comparison& c) {
  std::vector<std::string> names;
  for (const TestVerdict& test : c.tests) names.push_back(test.name);
  return names;
}

}  // namespace kiloband::stats
