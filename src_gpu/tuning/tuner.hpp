// Finds the sizes that a device renders fastest with (`kiloband tune`).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "src_gpu/device/device.hpp"
#include "src_gpu/evaluate/evaluation.hpp"
#include "src_gpu/tuning/ladder_search.hpp"
#include "src_gpu/tuning/tuning.hpp"

namespace kiloband::opencl {

/// Where the search begins, and what it leaves alone.
struct TuningBounds {
  Method method = Method::kDpeptBatch;
  bool cpu_device = false;                // groups of one work-item: sizes of groups are not searched
  uint64_t pool_slots = 0;                // the usual ones
  uint64_t round_paths = 0;               // of dpept
  uint64_t path_group = 0;                // of GPUs
  uint64_t evaluation_group = 0;          // of GPUs
  uint32_t items_of_path = 1;             // EvaluationShape::local_size, usually
  uint64_t largest_group = 0;             // that the device and the kernels have
  uint64_t largest_evaluation_group = 0;  // that the channels have work for, too
  uint64_t paths = ~uint64_t{0};          // of a timed render: no more are ever in flight or in a round
};

/// What of a render the sizes depend on.
struct TunedRender {
  EvaluationTask task;
  uint64_t paths = 0;
};
/// Those of a device that nobody has tuned. memory_budget: bytes
TuningBounds tuning_bounds(const DeviceInfo& device, const TunedRender& render, uint64_t memory_budget);

/// The ladders of the search: sizes by powers of two around the usual ones, 64 times less to 16 times more paths. They end where larger
/// sizes would come to the same: noise would choose among those.
std::vector<Ladder> tuning_ladders(const TuningBounds& bounds);

/// Seconds of one render with these sizes; nothing: it does not work with them.
using TimeRender = std::function<std::optional<double>(const Tuning&)>;

struct TuneSettings {
  uint32_t rounds = 3;  // of a comparison, whose median counts; the verdict at the end takes twice as many
  double least_gain = 1.02;  // what is worth a change: 2 % are about the noise of a median
  std::function<bool()> stop = [] { return false; };
  /// After each comparison: how many times faster `tried` was than the best so far.
  std::function<void(const Tuning& tried, double speed)> told = [](const Tuning&, double) {};
};

struct TuneOutcome {
  Tuning tuning;        // empty: the usual sizes are as good
  double speed_up = 1;  // of it over the usual sizes, measured once more at the end
};

/// Compares sizes in turns (best, other, best, other ...), so that a disturbance of the machine hits both alike.
TuneOutcome find_tuning(const TuningBounds& bounds, const TimeRender& time, const TuneSettings& settings);

}  // namespace kiloband::opencl
