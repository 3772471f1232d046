#include "src_gpu/path/path_pool.hpp"

#include <algorithm>
#include <stdexcept>

namespace kiloband::gpu {
namespace {

constexpr uint64_t kLocalSize = 64;
/// Iterations between two looks at the pool from the host: each look waits for the device.
constexpr uint32_t kIterationsPerLook = 8;

/// Where the queue stands among a kernel's arguments (the count follows).
constexpr uint32_t kPoolArguments = 13;
constexpr uint32_t kTableArguments = 3;
constexpr uint32_t kGenerateQueue = DeviceScene::kArguments + kPoolArguments;
constexpr uint32_t kShadeQueue = DeviceScene::kArguments + kPoolArguments + kTableArguments + 4;
constexpr uint32_t kClosestQueue = 8;
constexpr uint32_t kAnyQueue = 8;
constexpr uint32_t kWalkQueue = DeviceScene::kArguments + kPoolArguments + 3;

}  // namespace

void throw_for_bugs(const KbFaults& faults) {
  if (faults.code & KB_FAULT_STACK_OVERFLOW)
    throw std::logic_error("kernel closest_hits or any_hits: the traversal stack is too small");
  if (faults.code & KB_FAULT_BAD_INDEX) throw std::logic_error("a kernel met an index out of range");
}

uint64_t path_pool_bytes(const PoolSize& size) {
  const uint64_t per_slot = sizeof(KbPathState) + sizeof(KbRay) + sizeof(KbHit) + sizeof(KbShadowRay) +
                            sizeof(uint64_t) + 2 * sizeof(uint32_t) +
                            (size.dispersion ? sizeof(KbDispersionState) : 0) +
                            (size.gas ? sizeof(KbGasState) : 0);
  const uint64_t per_chunk = size.chunk_slots * sizeof(KbPathVertex) + sizeof(uint32_t);
  return size.slots * per_slot + size.arena_chunks * per_chunk + uint64_t{size.jobs} * sizeof(KbSavedPath) +
         uint64_t{size.pixels} * sizeof(KbRoundPixel) + uint64_t{size.tables} * sizeof(float);
}

PathPool::PathPool(DeviceContext& context, DeviceMemory& memory, const Program& program,
                   const DeviceScene& scene, const DeviceBvh& bvh, const DeviceSpectra& spectra,
                   const PoolSize& size)
    : context_(context),
      size_(size),
      round_(memory.allocate<KbRound>("round", 1)),
      pixels_(memory.allocate<KbRoundPixel>("round's pixels", size.pixels)),
      mu_(memory.allocate<float>("wavelength offsets", size.tables)),
      states_(memory.allocate<KbPathState>("path states", size.slots)),
      rays_(memory.allocate<KbRay>("rays", size.slots)),
      hits_(memory.allocate<KbHit>("hits", size.slots)),
      shadows_(memory.allocate<KbShadowRay>("shadow rays", size.slots)),
      arena_(memory.allocate<KbPathVertex>("path vertices", uint64_t{size.arena_chunks} * size.chunk_slots)),
      chunk_next_(memory.allocate<uint32_t>("vertex chunks", size.arena_chunks)),
      saved_(memory.allocate<KbSavedPath>("saved paths", size.jobs)),
      faults_(memory.allocate<KbFaults>("faults", 1)),
      dispersion_(memory.allocate<KbDispersionState>("dispersion states", size.dispersion ? size.slots : 1)),
      gas_(memory.allocate<KbGasState>("media of paths", size.gas ? size.slots : 0)),
      tallies_(memory.allocate<uint64_t>("tallies", size.slots)),
      queue_(memory.allocate<uint32_t>("queue", size.slots)),
      packed_(memory.allocate<uint32_t>("queue", size.slots)),
      reset_(program.kernel("reset_pool")),
      generate_(program.kernel("generate")),
      closest_(program.kernel("closest_hits")),
      shade_(program.kernel("shade")),
      any_(program.kernel(size.gas ? "shadow_walks" : "any_hits")),
      compact_(program.kernel("compact")) {
  for (Kernel* kernel : {&reset_, &generate_, &closest_, &shade_, &any_, &compact_})
    kernel->set_scale(LaunchScale::kSlots);
  bind(scene, bvh, spectra);
}

/// Everything but the queue and its length, which change.
void PathPool::bind(const DeviceScene& scene, const DeviceBvh& bvh, const DeviceSpectra& spectra) {
  const auto bind_pool = [this, &scene](Kernel& kernel, uint32_t first) {
    kernel.set_from(first, round_, pixels_, mu_, states_, rays_, shadows_, arena_, chunk_next_, saved_,
                    faults_, dispersion_, scene.channel_bins(), gas_);
  };
  scene.bind(generate_, 0);
  bind_pool(generate_, DeviceScene::kArguments);
  scene.bind(shade_, 0);
  bind_pool(shade_, DeviceScene::kArguments);
  shade_.set_from(DeviceScene::kArguments + kPoolArguments, spectra.nodes, spectra.tables, spectra.materials,
                  bvh.nodes, bvh.primitives, hits_, tallies_);
  closest_.set_from(0, scene.shapes(), bvh.nodes, bvh.primitives, states_, rays_, hits_, faults_, tallies_);
  if (size_.gas) {
    scene.bind(any_, 0);
    bind_pool(any_, DeviceScene::kArguments);
    any_.set_from(DeviceScene::kArguments + kPoolArguments, bvh.nodes, bvh.primitives, tallies_);
    return;
  }
  any_.set_from(0, scene.shapes(), bvh.nodes, bvh.primitives, states_, shadows_, arena_, faults_, tallies_);
}

void PathPool::launch(Kernel& kernel, uint32_t queue_argument) {
  kernel.set_from(queue_argument, queue_, count_);
  kernel.launch(count_, kLocalSize);
}

void PathPool::iterate(const AfterBounce& after_bounce) {
  launch(generate_, kGenerateQueue);
  launch(closest_, kClosestQueue);
  if (on_hits_) on_hits_(queue_, count_);
  launch(shade_, kShadeQueue);
  launch(any_, size_.gas ? kWalkQueue : kAnyQueue);
  if (after_bounce) after_bounce(queue_, count_);
}

/// Drops the finished slots from the queue and waits. Returns false when the round is over or has failed.
bool PathPool::compact() {
  compact_.set(states_, queue_, packed_, faults_, count_);
  compact_.launch(count_, kLocalSize);
  KbFaults faults = faults_.read(0);
  throw_for_bugs(faults);
  std::swap(queue_, packed_);
  count_ = faults.active;
  if (faults.code & KB_FAULT_ARENA_FULL) return false;
  faults.active = 0;
  faults_.upload(std::span<const KbFaults>(&faults, 1));
  return count_ > 0;
}

void PathPool::add_tallies(uint32_t slots, RoundOutcome& outcome) const {
  std::vector<uint64_t> tallies(slots);
  tallies_.download(std::span<uint64_t>(tallies));
  for (const uint64_t tally : tallies) {
    outcome.rays += tally & 0xffffffffu;
    outcome.vertices += tally >> 32;
  }
}

void PathPool::begin(const KbRound& round, std::span<const KbRoundPixel> pixels, std::span<const float> mu) {
  if (round.pool > size_.slots || round.padded_pixels > size_.pixels || mu.size() > size_.tables ||
      round.arena_chunks > size_.arena_chunks)
    throw std::logic_error("path pool: the round is larger than the pool was made for");
  round_.upload(std::span<const KbRound>(&round, 1));
  pixels_.upload(pixels);
  mu_.upload(mu);
  const KbFaults none{};
  faults_.upload(std::span<const KbFaults>(&none, 1));
}

RoundOutcome PathPool::run(const KbRound& round, const AfterBounce& after_bounce) {
  if (!after_bounce && uint64_t{round.samples} * round.padded_pixels > size_.jobs)
    throw std::logic_error("path pool: the round has more paths than the pool was made for");
  count_ = round.pool;
  reset_.set(states_, queue_, tallies_, count_);
  reset_.launch(count_, kLocalSize);
  RoundOutcome outcome;
  bool more = true;
  while (more) {
    for (uint32_t i = 0; i < kIterationsPerLook; ++i) iterate(after_bounce);
    outcome.iterations += kIterationsPerLook;
    more = compact();
    outcome.longest_launch_seconds =
        std::max(outcome.longest_launch_seconds, context_.take_longest(LaunchScale::kSlots));
  }
  const KbFaults faults = faults_.read(0);
  outcome.arena_full = faults.code & KB_FAULT_ARENA_FULL;
  outcome.chunks = std::min(faults.chunks, size_.arena_chunks);
  outcome.invalid = faults.invalid;
  outcome.invalid_jobs.assign(faults.invalid_jobs,
                              faults.invalid_jobs + std::min(faults.invalid, KB_LISTED_INVALID));
  std::ranges::sort(outcome.invalid_jobs);
  add_tallies(round.pool, outcome);
  return outcome;
}

}  // namespace kiloband::gpu
