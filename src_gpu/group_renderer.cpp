#include "src_gpu/group_renderer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "shared/sampler.h"

namespace kiloband::gpu {
namespace {

/// Paths in flight and paths of a round. GPUs hide latency with many (Laine et al. 2013; the paper's peak
/// lies between 1024^2 and 2048^2); a CPU device keeps what a round touches in its caches.
constexpr uint32_t kGpuSlots = 1u << 20, kCpuSlots = 1u << 13;
constexpr uint64_t kGpuJobs = 1u << 22, kCpuJobs = 1u << 16;
constexpr uint32_t kFewestSlots = 64;
/// Halvings of a pool before the failure is given up on.
constexpr int kMostRetries = 12;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

uint64_t round_up(uint64_t n, uint64_t multiple) {
  return (n + multiple - 1) / multiple * multiple;
}

}  // namespace

GroupRenderer::GroupRenderer(DeviceState& device, const SamplingSettings& settings, double launch_seconds,
                             std::optional<uint32_t> pool_slots, DiagnosticSink note)
    : device_(device),
      settings_(settings),
      launch_seconds_(launch_seconds),
      pool_slots_(pool_slots),
      note_(std::move(note)) {
  const bool cpu = device.context.device().type == DeviceType::kCpu;
  slots_limit_ = pool_slots_.value_or(cpu ? kCpuSlots : kGpuSlots);
}

PlanRequest GroupRenderer::request(uint64_t pixels, uint32_t samples) const {
  const bool cpu = device_.context.device().type == DeviceType::kCpu;
  PlanRequest r;
  r.budget = device_.memory.available();
  r.largest = device_.memory.largest();
  r.pixels = pixels;
  r.samples = samples;
  r.method = device_.method;
  r.film_bytes = device_.film_bytes_per_pixel();
  r.table_bytes = device_.table_bytes();
  r.slot_bytes = device_.slot_bytes();
  r.most_slots = slots_limit_;
  r.most_jobs = std::max<uint64_t>(cpu ? kCpuJobs : kGpuJobs, slots_limit_);
  r.chunks_per_path = chunks_per_path_;
  return r;
}

/// Allocates what the plan says. Returns false where the device has less than the budget promises.
bool GroupRenderer::make_pool(const PlanRequest& r) {
  device_.release_pool();
  plan_ = plan_rounds(r);
  try {
    device_.make_pool(plan_->pool, plan_->group_pixels);
    return true;
  } catch (const DeviceOutOfMemory&) {
    device_.release_pool();
    return false;
  }
}

void GroupRenderer::prepare(uint64_t pixels, uint32_t samples) {
  if (plan_ && device_.has_pool() && planned_pixels_ >= pixels && planned_samples_ >= samples) return;
  device_.release_pool();
  PlanRequest r = request(pixels, samples);
  const uint64_t wanted = r.budget;
  for (int attempt = 0; !make_pool(r); ++attempt) {
    if (attempt == kMostRetries) make_pool_or_throw(r);
    r.budget /= 2;
    r.largest /= 2;
  }
  if (r.budget < wanted || plan_->group_pixels < pixels) {
    note(note_, {},
         fmt::format("device memory: {} of {} pixels at a time, {} paths in flight, {} MiB in use",
                     plan_->group_pixels, pixels, plan_->pool.slots, device_.memory.used() >> 20));
  }
  planned_pixels_ = pixels;
  planned_samples_ = samples;
}

/// The last attempt: its failure is the caller's.
void GroupRenderer::make_pool_or_throw(const PlanRequest& r) {
  plan_ = plan_rounds(r);
  device_.make_pool(plan_->pool, plan_->group_pixels);
}

uint64_t GroupRenderer::group_pixels(uint64_t pixels, uint32_t samples) {
  prepare(pixels, samples);
  return plan_->group_pixels;
}

KbRound GroupRenderer::make_round(const SampleRange& samples, uint64_t number) const {
  KbRound round{};
  round.seed = settings_.seed;
  round.sampler = settings_.sampler == SamplerType::kSobol ? KB_SAMPLER_SOBOL : KB_SAMPLER_INDEPENDENT;
  round.wavelengths =
      settings_.wavelengths == WavelengthMode::kShared ? KB_WAVELENGTHS_SHARED : KB_WAVELENGTHS_PER_PATH;
  round.replicates = settings_.replicates;
  round.replicate = samples.replicate;
  round.first_index = samples.first;
  round.samples = samples.count;
  round.pixels = static_cast<uint32_t>(number);
  const uint64_t jobs = number * samples.count;
  const bool pt = device_.method == Method::kPt;
  const uint64_t slots =
      std::min<uint64_t>({plan_->pool.slots, slots_limit_, pt ? number : std::max<uint64_t>(jobs / 2, 1)});
  round.pool = static_cast<uint32_t>(slots);
  round.padded_pixels = static_cast<uint32_t>(pt ? round_up(number, slots) : number);
  round.arena_chunks = plan_->pool.arena_chunks;
  return round;
}

/// The round's pixels, with the number of their block within the round.
void GroupRenderer::fill_pixels(std::span<const ImagePixel> pixels, KbRound& round) {
  round_pixels_.assign(round.padded_pixels, KbRoundPixel{0, 0, 0});
  uint32_t block = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (i > 0 && !same_block(pixels[i - 1], pixels[i])) ++block;
    round_pixels_[i] = {pixels[i].x, pixels[i].y, block};
  }
  round.blocks = block + 1;
}

