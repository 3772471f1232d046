#include "src_gpu/group_renderer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <numeric>

#include "shared/sampler.h"

namespace kiloband::opencl {
namespace {

constexpr uint32_t kFewestSlots = 64;
/// What the first launches have of it: their times say how many the next ones may have.
constexpr uint64_t kFirstPart = 16;
/// Rounds that are one should not need more chunks than there are.
constexpr double kChunkMargin = 1.1;
/// Halvings of a pool before the failure is given up on.
constexpr int kMostRetries = 12;

bool is_cpu(const DeviceState& device) {
  return device.context.device().type == DeviceType::kCpu;
}

uint32_t most_slots(const DeviceState& device, const Tuning& tuning) {
  return tuning.pool_slots.value_or(usual_slots(is_cpu(device), device.memory.budget(), device.slot_bytes()));
}

uint64_t most_jobs(const DeviceState& device, const Tuning& tuning, uint32_t slots) {
  return std::max<uint64_t>(tuning.round_paths.value_or(usual_jobs(is_cpu(device), device.memory.budget())),
                            slots);
}

/// What is not asked for; what is keeps its size: values would be set to 0 before they are overwritten.
void clear_other(GroupResult& result, bool sums) {
  if (sums) {
    result.means.clear();
    result.counts.clear();
  } else {
    for (auto* values : {&result.sums.open, &result.sums.sum, &result.sums.lost}) values->clear();
    result.sums.counts.clear();
  }
  result.attempted = 0;
}

uint64_t round_up(uint64_t n, uint64_t multiple) {
  return (n + multiple - 1) / multiple * multiple;
}

}  // namespace

GroupRenderer::GroupRenderer(DeviceState& device, const SamplingSettings& settings, double launch_seconds,
                             const Tuning& tuning, DiagnosticSink note)
    : device_(device),
      settings_(settings),
      note_(std::move(note)),
      round_samples_(samples_of_round(is_cpu(device), device.table_bytes())),
      most_slots_(most_slots(device, tuning)),
      most_jobs_(most_jobs(device, tuning, most_slots_)),
      slots_pace_(launch_seconds, most_slots_ / kFirstPart, kFewestSlots, most_slots_),
      paths_pace_(launch_seconds, most_jobs_ / kFirstPart, 1, most_jobs_),
      samples_pace_(launch_seconds, round_samples_, round_samples_, most_slots_) {}

PlanRequest GroupRenderer::request(uint64_t pixels, FilmForm form, uint32_t rounds) const {
  PlanRequest r;
  r.budget = device_.memory.available();
  r.largest = device_.memory.largest();
  r.pixels = pixels;
  r.samples = round_samples_;
  r.rounds = rounds;
  r.method = device_.method;
  r.film_bytes = device_.film_bytes_per_pixel(form);
  r.table_bytes = device_.table_bytes();
  r.slot_bytes = device_.slot_bytes();
  r.most_slots = most_slots_;
  r.most_jobs = most_jobs_;
  r.chunks_per_path = chunks_per_path_;
  r.dispersion = device_.has_dispersion();
  r.chunk_entries = device_.chunk_entries();
  r.gas = device_.has_gas();
  r.instances = device_.has_instances();
  r.shading_keys = shading_keys(device_.context.device(), device_.features());
  return r;
}

void GroupRenderer::make_pool(const PlanRequest& r, FilmForm form) {
  has_sums_ = false;
  device_.release_pool();
  plan_ = plan_rounds(r);
  device_.make_pool(plan_->pool, plan_->group_pixels, form);
}

/// Allocates what the plan says, and less where the device has less than the budget promises.
void GroupRenderer::prepare(uint64_t pixels, FilmForm form, uint32_t rounds) {
  const bool fits = planned_pixels_ >= pixels && planned_pixels_ * planned_rounds_ >= pixels * rounds;
  if (plan_ && device_.has_pool() && fits && planned_form_.serves(form)) return;
  device_.release_pool();
  PlanRequest r = request(pixels, form, rounds);
  std::exception_ptr refusal;  // the first one: it says what the matter is
  for (int attempt = 0;; ++attempt) {
    try {
      make_pool(r, form);
      break;
    } catch (const DeviceOutOfMemory&) {
      device_.release_pool();
      if (r.rounds > 1) {  // what is given up first
        r.rounds = 1;
        continue;
      }
      if (!refusal) refusal = std::current_exception();
      if (attempt == kMostRetries || r.budget / 2 < r.film_bytes) std::rethrow_exception(refusal);
    }
    r.budget /= 2;
    r.largest /= 2;
  }
  if (refusal || plan_->group_pixels < pixels) {
    note(note_, {},
         fmt::format("device memory: {} of {} pixels at a time, {} paths in flight, {} MiB in use",
                     plan_->group_pixels, pixels, plan_->pool.slots, device_.memory.used() >> 20));
  }
  planned_pixels_ = pixels;
  planned_form_ = form;
  planned_rounds_ = rounds;
}

uint64_t GroupRenderer::group_pixels(uint64_t pixels, bool open, uint32_t samples) {
  prepare(pixels, {.open = open}, rounds_as_one(pixels, samples));
  return plan_->group_pixels;
}

SumRule GroupRenderer::sum_rule() const {
  return sum_rule_of(device_.method, round_samples_, device_.derived_channels() > 0);
}

uint32_t GroupRenderer::rounds_as_one(uint64_t pixels, uint32_t samples) const {
  return opencl::rounds_as_one({sum_rule(), samples_in_registers(is_cpu(device_)), device_.table_bytes(),
                                most_slots_, pixels, samples});
}

/// Rounds of the pixels that may be one, as far as the plan has room for them (paths, vertices, tables) and launches have
/// time: for so many paths, and for so many samples of a pixel, which evaluation takes one after the other.
uint32_t GroupRenderer::fitting_rounds(std::span<const ImagePixel> pixels, uint32_t samples) const {
  const uint32_t wanted = rounds_as_one(pixels.size(), samples);
  if (wanted == 1) return 1;
  uint64_t blocks = 1;
  for (std::size_t i = 1; i < pixels.size(); ++i) blocks += !same_block(pixels[i - 1], pixels[i]);
  const uint64_t paths = std::min({plan_->round_jobs, paths_of_arena(), paths_pace_.limit()});
  const uint64_t fitting =
      std::min({paths / pixels.size(), plan_->pool.tables / blocks, samples_pace_.limit()});
  return static_cast<uint32_t>(std::clamp<uint64_t>(fitting / round_samples_, 1, wanted));
}

uint32_t GroupRenderer::blocks_at_once(uint32_t samples) const {
  const uint64_t of_block = uint64_t{kBlockSize} * kBlockSize * std::clamp(samples, 1u, round_samples_);
  return static_cast<uint32_t>(std::max<uint64_t>(most_jobs_ / of_block, 1));
}

KbRound GroupRenderer::make_round(const SampleRange& samples, uint64_t number) const {
  KbRound round{};
  round.seed = settings_.seed;
  round.sampler = settings_.sampler == SamplerType::kSobol ? KB_SAMPLER_SOBOL : KB_SAMPLER_INDEPENDENT;
  round.dispersion = device_.has_dispersion();
  round.degrade_rough = settings_.rough_dispersion == RoughDispersion::kDegrade;
  round.wavelengths =
      settings_.wavelengths == WavelengthMode::kShared ? KB_WAVELENGTHS_SHARED : KB_WAVELENGTHS_PER_PATH;
  round.replicates = settings_.replicates;
  round.replicate = samples.replicate;
  round.first_index = samples.first;
  round.samples = samples.count;
  round.pixels = static_cast<uint32_t>(number);
  const uint64_t jobs = number * samples.count;
  const bool pt = device_.method == Method::kPt;
  const uint64_t slots = std::min<uint64_t>(
      {plan_->pool.slots, slots_pace_.limit(), pt ? number : std::max<uint64_t>(jobs / 2, 1)});
  round.pool = static_cast<uint32_t>(slots);
  round.padded_pixels = static_cast<uint32_t>(pt ? round_up(number, slots) : number);
  round.arena_chunks = plan_->pool.arena_chunks;
  return round;
}

/// The round's pixels, with the number of their block within the round.
void GroupRenderer::fill_pixels(std::span<const ImagePixel> pixels, KbRound& round) {
  round_pixels_.assign(round.padded_pixels, KbRoundPixel{});
  uint32_t block = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (i > 0 && !same_block(pixels[i - 1], pixels[i])) ++block;
    round_pixels_[i] = {pixels[i].x, pixels[i].y, block, 0};
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
      const uint32_t index = round.first_index + s;
      mu_.push_back(kb_shared_mu(settings_.seed, round.replicate, p.x / kBlockSize, p.y / kBlockSize, index));
    }
  }
}

