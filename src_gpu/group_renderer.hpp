// Renders the samples of one replicate for a list of pixels: groups whose film fits the device, rounds of
// paths that are generated and evaluated.
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/diagnostics.hpp"
#include "render/backend.hpp"
#include "src_gpu/device_state.hpp"
#include "src_gpu/image_pixels.hpp"
#include "src_gpu/path/launch_pace.hpp"
#include "src_gpu/path/round_plan.hpp"

namespace kiloband::opencl {

/// What a run of rounds did.
struct RunTally {
  uint64_t rays = 0, vertices = 0, paths = 0, rounds = 0;
  uint64_t invalid = 0;
  std::vector<InvalidSample> invalid_samples;  // the first of them
  double longest_launch_seconds = 0;           // of all kernels
};

/// The sums of pixels' samples before a range, which are gone on with.
struct SumsBefore {
  bool left_on_device =
      false;  // by the render before, of the same pixels; the device may have lost them since
  std::function<const FilmSums&()> of_film;
};

/// Means and numbers of valid samples of a group of pixels;
/// with sums that are gone on with, these instead of both.
struct GroupResult {
  std::vector<float> means;      // [pixel][channels + derived]
  std::vector<uint32_t> counts;  // valid samples
  FilmSums sums;
  uint32_t attempted = 0;  // samples per pixel

  std::size_t pixels() const { return std::max(counts.size(), sums.counts.size()); }
};

class GroupRenderer {
 public:
  /// note  receives a line where a pool is made smaller
  GroupRenderer(DeviceState& device, const SamplingSettings& settings, double launch_seconds,
                const Tuning& tuning, DiagnosticSink note);

  /// Pixels whose film is resident at once, for `samples` of an image part of this many pixels;
  /// open: with sums that are gone on with.
  uint64_t group_pixels(uint64_t pixels, bool open, uint32_t samples);
  SumRule sum_rule() const;
  /// Blocks of 32 x 32 pixels that fill a round of `samples` per pixel.
  uint32_t blocks_at_once(uint32_t samples) const;
  /// Of the pool that is there; 0: none was needed yet.
  uint32_t pool_slots() const { return plan_ ? plan_->pool.slots : 0; }

  /// Renders range.count samples of every pixel (fewer if stop becomes true). At most group_pixels() of them.
  /// The pixels of a block stand together. on_samples gets the pixel samples done.
  /// before  not asked for sums of no samples; null: means are wanted
  /// result  becomes what was rendered, in the memory that it has: pages that are new cost more than the download
  /// throws DeviceLost (everything of the device is to be made anew), DeviceOutOfMemory, DeviceError
  void render(std::span<const ImagePixel> pixels, const SampleRange& range, const SumsBefore* before,
              const std::atomic<bool>& stop, const std::function<void(uint64_t)>& on_samples, RunTally& tally,
              GroupResult& result);

  /// Makes the device ready for replicates of blocks with so many pixels, the first of which has so many samples, all of which stay there.
  /// form  with moments
  /// false: it has not the memory
  bool begin_replicates(std::span<const std::size_t> block_pixels, const FilmForm& form, uint32_t samples);
  /// Renders the range, the next replicate from its first sample on, for the pixels of these blocks, and adds it to the others.
  /// open: by the rule of films that keep sums, whose bits differ; asked for in the form
  /// returns its samples per pixel, fewer than asked for if stop became true; throws as render()
  uint32_t add_replicate(std::span<const ImagePixel> pixels, const SampleRange& range, bool open,
                         const std::atomic<bool>& stop, const std::function<void(uint64_t)>& on_samples,
                         RunTally& tally);
  /// All that was added.
  DeviceReplicates& replicates() { return device_.replicates(); }

  /// The paths of one sample of each pixel (methods dpept: with pt vertices are not kept). hits: as DeviceState::trace.
  std::vector<TracedPath> trace(std::span<const ImagePixel> pixels, const SampleRange& range,
                                bool hits = true);

 private:
  /// rounds  that are to be one, if the device has the memory
  void prepare(uint64_t pixels, FilmForm form = {}, uint32_t rounds = 1);
  void make_pool(const PlanRequest& request, FilmForm form);
  PlanRequest request(uint64_t pixels, FilmForm form, uint32_t rounds) const;
  uint32_t rounds_as_one(uint64_t pixels, uint32_t samples) const;
  uint32_t fitting_rounds(std::span<const ImagePixel> pixels, uint32_t samples) const;
  SampleCut next_round(const SampleRange& range, uint32_t done, bool goes_on, uint32_t rounds) const;
  /// Renders samples [first, first + count) of pixels [at, at + number) of the group;
  /// splits where the arena is too small.
  void render_part(std::span<const ImagePixel> pixels, uint64_t at, uint64_t number,
                   const SampleRange& samples, bool open, RunTally& tally);
  uint32_t render_samples(std::span<const ImagePixel> pixels, const SampleRange& range, bool open,
                          const std::atomic<bool>& stop, const std::function<void(uint64_t)>& on_samples,
                          RunTally& tally);
  void learn_last(RunTally& tally);
  void begin_film(uint64_t pixels, const SampleRange& range, const SumsBefore* before);
  uint64_t paths_of_arena() const;
  uint64_t round_pixels(uint32_t samples) const;
  KbRound make_round(const SampleRange& samples, uint64_t number) const;
  void fill_pixels(std::span<const ImagePixel> pixels, KbRound& round);
  void fill_mu(const KbRound& round);
  void split(std::span<const ImagePixel> pixels, uint64_t at, uint64_t number, const SampleRange& samples,
             bool open, RunTally& tally);
  void note_invalid(const RoundOutcome& outcome, const KbRound& round, RunTally& tally) const;
  void learn(const RoundOutcome& outcome, const KbRound& round);
  void learn_evaluation(RunTally& tally);

  DeviceState& device_;
  SamplingSettings settings_;
  DiagnosticSink note_;
  std::optional<RoundPlan> plan_;
  uint64_t planned_pixels_ = 0;
  FilmForm planned_form_;
  bool has_sums_ = false;  // the device's film, from a render that has got through
  uint32_t planned_rounds_ = 1;
  uint32_t round_samples_;
  uint32_t most_slots_;
  uint64_t most_jobs_;
  LaunchPace slots_pace_, paths_pace_, samples_pace_;
  double chunks_per_path_ = 3;    // measured
  uint64_t evaluated_paths_ = 0;  // by the evaluation that was enqueued last
  uint32_t evaluated_samples_ = 0;
  bool knows_paths_pace_ = false;
  std::vector<KbRoundPixel> round_pixels_;
  std::vector<float> mu_;
};

}  // namespace kiloband::opencl
