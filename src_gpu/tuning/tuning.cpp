#include "src_gpu/tuning/tuning.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace kiloband::opencl {
namespace {

template <class T>
void add(std::string& text, const char* name, const std::optional<T>& value) {
  if (value) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, *value);
}

}  // namespace

Tuning merged(const Tuning& first, const Tuning& second) {
  Tuning tuning = second;
  if (first.pool_slots) tuning.pool_slots = first.pool_slots;
  if (first.round_paths) tuning.round_paths = first.round_paths;
  if (first.path_group) tuning.path_group = first.path_group;
  if (first.evaluation_group) tuning.evaluation_group = first.evaluation_group;
  return tuning;
}

std::string describe(const Tuning& tuning) {
  std::string text;
  add(text, "paths in flight", tuning.pool_slots);
  add(text, "paths of a round", tuning.round_paths);
  add(text, "group of path generation", tuning.path_group);
  add(text, "group of evaluation", tuning.evaluation_group);
  return text.empty() ? "the usual sizes" : text;
}

Tuning tuning_for(const std::vector<TunedMethod>& tuned, const std::string& method, uint32_t channels,
                  uint32_t items_of_path) {
  Tuning nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const TunedMethod& one : tuned) {
    const double apart = std::abs(std::log(static_cast<double>(one.channels) / channels));
    if (one.method != method || !(apart < least)) continue;
    least = apart;
    nearest = one.tuning;
    if (one.items_of_path != items_of_path) nearest.evaluation_group.reset();
  }
  return nearest;
}

}  // namespace kiloband::opencl