/// Learns from a round how much arena a path takes and how long launches over slots are.
void GroupRenderer::learn(const RoundOutcome& outcome, const KbRound& round) {
  slots_pace_.learn(round.pool, outcome.longest_launch_seconds);
  const double paths = static_cast<double>(round.pixels) * round.samples;
  if (!outcome.arena_full && device_.method != Method::kPt)
    chunks_per_path_ = std::max(1.0, outcome.chunks / paths);
}

/// The same of the evaluation that was enqueued last, and is done.
void GroupRenderer::learn_evaluation(RunTally& tally) {
  const double longest = device_.context.take_longest(LaunchScale::kPaths);
  if (evaluated_paths_ > 0) {
    paths_pace_.learn(evaluated_paths_, longest);
    samples_pace_.learn(evaluated_samples_, longest);
  }
  knows_paths_pace_ |= evaluated_paths_ > 0;
  evaluated_paths_ = 0;
  tally.longest_launch_seconds = std::max(tally.longest_launch_seconds, longest);
}

/// A round that is too large in two: by pixels, which changes no bit of the image; of a pixel alone, where rounds are one, between
/// rounds, which changes none either. A pixel whose single round does not fit is split by samples; only its last bits may differ from
/// those of a larger arena (of an open round, only those of derived channels).
void GroupRenderer::split(std::span<const ImagePixel> pixels, uint64_t at, uint64_t number,
                          const SampleRange& samples, bool open, RunTally& tally) {
  if (number > 1) {
    render_part(pixels, at, number / 2, samples, open, tally);
    render_part(pixels, at + number / 2, number - number / 2, samples, open, tally);
    return;
  }
  if (samples.count == 1) throw DeviceError("one path with all its vertices does not fit the device memory");
  const uint32_t half = first_part(samples.count, round_samples_);
  render_part(pixels, at, number, {samples.replicate, samples.first, half}, open, tally);
  render_part(pixels, at, number, {samples.replicate, samples.first + half, samples.count - half}, open,
              tally);
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
                                const SampleRange& samples, bool open, RunTally& tally) {
  KbRound round = make_round(samples, number);
  round.open = open;
  fill_pixels(pixels.subspan(at, number), round);
  if (uint64_t{round.blocks} * round.samples > plan_->pool.tables && (number > 1 || samples.count > 1))
    return split(pixels, at, number, samples, open, tally);
  fill_mu(round);
  const RoundOutcome outcome = device_.generate(round, round_pixels_, mu_, at);
  learn_evaluation(tally);
  learn(outcome, round);
  tally.longest_launch_seconds = std::max(tally.longest_launch_seconds, outcome.longest_launch_seconds);
  if (outcome.arena_full) return split(pixels, at, number, samples, open, tally);
  note_invalid(outcome, round, tally);
  tally.rays += outcome.rays;
  tally.vertices += outcome.vertices;
  device_.evaluate(round, at);
  evaluated_paths_ = number * samples.count;
  evaluated_samples_ = samples.count;
  tally.paths += evaluated_paths_;
  ++tally.rounds;
  if (knows_paths_pace_ || device_.method == Method::kPt) return;
  device_.context.finish();  // the first one says how many paths the second may have
  learn_evaluation(tally);
}

