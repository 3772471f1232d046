#include "src_gpu/round_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kiloband::gpu {
namespace {

// Shares of the budget. What a share leaves unused is nobody's: a smaller footprint is faster on CPU devices.
constexpr double kFilmShare = 0.45, kTableShare = 0.2, kPathShare = 0.3;
/// More chunks than expected, so that a round seldom has to be repeated.
constexpr double kChunkReserve = 1.25;
/// Chunks of the longest path: 1e5 vertices with two slots of texture samples each. With that many (10 MB) a
/// single path fits whatever its length, so unlimited depth is unlimited.
constexpr uint64_t kLongestPath = 100000 * 3 / KB_CHUNK_SLOTS + 1;

uint64_t share(uint64_t bytes, double part) {
  return static_cast<uint64_t>(static_cast<double>(bytes) * part);
}

uint32_t to_u32(uint64_t n) {
  return static_cast<uint32_t>(std::min<uint64_t>(n, 0xffffffffu));
}

uint64_t chunk_bytes() {
  return KB_CHUNK_SLOTS * sizeof(KbPathVertex) + sizeof(uint32_t);
}

uint64_t expected_chunks(const PlanRequest& r, uint64_t jobs) {
  return static_cast<uint64_t>(static_cast<double>(jobs) * r.chunks_per_path * kChunkReserve) + 1;
}

/// Bytes of paths in a round of `jobs` (dpept).
uint64_t bytes_of_jobs(const PlanRequest& r, uint64_t jobs, uint64_t slots) {
  PoolSize size;
  size.slots = to_u32(slots);
  size.jobs = to_u32(jobs);
  size.pixels = to_u32(jobs);
  return path_pool_bytes(size) + slots * r.slot_bytes + expected_chunks(r, jobs) * chunk_bytes();
}

/// The most paths of a round that the share for paths holds.
uint64_t fitting_jobs(const PlanRequest& r, uint64_t wanted) {
  const uint64_t limit = share(r.budget, kPathShare);
  while (wanted > 1 && bytes_of_jobs(r, wanted, std::min<uint64_t>(wanted, r.most_slots)) > limit) {
    wanted = wanted / 2;
  }
  return std::max<uint64_t>(wanted, 1);
}

uint64_t fitting_pixels(const PlanRequest& r) {
  const uint64_t bytes = std::min(share(r.budget, kFilmShare), 2 * r.largest);
  const uint64_t pixels = bytes / std::max<uint64_t>(r.film_bytes, 1);
  if (pixels == 0) {
    throw DeviceOutOfMemory(
        fmt::format("the film of one pixel takes {} bytes; {} bytes of device memory are left for the film",
                    r.film_bytes, bytes));
  }
  return std::min(pixels, r.pixels);
}

}  // namespace

RoundPlan plan_rounds(const PlanRequest& r) {
  RoundPlan plan;
  plan.group_pixels = fitting_pixels(r);
  const uint64_t samples = std::clamp<uint32_t>(r.samples, 1, kMostRoundSamples);
  // Rounds of jobs: as many pixels of the group as fit, then as many of their samples.
  const uint64_t jobs = fitting_jobs(r, std::min(r.most_jobs, plan.group_pixels * samples));
  plan.round_pixels = to_u32(std::min(plan.group_pixels, jobs));
  plan.round_samples = to_u32(std::clamp<uint64_t>(jobs / plan.round_pixels, 1, samples));

  // A round of pixels may touch this many blocks of 32 x 32: whole ones, or parts at its two ends.
  const uint64_t blocks = plan.round_pixels;  // clipped blocks may have one pixel each
  uint64_t tables = std::min<uint64_t>(blocks, plan.round_pixels / 256 + 4) * plan.round_samples;
  if (r.table_bytes > 0) {
    const uint64_t most = std::max<uint64_t>(share(r.budget, kTableShare) / r.table_bytes, 1);
    tables = std::min(tables, most);
  }
  plan.pool.tables = to_u32(tables);
  const bool pt = r.method == Method::kPt;
  const uint64_t all = uint64_t{plan.round_pixels} * plan.round_samples;
  plan.pool.slots =
      to_u32(std::min<uint64_t>(pt ? plan.round_pixels : std::max<uint64_t>(all / 2, 1), r.most_slots));
  while (pt && plan.pool.slots > 1 && plan.pool.slots * r.slot_bytes > share(r.budget, kPathShare))
    plan.pool.slots /= 2;
  plan.pool.pixels = plan.round_pixels + (pt ? plan.pool.slots : 0);
  plan.pool.jobs = pt ? 1 : to_u32(all);
  const uint64_t most_chunks = std::min(share(r.budget, kPathShare), r.largest) / chunk_bytes();
  const uint64_t chunks =
      std::min(std::max(expected_chunks(r, all), kLongestPath), std::max<uint64_t>(most_chunks, 1));
  plan.pool.arena_chunks = pt ? plan.pool.slots : to_u32(chunks);
  return plan;
}

}  // namespace kiloband::gpu
