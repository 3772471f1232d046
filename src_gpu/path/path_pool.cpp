#include "src_gpu/path/path_pool.hpp"

#include <algorithm>
#include <stdexcept>

namespace kiloband::opencl {
namespace {

constexpr uint32_t kCpuSlotsPerItem = 64;
/// After so many iterations the host looks whether the round is over, which waits for the device; not before it expects that, by the
/// rounds before.
constexpr uint32_t kIterationsPerLook = KB_ITERATIONS_PER_PACKING;
/// So many rounds that were over when the host looked first, and it looks earlier.
constexpr uint32_t kEarlyRounds = 8;

uint64_t wide(const kb_u32 (&words)[2]) {
  return uint64_t{words[1]} << 32 | words[0];
}

}  // namespace

void throw_for_bugs(const KbFaults& faults) {
  if (faults.code & KB_FAULT_STACK_OVERFLOW)
    throw std::logic_error("kernel closest_hits or any_hits: the traversal stack is too small");
  if (faults.code & KB_FAULT_BAD_INDEX) throw std::logic_error("a kernel met an index out of range");
}

uint64_t path_pool_bytes(const PoolSize& size) {
  const uint64_t per_slot = sizeof(KbPathState) + sizeof(KbRay) + sizeof(KbHit) + sizeof(KbShadowRay) +
                            sizeof(KbTally) + (2 + size.shading_keys) * sizeof(uint32_t) +
                            (size.dispersion ? sizeof(KbDispersionState) : 0) +
                            (size.gas ? sizeof(KbGasState) : 0) + (size.instances ? sizeof(uint32_t) : 0);
  const uint64_t per_chunk = size.chunk_entries * sizeof(KbPathVertex) + sizeof(uint32_t);
  return size.slots * per_slot + size.arena_chunks * per_chunk + uint64_t{size.jobs} * sizeof(KbSavedPath) +
         uint64_t{size.pixels} * sizeof(KbRoundPixel) + uint64_t{size.tables} * sizeof(float);
}

uint32_t slots_per_item(const DeviceInfo& device) {
  return device.type == DeviceType::kCpu ? kCpuSlotsPerItem : 1;
}

uint32_t shading_keys(const DeviceInfo& device, const SceneFeatures& f) {
  const int kinds = f.diffuse + f.conductor + f.rough_conductor + f.dielectric + f.rough_dielectric +
                    f.plastic + f.rough_plastic + f.principled;
  return device.type == DeviceType::kCpu || kinds < 2 ? 0 : KB_MATERIAL_COUNT + 1;
}

PathPool::PathPool(DeviceContext& context, DeviceMemory& memory, const Program& program,
                   const DeviceScene& scene, const DeviceBvh& bvh, const DeviceSpectra& spectra,
                   const PoolSize& size, uint32_t group)
    : context_(context),
      size_(size),
      group_(group),
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
      length_(memory.allocate<uint32_t>("queue", 1)),
      packed_(memory.allocate<uint32_t>("queue", size.slots)),
      packed_length_(memory.allocate<uint32_t>("queue", 1)),
      ordered_(memory.allocate<uint32_t>("shading order", uint64_t{size.slots} * size.shading_keys)),
      ordered_lengths_(memory.allocate<uint32_t>("shading order", size.shading_keys)),
      reset_(program.kernel("reset_pool")),
      generate_(program.kernel("generate")),
      closest_(program.kernel("closest_hits")),
      shade_(program.kernel("shade")),
      any_(program.kernel(size.gas ? "shadow_walks" : "any_hits")),
      compact_(program.kernel("compact")),
      tallies_(program.kernel("add_tallies")) {
  if (slots_per_item(context.device()) > 1) whole_.emplace(program.kernel("whole_bounces"));
  for (PathKernel* kernel : {&reset_, &generate_, &closest_, &shade_, &any_, &compact_, &tallies_})
    set_arguments(*kernel, scene, spectra, bvh);
  if (whole_) set_arguments(*whole_, scene, spectra, bvh);
}

void PathPool::set_arguments(PathKernel& kernel, const DeviceScene& scene, const DeviceSpectra& spectra,
                             const DeviceBvh& bvh) {
  kernel->set_scale(LaunchScale::kSlots);
  kernel.set(scene, spectra, bvh, buffers_);
}

/// more: work-items beyond those of the queue
void PathPool::launch(PathKernel& kernel, uint64_t more) {
  kernel.set(queue().slots);
  const uint64_t each = slots_per_item(context_.device());
  const uint64_t group =
      each > 1 ? 1 : std::min<uint64_t>({group_, kernel->max_work_group_size(), KB_LARGEST_PATH_GROUP});
  kernel->launch((count_ + more + each - 1) / each, group);
}

/// Of the shading order, at most.
uint64_t PathPool::open_places() const {
  return uint64_t{size_.shading_keys} * KB_SHADING_LANES;
}

void PathPool::iterate(const AfterBounce& after_bounce) {
  const bool whole = whole_ && !on_hits_;
  if (whole) {
    launch(*whole_);
  } else {
    launch(generate_);
    launch(closest_);
    if (on_hits_) on_hits_(queue());
    launch(shade_, open_places());
    launch(any_, open_places());
  }
  if (after_bounce) after_bounce(queue());
}

/// The iterations until the queue is packed. What takes whole bounces and has not to stop after each is launched once for all of them.
void PathPool::iterate_until_packing(const AfterBounce& after_bounce) {
  const bool at_once = whole_ && !on_hits_ && !after_bounce;
  for (uint32_t i = 0; i < (at_once ? 1 : KB_ITERATIONS_PER_PACKING); ++i) iterate(after_bounce);
}

/// Drops the finished slots from the queue; how many are left only the device knows.
void PathPool::compact() {
  launch(compact_);
  std::swap(queue_, packed_);
  std::swap(length_, packed_length_);
}

/// Waits. Returns false when the round is over or has failed.
bool PathPool::look(RoundOutcome& outcome) {
  tallies_.set(queue().slots);
  tallies_->launch((round_.pool + KB_TALLY_SLOTS - 1) / KB_TALLY_SLOTS, kPoolLocalSize);
  buffers_.faults.enqueue_download(std::span<KbFaults>(&faults_, 1));
  count_ = length_.read(0);  // what was enqueued before is done, too
  const KbFaults& faults = faults_;
  throw_for_bugs(faults);
  outcome.longest_launch_seconds =
      std::max(outcome.longest_launch_seconds, context_.take_longest(LaunchScale::kSlots));
  outcome.arena_full = faults.code & KB_FAULT_ARENA_FULL;
  outcome.chunks = std::min(faults.chunks, size_.arena_chunks);
  outcome.invalid = faults.invalid;
  outcome.invalid_jobs.assign(faults.invalid_jobs,
                              faults.invalid_jobs + std::min(faults.invalid, KB_LISTED_INVALID));
  outcome.rays = wide(faults.rays);
  outcome.vertices = wide(faults.vertices);
  return count_ > 0 && !outcome.arena_full;
}

void PathPool::begin(const KbRound& round, std::span<const KbRoundPixel> pixels, std::span<const float> mu) {
  if (round.pool > size_.slots || round.padded_pixels > size_.pixels || mu.size() > size_.tables ||
      round.arena_chunks > size_.arena_chunks)
    throw std::logic_error("path pool: the round is larger than the pool was made for");
  // The round before was waited for, so nothing reads these any more.
  round_ = round;
  pixels_.assign(pixels.begin(), pixels.end());
  mu_.assign(mu.begin(), mu.end());
  buffers_.round.enqueue_upload(std::span<const KbRound>(&round_, 1));
  buffers_.pixels.enqueue_upload(pixels_);
  buffers_.shared_mu.enqueue_upload(mu_);
  length_.fill(round_.pool);
}

/// Iterations until the host looks first.
uint32_t PathPool::expected_iterations(double jobs_each) const {
  const bool known = jobs_each > 0.8 * known_jobs_ && jobs_each < 1.25 * known_jobs_;
  return known ? known_iterations_ : kIterationsPerLook;
}

void PathPool::learn(double jobs_each, uint32_t iterations, bool at_first_look) {
  early_rounds_ = at_first_look ? early_rounds_ + 1 : 0;
  const bool earlier = early_rounds_ == kEarlyRounds && iterations > kIterationsPerLook;
  if (earlier) early_rounds_ = 0;
  known_jobs_ = jobs_each;
  known_iterations_ = iterations - (earlier ? kIterationsPerLook : 0);
}

RoundOutcome PathPool::run(const KbRound& round, const AfterBounce& after_bounce) {
  const uint64_t jobs = uint64_t{round.samples} * round.padded_pixels;
  if (!after_bounce && jobs > size_.jobs)
    throw std::logic_error("path pool: the round has more paths than the pool was made for");
  count_ = round.pool;
  launch(reset_);
  const double jobs_each = static_cast<double>(jobs) / round.pool;
  const uint32_t expected = expected_iterations(jobs_each);
  RoundOutcome outcome;
  for (bool more = true; more;) {
    iterate_until_packing(after_bounce);
    outcome.iterations += kIterationsPerLook;
    compact();
    if (outcome.iterations >= expected) more = look(outcome);
  }
  std::ranges::sort(outcome.invalid_jobs);
  if (!outcome.arena_full) learn(jobs_each, outcome.iterations, outcome.iterations <= expected);
  return outcome;
}

}  // namespace kiloband::opencl
