// The sampling of a session: which replicate gets how many samples next, until the stop rule is met; progress
// and checkpoints on the way.
#pragma once

#include <chrono>
#include <optional>

#include "render/checkpoint/checkpoint_keeper.hpp"
#include "render/session.hpp"

namespace kiloband {

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

class Passes {
 public:
  /// All references must outlive the object. channels: those of the film that are output, band by band; a
  /// target error is theirs.
  Passes(Backend& backend, const SessionSettings& settings, uint32_t replicates,
         const std::vector<std::size_t>& channels, const std::atomic<bool>& stop,
         const std::function<void(const Progress&)>& progress);

  /// Pixel samples of the whole session, and those that a checkpoint brought: for the progress.
  void expect(uint64_t total, uint64_t resumed);
  /// Fills a film, to the end of the stop rule or until `stop`. Sessions of strips call it for each.
  void render(SpectralFilm& film);

  /// Keeps the checkpoint; none without SessionSettings::checkpoint.
  CheckpointKeeper* keeper() { return keeper_ ? &*keeper_ : nullptr; }

  double seconds() const { return seconds_; }  // spent in render()
  /// With a target error: those of the film at the end of render().
  const BandErrors& errors() const { return errors_; }
  StopReason ended_by() const { return ended_by_; }

 private:
  using Clock = std::chrono::steady_clock;

  void render_fixed(SpectralFilm& film);
  void render_replicate(SpectralFilm& film, uint32_t replicate, uint32_t target);
  StopReason render_passes(SpectralFilm& film);
  void bring_to(SpectralFilm& film, uint32_t replicate, uint32_t target, const std::atomic<bool>& stop,
                const std::function<void(uint64_t)>& on_samples);
  uint32_t next_part(uint32_t first, uint32_t target) const;
  void adapt_step(uint32_t samples, double seconds);
  bool is_pass_end(const SpectralFilm& film) const;
  uint32_t pass_end(uint32_t done, uint32_t begin, uint32_t most) const;
  std::optional<StopReason> look_at_error(const SpectralFilm& film);
  void update_errors(const SpectralFilm& film);
  uint32_t least_attempted(const SpectralFilm& film) const;
  uint32_t samples_that_fit(uint32_t done, uint32_t wanted) const;
  bool out_of_time() const;
  double fraction() const;
  void advance(uint64_t pixels);
  void tell_progress(double fraction) const;

  Backend& backend_;
  const SessionSettings& settings_;
  const uint32_t replicates_;
  const std::vector<std::size_t>& channels_;
  const std::atomic<bool>& stop_;
  const std::function<void(const Progress&)>& progress_;
  const bool in_parts_;
  const uint32_t whole_steps_;  // SumRule::step
  std::optional<CheckpointKeeper> keeper_;
  Clock::time_point start_;
  double seconds_ = 0;
  uint32_t step_ = 1;                            // samples of the next part of a replicate
  uint64_t done_ = 0, total_ = 0, resumed_ = 0;  // pixel samples
  BandErrors errors_;
  uint64_t errors_done_ = 0;  // done_ when errors_ were found
  StopReason ended_by_ = StopReason::kSamples;
};

}  // namespace kiloband
