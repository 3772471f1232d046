#include "render/passes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "render/checkpoint.hpp"
#include "render/error_sums.hpp"

namespace kiloband {
namespace {

constexpr uint32_t kPartSamples = 16;  // most samples of a replicate that are rendered at a time

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<uint32_t> all_blocks(const SpectralFilm& film) {
  std::vector<uint32_t> blocks(film.blocks().size());
  std::iota(blocks.begin(), blocks.end(), 0u);
  return blocks;
}

std::optional<double> film_error(const SpectralFilm& film) {
  const std::size_t channels = film.options().channels;
  std::vector<float> mean(film.rect().width * channels), variance(mean.size());
  ErrorSums sums(channels);
  for (uint32_t y = 0; y < film.rect().height; ++y) {
    film.row(y, mean, variance);
    for (std::size_t i = 0; i < mean.size(); ++i) sums.add(i % channels, mean[i], variance[i]);
  }
  return sums.relative_error();
}

}  // namespace

bool replicates_in_parts(uint64_t samples_per_pixel, uint32_t replicates) {
  return ReplicatePlan::deal(samples_per_pixel, replicates).size(0) > kPartSamples;
}

Passes::Passes(Backend& backend, const SessionSettings& settings, uint32_t replicates,
               const std::atomic<bool>& stop, const std::function<void(const Progress&)>& progress)
    : backend_(backend),
      settings_(settings),
      replicates_(replicates),
      stop_(stop),
      progress_(progress),
      in_parts_(settings.stop.samples_per_pixel &&
                replicates_in_parts(*settings.stop.samples_per_pixel, replicates)) {}

void Passes::expect(uint64_t total, uint64_t resumed) {
  total_ = total;
  done_ = resumed_ = resumed;
}

void Passes::render(SpectralFilm& film) {
  start_ = last_checkpoint_ = Clock::now();
  settings_.stop.samples_per_pixel ? render_fixed(film) : render_passes(film);
  if (settings_.stop.relative_error && !stop_) tell_progress(1);
  seconds_ += seconds_since(start_);
}

void Passes::render_fixed(SpectralFilm& film) {
  const ReplicatePlan plan = ReplicatePlan::deal(*settings_.stop.samples_per_pixel, replicates_);
  for (uint32_t r = 0; r < plan.replicates && !stop_; ++r) {
    const auto target = static_cast<uint32_t>(plan.size(r));
    if (!film.options().held) {
      render_replicate(film, r, target);
    } else {
      bring_to(film, r, target, stop_, [this](uint64_t pixels) { advance(pixels); });
    }
  }
  film.finish_replicates();
}

/// Samples first, first + 1, ... of a replicate that are rendered at one go. Long replicates come in parts,
/// so that an interrupted render is even; the first replicate begins with single samples, so that every pixel
/// soon has some. With a checkpoint the steps follow its clock.
uint32_t Passes::next_part(uint32_t replicate, uint32_t first, uint32_t target) const {
  const uint32_t left = target - first;
  if (settings_.checkpoint) return std::min(left, step_);
  if (!in_parts_) return left;
  return std::min(left, replicate > 0 ? kPartSamples : std::clamp(first, 1u, kPartSamples));
}

/// All blocks of a folded film.
void Passes::render_replicate(SpectralFilm& film, uint32_t replicate, uint32_t target) {
  for (uint32_t first = 0; first < target && !stop_;) {
    const uint32_t count = next_part(replicate, first, target);
    backend_.render(film, {replicate, first, count}, all_blocks(film), stop_,
                    [this](uint64_t pixels) { advance(pixels); });
    first += count;
  }
}

/// Renders what blocks of a held film lack of a replicate's first `target` samples.
void Passes::bring_to(SpectralFilm& film, uint32_t replicate, uint32_t target, const std::atomic<bool>& stop,
                      const std::function<void(uint64_t)>& on_samples) {
  std::map<uint32_t, std::vector<uint32_t>> behind;  // samples that blocks have: which blocks
  for (uint32_t b = 0; b < film.blocks().size(); ++b) {
    if (const uint32_t done = film.attempted(replicate, b); done < target) behind[done].push_back(b);
  }
  for (const auto& [done, blocks] : behind) {
    for (uint32_t first = done; first < target && !stop;) {
      const uint32_t count = next_part(replicate, first, target);
      const auto begin = Clock::now();
      backend_.render(film, {replicate, first, count}, blocks, stop, on_samples);
      first += count;
      if (settings_.checkpoint) save_now_and_then(film, seconds_since(begin));
    }
  }
}

void Passes::save_now_and_then(const SpectralFilm& film, double step_seconds) {
  const double interval = settings_.checkpoint_interval_seconds;
  if (step_seconds < interval / 8 && step_ < 1u << 20) step_ *= 2;
  if (step_seconds > interval / 2 && step_ > 1) step_ /= 2;
  if (seconds_since(last_checkpoint_) < interval) return;
  write_checkpoint(*settings_.checkpoint, film, settings_.fingerprint);
  last_checkpoint_ = Clock::now();
}

/// Passes over all replicates, each as long as all before it, until the rule is met.
void Passes::render_passes(SpectralFilm& film) {
  std::atomic<bool> halt{false};
  const auto on_samples = [&](uint64_t pixels) {
    advance(pixels);
    if (stop_ || out_of_time()) halt = true;
  };
  uint32_t done = least_attempted(film);
  const uint32_t begin = done;
  if (done > 0 && error_is_small(film)) return;
  while (!halt) {
    uint32_t count = std::max(1u, done);
    if (settings_.stop.seconds) count = samples_that_fit(done - begin, count);
    done += count;
    for (uint32_t r = 0; r < replicates_ && !halt; ++r) bring_to(film, r, done, halt, on_samples);
    if (!halt && error_is_small(film)) return;
  }
}

uint32_t Passes::least_attempted(const SpectralFilm& film) const {
  uint32_t least = ~0u;
  for (uint32_t r = 0; r < replicates_; ++r) {
    for (uint32_t b = 0; b < film.blocks().size(); ++b) least = std::min(least, film.attempted(r, b));
  }
  return least;
}

bool Passes::error_is_small(const SpectralFilm& film) {
  if (!settings_.stop.relative_error) return false;
  error_ = film_error(film);
  error_done_ = done_;
  // Without any light there is no relative error: a black image is given up after this many samples per
  // pixel.
  constexpr uint64_t kBlackSamples = 1024;
  if (!error_) return uint64_t{least_attempted(film)} * replicates_ >= kBlackSamples;
  return *error_ <= *settings_.stop.relative_error;
}

/// Samples per replicate of the next pass, so that it ends near the time limit: all replicates stay even.
uint32_t Passes::samples_that_fit(uint32_t done, uint32_t wanted) const {
  if (done == 0) return wanted;
  const double rate = done / seconds_since(start_);
  const double left = *settings_.stop.seconds - seconds_since(start_);
  return static_cast<uint32_t>(std::clamp(rate * left, 1.0, static_cast<double>(wanted)));
}

bool Passes::out_of_time() const {
  return settings_.stop.seconds && seconds_since(start_) >= *settings_.stop.seconds;
}

/// Part of the work that is done. The error goes with 1 / sqrt(samples): of the samples that a target error
/// takes, those at the last look at the error were (target / error)^2; 1 is for the end alone.
double Passes::fraction() const {
  if (settings_.stop.seconds) return std::min(1.0, seconds_since(start_) / *settings_.stop.seconds);
  if (total_ > 0) return static_cast<double>(done_) / static_cast<double>(total_);
  if (!error_ || error_done_ == 0) return 0;
  const double ratio = *settings_.stop.relative_error / *error_;
  return std::min(0.99, ratio * ratio * static_cast<double>(done_) / static_cast<double>(error_done_));
}

void Passes::advance(uint64_t pixels) {
  done_ += pixels;
  tell_progress(fraction());
}

void Passes::tell_progress(double fraction) const {
  if (!progress_) return;
  Progress state;
  state.fraction = fraction;
  state.pixel_samples = done_;
  state.seconds = seconds_ + seconds_since(start_);
  state.rate = state.seconds > 0 ? static_cast<double>(done_ - resumed_) / state.seconds : 0;
  state.error = error_;
  progress_(state);
}

}  // namespace kiloband
