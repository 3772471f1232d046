// What `kiloband compare` says: a table for people, JSON for programs.
#pragma once

#include <string>
#include <vector>

#include "cube/cube_io.hpp"
#include "stats/comparison/comparison.hpp"

namespace kiloband {

struct CompareReport {
  std::string a, b;  // what the sides are
  Quantity quantity = Quantity::kIntegral;
  std::vector<Band> bands;
  std::size_t missing_pixels = 0;      // without values on both sides
  std::size_t missing_replicates = 0;  // replicate means of other pixels without samples
  stats::Comparison result;
};

std::string compare_text(const CompareReport& report);
std::string compare_json(const CompareReport& report);

}  // namespace kiloband
