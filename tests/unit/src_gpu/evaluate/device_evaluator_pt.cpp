// The method pt: paths handed over bounce by bounce.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>
#include <thread>

#include "device_evaluator.hpp"

namespace kiloband::test {
namespace {

/// A slot of the emulated pool.
struct Slot {
  uint32_t job = 0, at = 0, bounce = 0;  // at: slots of the path that are done
  bool live = false;
};

/// Gives the slot its next bounce: fills its chunk, sets its state. Returns false if it has no more jobs.
bool next_bounce(Slot& slot, uint32_t number, uint32_t slots, const RoundOfPaths& round,
                 const PathBuffer& paths, KbPathState& state, KbPathVertex* chunk) {
  if (!slot.live) {
    slot.job = slot.bounce == 0 ? number : slot.job + slots;
    if (slot.job >= round.path.size()) return false;
    slot.at = 0;
    slot.live = true;
    slot.bounce = 0;
  }
  const uint32_t p = round.path[slot.job];
  state = {};
  state.job = slot.job;
  if (slot.bounce++ == 0) state.flags |= KB_PATH_FRESH;
  const bool nothing = p == RoundOfPaths::kEmpty || p == RoundOfPaths::kInvalid || paths.paths[p].count == 0;
  if (!nothing) {
    const SavedPath& path = paths.paths[p];
    const KbPathVertex* vertices = &paths.entries[path.first + slot.at];
    // What a deferred vertex waits for comes with it.
    for (bool more = true; more;) {
      more = vertices[state.length].head & KB_VERTEX_DEFER;
      state.length += entries_of(vertices[state.length]);
    }
    std::copy_n(&paths.entries[path.first + slot.at], state.length, chunk);
    slot.at += state.length;
  }
  if (p == RoundOfPaths::kInvalid) state.flags |= KB_PATH_INVALID;
  slot.live = !nothing && slot.at < paths.paths[p].count;
  state.flags |= slot.live ? KB_PATH_LIVE : KB_PATH_ENDED;
  return true;
}

}  // namespace

void DeviceEvaluator::pt(const PathBuffer& paths, uint32_t slots, uint32_t local_size) {
  OpenclProbe& probe = program_.probe;
  const std::size_t floats = std::size_t{slots} * layout_.stride;
  evaluation_.tau = probe.upload(std::vector<float>(floats, NAN));
  evaluation_.radiance = probe.upload(std::vector<float>(floats, NAN));
  evaluation_.partial =
      probe.upload(std::vector<float>(std::size_t{slots} * local_size * std::max(1u, layout_.derived), NAN));
  evaluation_.parts = local_size;
  std::vector<Slot> pool(slots);
  std::vector<KbPathState> states(slots);
  std::vector<KbPathVertex> chunks(std::size_t{slots} * KB_CHUNK_ENTRIES);
  for (bool more = true; more;) {
    more = false;
    std::vector<uint32_t> queue;
    for (uint32_t s = slots; s-- > 0;) {  // not in order: nothing may depend on it
      queue.push_back(s);
      if (next_bounce(pool[s], s, slots, round_, paths, states[s], &chunks[s * KB_CHUNK_ENTRIES]))
        more = true;
      else
        states[s].flags = KB_PATH_FINISHED;
    }
    pool_.arena = probe.upload(chunks);
    pool_.states = probe.upload(states);
    queue_ = {.slots = probe.upload(queue),
              .length = probe.upload(std::vector{slots}),
              .packed = {},
              .packed_length = {}};
    cl::Kernel k = evaluation_kernel("pt_update");
    run(k, std::size_t{local_size} * ((slots + 1) / 2), local_size);
    if (layout_.derived == 0) continue;
    cl::Kernel add = evaluation_kernel("pt_derived");
    run(add, std::size_t{slots} * layout_.derived, 1);
  }
}

double processor_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec)) /
         std::max(1u, std::thread::hardware_concurrency());
}

PtTiming DeviceEvaluator::time_pt(uint32_t slots, uint32_t groups, uint32_t bounces, uint32_t repetitions) {
  OpenclProbe& probe = program_.probe;
  const std::size_t floats = std::size_t{slots} * layout_.stride;
  evaluation_.tau = probe.upload(std::vector<float>(floats, 1.0f));
  evaluation_.radiance = probe.upload(std::vector<float>(floats, 0.0f));
  evaluation_.partial =
      probe.upload(std::vector<float>(std::max<std::size_t>(1, floats * layout_.derived), 0.0f));
  KbPathVertex vertex{};
  vertex.head = KB_KIND_SCALED | KB_VERTEX_NEE | KB_VERTEX_SCATTER;
  vertex.nee_row = 5;
  vertex.nee0 = vertex.scatter0 = 1;
  std::vector<KbPathVertex> chunks(std::size_t{slots} * KB_CHUNK_ENTRIES, vertex);
  for (uint32_t i = 0; i < chunks.size(); ++i)
    chunks[i].row_a = static_cast<uint16_t>(i / KB_CHUNK_ENTRIES % 5);
  pool_.arena = probe.upload(chunks);
  std::vector<uint32_t> order(slots);
  std::iota(order.begin(), order.end(), 0u);
  queue_ = {.slots = probe.upload(order),
            .length = probe.upload(std::vector{slots}),
            .packed = {},
            .packed_length = {}};
  std::vector<cl::Buffer> states;
  for (uint32_t b = 0; b < bounces; ++b) {
    std::vector<KbPathState> bounce(slots);
    for (uint32_t s = 0; s < slots; ++s) {
      bounce[s].job = s;
      bounce[s].length = 1;
      bounce[s].flags = (b == 0 ? KB_PATH_FRESH : 0u) | (b + 1 == bounces ? KB_PATH_ENDED : KB_PATH_LIVE);
    }
    states.push_back(probe.upload(bounce));
  }
  std::vector<cl::Kernel> kernels;
  for (const cl::Buffer& state : states) {
    pool_.states = state;
    kernels.push_back(evaluation_kernel("pt_update"));
  }
  PtTiming timing;
  timing.seconds = 1e30;
  for (uint32_t r = 0; r <= repetitions; ++r) {
    const double start = processor_seconds();
    for (cl::Kernel& k : kernels) run(k, groups, 1);
    if (r > 0) timing.seconds = std::min(timing.seconds, processor_seconds() - start);
  }
  timing.state_bytes = 2 * floats * sizeof(float);
  // A first bounce writes tau and L, others read and write them,
  // the last reads them and updates sum and compensation.
  timing.bytes = static_cast<double>(slots) * layout_.channels * (8.0 + 16.0 * (bounces - 2) + 8.0 + 16.0);
  return timing;
}

}  // namespace kiloband::test
