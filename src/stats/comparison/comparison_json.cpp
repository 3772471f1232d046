#include "stats/comparison/comparison_json.hpp"

#include <cmath>

namespace kiloband::stats {

nlohmann::ordered_json number_json(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json to_json(const WorstUnit& worst) {
  return {{"x", worst.place.x},
          {"y", worst.place.y},
          {"width", worst.place.width},
          {"height", worst.place.height},
          {"pooled", worst.place.pooled},
          {"channel", worst.channel},
          {"a", number_json(worst.a)},
          {"b", number_json(worst.b)},
          {"difference", number_json(worst.difference)},
          {"standard_error", number_json(worst.standard_error)},
          {"t", number_json(worst.t)},
          {"dof", number_json(worst.dof)},
          {"p", number_json(worst.p)}};
}

nlohmann::ordered_json heaviest_json(const std::vector<TailWeight>& tails, const TailNames& names) {
  if (tails.empty()) return nullptr;
  const std::size_t channel = heaviest_channel(tails);
  const TailWeight& t = tails[channel];
  return {{"channel", channel},
          {names.count, t.count},
          {"effective", number_json(t.effective)},
          {names.top_variance, number_json(t.top_variance)},
          {names.top_sum, number_json(t.top_sum)},
          {"hill_index", number_json(t.hill_index)}};
}

}  // namespace kiloband::stats
