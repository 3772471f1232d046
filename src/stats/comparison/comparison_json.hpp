// Parts of a comparison as JSON; what is written with them is described
// where it is (docs/compare.md, validation/suite/results.hpp).
#pragma once

#include <nlohmann/json.hpp>

#include "stats/scale_test.hpp"

namespace kiloband::stats {

/// null where it is not finite: JSON has no such numbers.
nlohmann::ordered_json number_json(double value);

nlohmann::ordered_json to_json(const WorstUnit& worst);

}  // namespace kiloband::stats
