#include "src_gpu/path/path_pool.hpp"

#include <algorithm>
#include <stdexcept>

namespace kiloband::opencl {
namespace {

constexpr uint64_t kPoolLocalSize = 64;
/// Iterations between two looks at the pool from the host: each look waits for the device.
constexpr uint32_t kIterationsPerLook = 8;

}  // namespace

void throw_for_bugs(const KbFaults& faults) {
  if (faults.code & KB_FAULT_STACK_OVERFLOW)
    throw std::logic_error("kernel closest_hits or any_hits: the traversal stack is too small");
  if (faults.code & KB_FAULT_BAD_INDEX) throw std::logic_error("a kernel met an index out of range");
}

uint64_t path_pool_bytes(const PoolSize& size) {
  const uint64_t per_slot = sizeof(KbPathState) + sizeof(KbRay) + sizeof(KbHit) + sizeof(KbShadowRay) +
                            sizeof(KbTally) + 2 * sizeof(uint32_t) +
                            (size.dispersion ? sizeof(KbDispersionState) : 0) +
                            (size.gas ? sizeof(KbGasState) : 0) + (size.instances ? sizeof(uint32_t) : 0);
  const uint64_t per_chunk = size.chunk_entries * sizeof(KbPathVertex) + sizeof(uint32_t);
  return size.slots * per_slot + size.arena_chunks * per_chunk + uint64_t{size.jobs} * sizeof(KbSavedPath) +
         uint64_t{size.pixels} * sizeof(KbRoundPixel) + uint64_t{size.tables} * sizeof(float);
}

PathPool::PathPool(DeviceContext& context, DeviceMemory& memory, const Program& program,
                   const DeviceScene& scene, const DeviceBvh& bvh, const DeviceSpectra& spectra,
                   const PoolSize& size)
    : context_(context),
      size_(size),
      buffers_{
          .round = memory.allocate<KbRound>("round", 1),
          .pixels = memory.allocate<KbRoundPixel>("round's pixels", size.pixels),
          .shared_mu = memory.allocate<float>("wavelength offsets", size.tables),
          .states = memory.allocate<KbPathState>("path states", size.slots),
          .rays = memory.allocate<KbRay>("rays", size.slots),
          .hits = memory.allocate<KbHit>("hits", size.slots),
          .hit_instances =
              memory.allocate<uint32_t>("instances that are hit", size.instances ? size.slots : 0),
          .shadows = memory.allocate<KbShadowRay>("shadow rays", size.slots),
          .dispersion =
              memory.allocate<KbDispersionState>("dispersion states", size.dispersion ? size.slots : 0),
          .gas = memory.allocate<KbGasState>("media of paths", size.gas ? size.slots : 0),
          .tallies = memory.allocate<KbTally>("tallies", size.slots),
          .arena = memory.allocate<KbPathVertex>("path vertices",
                                                 uint64_t{size.arena_chunks} * size.chunk_entries),
          .chunk_next = memory.allocate<uint32_t>("vertex chunks", size.arena_chunks),
          .saved = memory.allocate<KbSavedPath>("saved paths", size.jobs),
          .faults = memory.allocate<KbFaults>("faults", 1),
      },
      queue_(memory.allocate<uint32_t>("queue", size.slots)),
      packed_(memory.allocate<uint32_t>("queue", size.slots)),
      reset_(program.kernel("reset_pool")),
      generate_(program.kernel("generate")),
      closest_(program.kernel("closest_hits")),
      shade_(program.kernel("shade")),
      any_(program.kernel(size.gas ? "shadow_walks" : "any_hits")),
      compact_(program.kernel("compact")) {
  for (PathKernel* kernel : {&reset_, &generate_, &closest_, &shade_, &any_, &compact_}) {
    (*kernel)->set_scale(LaunchScale::kSlots);
    kernel->set(scene, spectra, bvh, buffers_);
  }
}

void PathPool::launch(PathKernel& kernel) {
  kernel.set(queue(count_));
  kernel->launch(count_, kPoolLocalSize);
}

void PathPool::iterate(const AfterBounce& after_bounce) {
  launch(generate_);
  launch(closest_);
  if (on_hits_) on_hits_(queue(count_));
  launch(shade_);
  launch(any_);
  if (after_bounce) after_bounce(queue(count_));
}

/// Drops the finished slots from the queue and waits. Returns false when the round is over or has failed.
bool PathPool::compact() {
  launch(compact_);
  KbFaults faults = buffers_.faults.read(0);
  throw_for_bugs(faults);
  std::swap(queue_, packed_);
  count_ = faults.active;
  if (faults.code & KB_FAULT_ARENA_FULL) return false;
  faults.active = 0;
  buffers_.faults.upload(std::span<const KbFaults>(&faults, 1));
  return count_ > 0;
}

void PathPool::add_tallies(uint32_t slots, RoundOutcome& outcome) const {
  std::vector<KbTally> tallies(slots);
  buffers_.tallies.download(std::span<KbTally>(tallies));
  for (const KbTally& tally : tallies) {
    outcome.rays += tally.rays;
    outcome.vertices += tally.vertices;
  }
}

void PathPool::begin(const KbRound& round, std::span<const KbRoundPixel> pixels, std::span<const float> mu) {
  if (round.pool > size_.slots || round.padded_pixels > size_.pixels || mu.size() > size_.tables ||
      round.arena_chunks > size_.arena_chunks)
    throw std::logic_error("path pool: the round is larger than the pool was made for");
  buffers_.round.upload(std::span<const KbRound>(&round, 1));
  buffers_.pixels.upload(pixels);
  buffers_.shared_mu.upload(mu);
  const KbFaults none{};
  buffers_.faults.upload(std::span<const KbFaults>(&none, 1));
}

RoundOutcome PathPool::run(const KbRound& round, const AfterBounce& after_bounce) {
  if (!after_bounce && uint64_t{round.samples} * round.padded_pixels > size_.jobs)
    throw std::logic_error("path pool: the round has more paths than the pool was made for");
  count_ = round.pool;
  launch(reset_);
  RoundOutcome outcome;
  bool more = true;
  while (more) {
    for (uint32_t i = 0; i < kIterationsPerLook; ++i) iterate(after_bounce);
    outcome.iterations += kIterationsPerLook;
    more = compact();
    outcome.longest_launch_seconds =
        std::max(outcome.longest_launch_seconds, context_.take_longest(LaunchScale::kSlots));
  }
  const KbFaults faults = buffers_.faults.read(0);
  outcome.arena_full = faults.code & KB_FAULT_ARENA_FULL;
  outcome.chunks = std::min(faults.chunks, size_.arena_chunks);
  outcome.invalid = faults.invalid;
  outcome.invalid_jobs.assign(faults.invalid_jobs,
                              faults.invalid_jobs + std::min(faults.invalid, KB_LISTED_INVALID));
  std::ranges::sort(outcome.invalid_jobs);
  add_tallies(round.pool, outcome);
  return outcome;
}

}  // namespace kiloband::opencl
