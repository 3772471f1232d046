#include "src_gpu/path/round_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace kiloband::opencl {
namespace {

// Shares of the budget. What a share leaves unused is nobody's: a smaller footprint is faster on CPU devices.
constexpr double kFilmShare = 0.45, kTableShare = 0.2, kPathShare = 0.3;
/// More chunks than expected, so that a round seldom has to be repeated.
constexpr double kChunkReserve = 1.25;
/// Chunks of the longest path: 1e5 vertices with two entries of texture samples each. With that many (10 MB) a
/// single path fits whatever its length, so unlimited depth is unlimited.
constexpr uint64_t kLongestPath = 100000 * 3 / KB_CHUNK_ENTRIES + 1;

/// Dense spectra of a block that a round may need.
constexpr uint64_t kTablesOfBlock = 4u << 20;
/// All of a round's: kernels count them by 4 floats (spectra_key, kernels/evaluate/path_spectra.clh).
constexpr uint64_t kMostTableBytes = uint64_t{64} << 30;
/// Samples of a round at most.
constexpr uint32_t kCpuSamples = 16, kGpuSamples = 64;
/// Rounding of a sum of so many floats stays below 32 * 2^-24 of it.
constexpr uint32_t kSamplesInRegisters = 32;

/// Of a GPU. Many paths hide its latency (Laine et al. 2013; the peak of the DPEPT paper lies between 1024^2 and 2048^2), and long
/// rounds have few beginnings and ends. Bytes: of a slot, and of a path with its vertices, as in most scenes.
constexpr uint64_t kFewestGpuSlots = 1u << 16, kMostGpuSlots = 1u << 21, kMostGpuJobs = 1u << 24;
constexpr uint64_t kSlotBytes = 256, kJobBytes = 512;

/// Of a CPU device. Launches that are long beside what it costs to begin one; what pt keeps of every channel for the
/// paths in flight should stay in caches, until launches become too short (bench_methods --pool, validation/README.md).
constexpr uint32_t kFewestCpuSlots = 1u << 11, kMostCpuSlots = 1u << 15;
constexpr uint64_t kCpuStateBytes = 4u << 20;
constexpr uint64_t kCpuJobs = 1u << 16;

uint64_t share(uint64_t bytes, double part) {
  return static_cast<uint64_t>(static_cast<double>(bytes) * part);
}

uint32_t to_u32(uint64_t n) {
  return static_cast<uint32_t>(std::min<uint64_t>(n, 0xffffffffu));
}

uint64_t chunk_bytes() {
  return KB_CHUNK_ENTRIES * sizeof(KbPathVertex) + sizeof(uint32_t);
}

uint64_t expected_chunks(const PlanRequest& r, uint64_t jobs) {
  return static_cast<uint64_t>(static_cast<double>(jobs) * r.chunks_per_path * kChunkReserve) + 1;
}

/// Bytes of paths in a round of `jobs` (dpept).
uint64_t bytes_of_jobs(const PlanRequest& r, uint64_t jobs, uint64_t slots) {
  PoolSize size;
  size.dispersion = r.dispersion;
  size.gas = r.gas;
  size.instances = r.instances;
  size.shading_keys = r.shading_keys;
  size.slots = to_u32(slots);
  size.jobs = to_u32(jobs);
  size.pixels = to_u32(jobs);
  return path_pool_bytes(size) + slots * r.slot_bytes + expected_chunks(r, jobs) * chunk_bytes();
}

/// Paths of a round, at least all samples of one pixel. pt keeps none: its rounds have pixels for all slots.
uint64_t fitting_jobs(const PlanRequest& r, uint64_t group) {
  const uint64_t limit = share(r.budget, kPathShare), most = group * r.samples * r.rounds;
  if (r.method == Method::kPt)
    return std::min(std::max<uint64_t>(r.most_jobs, uint64_t{r.most_slots} * r.samples), most);
  uint64_t jobs = std::min(r.most_jobs, most);
  while (jobs > r.samples && bytes_of_jobs(r, jobs, std::min<uint64_t>(jobs, r.most_slots)) > limit)
    jobs /= 2;
  return std::max<uint64_t>(jobs, r.samples);
}

/// A round of pixels may touch this many blocks of 32 x 32: whole ones, or parts at its two ends. Clipped
/// blocks may have a pixel each. One block is needed.
uint64_t fitting_tables(const PlanRequest& r, uint64_t jobs) {
  const uint64_t samples = uint64_t{r.samples} * r.rounds, pixels = std::max<uint64_t>(jobs / samples, 1);
  const uint64_t tables = std::min<uint64_t>(pixels, pixels / 256 + 4) * samples;
  if (r.table_bytes == 0) return tables;
  const uint64_t bytes = std::min(share(r.budget, kTableShare), kMostTableBytes);
  return std::min(tables, std::max<uint64_t>(bytes / r.table_bytes, r.samples));
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

/// Chunks for `jobs` paths, and for the longest one if the share for paths has room for it.
uint64_t arena_chunks(const PlanRequest& r, const PoolSize& others, uint64_t jobs) {
  const uint64_t limit = share(r.budget, kPathShare), taken = std::min(path_pool_bytes(others), limit);
  const uint64_t most = std::min(limit - taken, r.largest) / chunk_bytes();
  return std::min(std::max(expected_chunks(r, jobs), kLongestPath), std::max<uint64_t>(most, 1));
}

uint32_t cpu_slots(uint64_t slot_bytes) {
  const uint64_t fitting = std::bit_floor(kCpuStateBytes / std::max<uint64_t>(slot_bytes, 1));
  return static_cast<uint32_t>(std::clamp<uint64_t>(fitting, kFewestCpuSlots, kMostCpuSlots));
}

}  // namespace

const char* to_string(Method method) {
  switch (method) {
    case Method::kPt:
      return "pt";
    case Method::kDpeptPath:
      return "dpept-path";
    default:
      return "dpept-batch";
  }
}

std::optional<Method> find_method(std::string_view name) {
  for (const Method method : {Method::kDpeptBatch, Method::kDpeptPath, Method::kPt})
    if (name == to_string(method)) return method;
  return {};
}

uint32_t chunk_entries(Method method, const SceneFeatures& features) {
  if (method != Method::kPt) return KB_CHUNK_ENTRIES;
  const uint32_t suns = features.sun ? KB_MOST_SUNS : 0;
  if (features.gas) return KB_PT_GAS_CHUNK_ENTRIES + suns;
  return (features.dispersion ? KB_PT_DISPERSION_CHUNK_ENTRIES : KB_CHUNK_ENTRIES) + suns;
}

uint32_t samples_in_registers(bool cpu_device) {
  static_assert(kCpuSamples <= kSamplesInRegisters);  // as sum_rule_of takes it
  return cpu_device ? kCpuSamples : kSamplesInRegisters;
}

uint32_t samples_of_round(bool cpu_device, uint64_t table_bytes) {
  const uint64_t most = cpu_device ? kCpuSamples : kGpuSamples;
  return static_cast<uint32_t>(table_bytes > 0 ? std::clamp<uint64_t>(kTablesOfBlock / table_bytes, 1, most)
                                               : most);
}

uint32_t gpu_slots(uint64_t budget) {
  const uint64_t fitting = std::bit_floor(std::max<uint64_t>(budget / 16 / kSlotBytes, 1));
  return static_cast<uint32_t>(std::clamp<uint64_t>(fitting, kFewestGpuSlots, kMostGpuSlots));
}

uint64_t gpu_jobs(uint64_t budget) {
  const uint64_t fitting = std::bit_floor(std::max<uint64_t>(share(budget, kPathShare) / kJobBytes, 1));
  return std::clamp<uint64_t>(fitting, gpu_slots(budget), kMostGpuJobs);
}

uint32_t usual_slots(bool cpu_device, uint64_t budget, uint64_t slot_bytes) {
  return cpu_device ? cpu_slots(slot_bytes) : gpu_slots(budget);
}

uint64_t usual_jobs(bool cpu_device, uint64_t budget) {
  return cpu_device ? kCpuJobs : gpu_jobs(budget);
}

SumRule sum_rule_of(Method method, uint32_t round_samples, bool derived) {
  if (method == Method::kPt) return {SumRule::Kind::kCompensated, 0, 1, 1};
  return {SumRule::Kind::kCompensated, std::min(round_samples, kSamplesInRegisters), round_samples,
          derived ? round_samples : 1};
}

bool begins_chunk(uint32_t first, const SumRule& rule) {
  return rule.chunk > 0 && first % rule.period % rule.chunk == 0;
}

SampleCut next_cut(uint32_t first, uint32_t end, const SumRule& rule, uint32_t rounds) {
  const uint32_t left = end - first, place = first % rule.period;
  const bool several = rule.period > rule.chunk;  // chunks in a round
  const uint32_t closed = (several ? left : left - 1) / rule.period;
  if (place == 0 && closed > 0) return {std::min(closed, rounds) * rule.period, false};
  return {std::min({left, rule.period - place, rule.chunk - place % rule.chunk}), true};
}

uint32_t first_part(uint32_t samples, uint32_t round_samples) {
  if (samples <= round_samples) return samples / 2;
  return std::max(samples / 2 / round_samples, 1u) * round_samples;
}

uint32_t rounds_as_one(const RoundsAsOne& wanted) {
  const SumRule& rule = wanted.rule;
  if (rule.step != 1 || rule.chunk != wanted.registers || rule.period % rule.chunk != 0) return 1;
  const uint64_t filling = wanted.slots / (std::max<uint64_t>(wanted.pixels, 1) * rule.period);
  const uint64_t of_tables = kTablesOfBlock / (std::max<uint64_t>(wanted.table_bytes, 1) * rule.period);
  const uint64_t rounds = std::bit_ceil((uint64_t{wanted.samples} + rule.period - 1) / rule.period);
  return to_u32(std::max<uint64_t>(std::min({filling, of_tables, rounds}), 1));
}

RoundPlan plan_rounds(const PlanRequest& r) {
  RoundPlan plan;
  const bool pt = r.method == Method::kPt;
  plan.group_pixels = fitting_pixels(r);
  plan.round_jobs = fitting_jobs(r, plan.group_pixels);
  plan.round_pixels = to_u32(std::min(plan.group_pixels, plan.round_jobs));
  plan.pool.dispersion = r.dispersion;
  plan.pool.chunk_entries = r.chunk_entries;
  plan.pool.tables = to_u32(fitting_tables(r, plan.round_jobs));
  plan.pool.slots = to_u32(
      std::min<uint64_t>(pt ? plan.round_pixels : std::max<uint64_t>(plan.round_jobs / 2, 1), r.most_slots));
  while (pt && plan.pool.slots > 1 && plan.pool.slots * r.slot_bytes > share(r.budget, kPathShare))
    plan.pool.slots /= 2;
  plan.pool.pixels = plan.round_pixels + (pt ? plan.pool.slots : 0);
  plan.pool.jobs = pt ? 1 : to_u32(plan.round_jobs);
  plan.pool.gas = r.gas;
  plan.pool.instances = r.instances;
  plan.pool.shading_keys = r.shading_keys;
  plan.pool.arena_chunks = pt ? plan.pool.slots : to_u32(arena_chunks(r, plan.pool, plan.round_jobs));
  return plan;
}

}  // namespace kiloband::opencl