/// Paths whose vertices the arena has room for, by what paths have taken so far.
uint64_t GroupRenderer::paths_of_arena() const {
  return static_cast<uint64_t>(plan_->pool.arena_chunks / (chunks_per_path_ * kChunkMargin));
}

/// Pixels of the next round: what the pool holds and launches have time for. The method pt has no launch over
/// all paths; its slots want many pixels.
uint64_t GroupRenderer::round_pixels(uint32_t samples) const {
  const bool pt = device_.method == Method::kPt;
  const uint64_t paths =
      pt ? plan_->round_jobs : std::min({plan_->round_jobs, paths_pace_.limit(), paths_of_arena()});
  return std::clamp<uint64_t>(paths / samples, 1, plan_->round_pixels);
}

/// The next round of a range of which `done` samples are through.
SampleCut GroupRenderer::next_round(const SampleRange& range, uint32_t done, bool goes_on,
                                    uint32_t rounds) const {
  const bool chunks = goes_on && device_.method != Method::kPt;  // pt: every sample is a chunk
  if (chunks) return next_cut(range.first + done, range.first + range.count, sum_rule(), rounds);
  return {std::min(round_samples_ * rounds, range.count - done), false};
}

/// The device's film has the sums of the samples before the range then, or of none.
void GroupRenderer::begin_film(uint64_t pixels, const SampleRange& range, const SumsBefore* before) {
  const bool goes_on = before && range.first > 0;
  const bool there = goes_on && before->left_on_device && has_sums_;
  has_sums_ = false;  // until the render has got through
  if (there) return;
  device_.film().clear(pixels);
  if (goes_on) device_.film().load(before->of_film());
}

