// Parts of a comparison as JSON; what is written with them is described
// where it is (docs/compare.md, validation/suite/results.hpp).
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "stats/scale_test.hpp"
#include "stats/tails.hpp"

namespace kiloband::stats {

/// null where it is not finite: JSON has no such numbers.
nlohmann::ordered_json number_json(double value);

nlohmann::ordered_json to_json(const WorstUnit& worst);

/// What files call the members of a TailWeight.
struct TailNames {
  const char *count, *top_variance, *top_sum;
};
/// The channel with the smallest effective share; null where there is none.
nlohmann::ordered_json heaviest_json(const std::vector<TailWeight>& tails, const TailNames& names);

}  // namespace kiloband::stats
