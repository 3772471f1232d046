#include "src_gpu/tuning/tuner.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#include "src_gpu/path/path_pool.hpp"

namespace kiloband::opencl {
namespace {

/// Of paths: rungs below and above the usual number.
constexpr int kRungsBelow = 6, kRungsAbove = 4;
constexpr uint64_t kFewestPaths = 256, kSmallestGroup = 32;
/// A candidate that is slower by so much at first sight is not looked at again.
constexpr double kHopeless = 0.8;

constexpr const char* kSlots = "pool_slots";
constexpr const char* kPaths = "round_paths";
constexpr const char* kPathGroup = "path_group";
constexpr const char* kEvaluationGroup = "evaluation_group";

/// usual, and its multiples by powers of two within [fewest, most], which may end below the usual size.
Ladder around(const char* name, uint64_t usual, uint64_t fewest, uint64_t most) {
  Ladder ladder{name, {}, 0};
  uint64_t lowest = usual;
  while (lowest / 2 >= fewest) lowest /= 2;
  for (uint64_t value = lowest; value <= std::max(most, usual); value *= 2) {
    if (value > most && value != usual) continue;
    if (value == usual) ladder.start = ladder.values.size();
    ladder.values.push_back(value);
  }
  return ladder;
}

Ladder of_paths(const char* name, uint64_t usual, uint64_t paths) {
  constexpr uint64_t kLargest = uint64_t{1} << 40;
  const uint64_t all = std::bit_ceil(std::min(paths, kLargest));
  // Where all paths fit the usual size, sizes between come to the same as it.
  const uint64_t most = all <= usual ? all - 1 : std::min(usual << kRungsAbove, all);
  return around(name, usual, std::max(usual >> kRungsBelow, kFewestPaths), most);
}

/// What differs from the usual sizes.
Tuning tuning_of(const std::vector<Ladder>& ladders, const Rungs& rungs) {
  Tuning tuning;
  for (std::size_t l = 0; l < ladders.size(); ++l) {
    if (rungs[l] == ladders[l].start) continue;
    const uint64_t value = ladders[l].values[rungs[l]];
    const auto small = static_cast<uint32_t>(value);
    if (ladders[l].name == kSlots) tuning.pool_slots = small;
    if (ladders[l].name == kPaths) tuning.round_paths = value;
    if (ladders[l].name == kPathGroup) tuning.path_group = small;
    if (ladders[l].name == kEvaluationGroup) tuning.evaluation_group = small;
  }
  return tuning;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
}

/// How many times faster `other` is than `best`: the median of the ratios within rounds; 0: one does not work.
double speed_over(const Tuning& best, const Tuning& other, uint32_t rounds, const TimeRender& time) {
  std::vector<double> speeds;
  for (uint32_t round = 0; round < rounds; ++round) {
    const auto mine = time(best), its = time(other);
    if (!mine || !its) return 0;
    speeds.push_back(*mine / *its);
    if (speeds.front() < kHopeless) break;
  }
  return median(speeds);
}

}  // namespace

std::vector<Ladder> tuning_ladders(const TuningBounds& bounds) {
  std::vector<Ladder> ladders{of_paths(kSlots, bounds.pool_slots, bounds.paths)};
  if (bounds.method != Method::kPt) ladders.push_back(of_paths(kPaths, bounds.round_paths, bounds.paths));
  if (bounds.cpu_device) return ladders;
  ladders.push_back(around(kPathGroup, bounds.path_group, kSmallestGroup, bounds.largest_group));
  ladders.push_back(
      around(kEvaluationGroup, bounds.evaluation_group, kSmallestGroup, bounds.largest_evaluation_group));
  return ladders;
}

TuningBounds tuning_bounds(const DeviceInfo& device, const TunedRender& render, uint64_t memory_budget) {
  const auto shape = [&](std::optional<uint32_t> largest) {
    return evaluation_shape(device, render.task, largest);
  };
  const auto group = [&](std::optional<uint32_t> largest) { return shape(largest).group_size(); };
  KbSpectraLayout layout{};
  layout.stride = render.task.channels;
  TuningBounds bounds;
  bounds.method = render.task.method;
  bounds.cpu_device = device.type == DeviceType::kCpu;
  bounds.pool_slots = usual_slots(bounds.cpu_device, memory_budget, slot_bytes(layout, shape({})));
  bounds.round_paths = usual_jobs(bounds.cpu_device, memory_budget);
  bounds.path_group = kPoolLocalSize;
  bounds.evaluation_group = group({});
  bounds.items_of_path = shape({}).local_size;
  bounds.largest_group = std::min<uint64_t>(device.max_work_group_size, KB_LARGEST_PATH_GROUP);
  bounds.largest_evaluation_group = group(static_cast<uint32_t>(device.max_work_group_size));
  bounds.paths = render.paths;
  return bounds;
}

TuneOutcome find_tuning(const TuningBounds& bounds, const TimeRender& time, const TuneSettings& settings) {
  const std::vector<Ladder> ladders = tuning_ladders(bounds);
  const auto compare = [&](const Rungs& best, const Rungs& other) {
    const Tuning tried = tuning_of(ladders, other);
    const double speed = speed_over(tuning_of(ladders, best), tried, settings.rounds, time);
    if (!settings.stop()) settings.told(tried, speed);  // what was stopped was not compared
    return speed;
  };
  TuneOutcome outcome;
  outcome.tuning = tuning_of(ladders, climb(ladders, settings.least_gain, compare, settings.stop));
  if (outcome.tuning == Tuning{} || settings.stop()) return outcome;
  outcome.speed_up = speed_over({}, outcome.tuning, 2 * settings.rounds, time);
  if (outcome.speed_up < settings.least_gain) return {};
  return outcome;
}

}  // namespace kiloband::opencl