/// Offsets of shared wavelengths: [block][sample].
void GroupRenderer::fill_mu(const KbRound& round) {
  mu_.clear();
  if (round.wavelengths == KB_WAVELENGTHS_PER_PATH) return;
  for (uint32_t i = 0; i < round.pixels; ++i) {
    const KbRoundPixel& p = round_pixels_[i];
    if (i > 0 && p.block == round_pixels_[i - 1].block) continue;
    for (uint32_t s = 0; s < round.samples; ++s) {
      mu_.push_back(kb_shared_mu(settings_.seed, round.replicate, p.x / kBlockSize, p.y / kBlockSize,
                                 round.first_index + s));
    }
  }
}

/// Learns from a round: how much arena a path takes, whether launches are too long.
void GroupRenderer::adapt(const RoundOutcome& outcome, const KbRound& round) {
  const double paths = static_cast<double>(round.pixels) * round.samples;
  if (!outcome.arena_full && device_.method != Method::kPt)
    chunks_per_path_ = std::max(1.0, outcome.chunks / paths);
  if (outcome.longest_launch_seconds > launch_seconds_ && slots_limit_ > kFewestSlots) slots_limit_ /= 2;
}

/// A round that is too large in two; the demand of a round does not depend on scheduling, so neither does the
/// split.
void GroupRenderer::split(std::span<const ImagePixel> pixels, uint64_t at, uint64_t number,
                          const SampleRange& samples, RunTally& tally) {
  if (samples.count > 1) {
    const uint32_t half = samples.count / 2;
    render_part(pixels, at, number, {samples.replicate, samples.first, half}, tally);
    render_part(pixels, at, number, {samples.replicate, samples.first + half, samples.count - half}, tally);
    return;
  }
  if (number == 1) throw DeviceOutOfMemory("one path with all its vertices does not fit the device memory");
  render_part(pixels, at, number / 2, samples, tally);
  render_part(pixels, at + number / 2, number - number / 2, samples, tally);
}

void GroupRenderer::note_invalid(const RoundOutcome& outcome, const KbRound& round, RunTally& tally) const {
  tally.invalid += outcome.invalid;
  for (const uint32_t job : outcome.invalid_jobs) {
    const KbRoundPixel& pixel = round_pixels_[job % round.padded_pixels];
    const uint32_t index = round.first_index + job / round.padded_pixels;
    tally.invalid_samples.push_back({pixel.x, pixel.y, round.replicate + index * round.replicates});
  }
}

void GroupRenderer::render_part(std::span<const ImagePixel> pixels, uint64_t at, uint64_t number,
                                const SampleRange& samples, RunTally& tally) {
  KbRound round = make_round(samples, number);
  fill_pixels(pixels.subspan(at, number), round);
  if (uint64_t{round.blocks} * round.samples > plan_->pool.tables && (number > 1 || samples.count > 1))
    return split(pixels, at, number, samples, tally);
  fill_mu(round);
  const auto start = std::chrono::steady_clock::now();
  const RoundOutcome outcome = device_.generate(round, round_pixels_, mu_, at);
  adapt(outcome, round);
  tally.longest_launch_seconds = std::max(tally.longest_launch_seconds, outcome.longest_launch_seconds);
  if (outcome.arena_full) return split(pixels, at, number, samples, tally);
  note_invalid(outcome, round, tally);
  tally.rays += outcome.rays;
  tally.vertices += outcome.vertices;
  tally.generate_seconds += seconds_since(start);
  const auto middle = std::chrono::steady_clock::now();
  tally.longest_launch_seconds = std::max(tally.longest_launch_seconds, device_.evaluate(round, at));
  tally.evaluate_seconds += seconds_since(middle);
  tally.paths += number * samples.count;
}

GroupResult GroupRenderer::render(std::span<const ImagePixel> pixels, const SampleRange& range,
                                  const std::atomic<bool>& stop,
                                  const std::function<void(uint64_t)>& on_samples, RunTally& tally) {
  prepare(pixels.size(), range.count);
  device_.clear_film(pixels.size());
  GroupResult result;
  // All pixels of the group get the same samples, so that a stopped render is even.
  while (result.attempted < range.count && !stop) {
    const uint32_t count = std::min(plan_->round_samples, range.count - result.attempted);
    for (uint64_t at = 0; at < pixels.size(); at += plan_->round_pixels) {
      const uint64_t number = std::min<uint64_t>(plan_->round_pixels, pixels.size() - at);
      render_part(pixels, at, number, {range.replicate, range.first + result.attempted, count}, tally);
      on_samples(number * count);
    }
    result.attempted += count;
  }
  device_.finish_film(pixels.size(), result.means, result.counts);
  return result;
}

}  // namespace kiloband::gpu