/// Into the device's film, which has the samples before the range. All pixels get the same samples, so that a stopped render is even.
/// open: with sums that are gone on with. Returns the samples per pixel.
uint32_t GroupRenderer::render_samples(std::span<const ImagePixel> pixels, const SampleRange& range,
                                       bool open, const std::atomic<bool>& stop,
                                       const std::function<void(uint64_t)>& on_samples, RunTally& tally) {
  uint32_t attempted = 0;
  while (attempted < range.count && !stop) {
    const SampleCut cut = next_round(range, attempted, open, fitting_rounds(pixels, range.count));
    const SampleRange samples{range.replicate, range.first + attempted, cut.samples};
    if (open && samples.first > 0 && begins_chunk(samples.first, sum_rule()))
      device_.film().close_chunk(pixels.size());
    for (uint64_t at = 0, number = 0; at < pixels.size(); at += number) {
      number = std::min(round_pixels(cut.samples), pixels.size() - at);
      render_part(pixels, at, number, samples, cut.open, tally);
      on_samples(number * cut.samples);
    }
    attempted += cut.samples;
  }
  return attempted;
}

/// The film has been waited for: what its launches took.
void GroupRenderer::learn_last(RunTally& tally) {
  learn_evaluation(tally);
  tally.longest_launch_seconds =
      std::max(tally.longest_launch_seconds, device_.context.take_longest(LaunchScale::kOther));
}

void GroupRenderer::render(std::span<const ImagePixel> pixels, const SampleRange& range,
                           const SumsBefore* before, const std::atomic<bool>& stop,
                           const std::function<void(uint64_t)>& on_samples, RunTally& tally,
                           GroupResult& result) {
  prepare(pixels.size(), {.open = before != nullptr});
  if (pixels.size() > plan_->group_pixels)
    throw DeviceOutOfMemory(
        fmt::format("the device has room for {} of {} pixels", plan_->group_pixels, pixels.size()));
  begin_film(pixels.size(), range, before);
  clear_other(result, before != nullptr);
  result.attempted = render_samples(pixels, range, before != nullptr, stop, on_samples, tally);
  if (before) {
    device_.film().save(pixels.size(), result.sums);
    has_sums_ = true;
  } else {
    device_.film().finish(pixels.size(), result.means, result.counts);
  }
  learn_last(tally);
}

bool GroupRenderer::begin_replicates(std::span<const std::size_t> block_pixels, const FilmForm& form,
                                     uint32_t samples) {
  const uint64_t pixels = std::accumulate(block_pixels.begin(), block_pixels.end(), uint64_t{0});
  has_sums_ = false;
  const bool there =
      plan_ && device_.has_pool() && planned_form_.serves(form) && plan_->group_pixels >= pixels;
  if (!there) device_.release_pool();  // its memory may be needed
  try {
    if (!there && plan_rounds(request(pixels, form, 1)).group_pixels < pixels) return false;
    prepare(pixels, form, rounds_as_one(pixels, samples));
    if (plan_->group_pixels < pixels) throw DeviceOutOfMemory("less than was promised");
    device_.film().clear(pixels);
    device_.replicates().begin(block_pixels);
  } catch (const DeviceOutOfMemory&) {
    device_.release_pool();
    return false;
  }
  return true;
}

uint32_t GroupRenderer::add_replicate(std::span<const ImagePixel> pixels, const SampleRange& range, bool open,
                                      const std::atomic<bool>& stop,
                                      const std::function<void(uint64_t)>& on_samples, RunTally& tally) {
  const uint32_t attempted = render_samples(pixels, range, open, stop, on_samples, tally);
  if (attempted == 0) return 0;
  if (open) device_.film().close_chunk(pixels.size());
  device_.replicates().fold();
  learn_last(tally);
  return attempted;
}

}  // namespace kiloband::opencl
