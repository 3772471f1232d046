#include "render/passes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

namespace kiloband {
namespace {

constexpr uint32_t kWholeSamples = 16;  // replicates of so many samples are rendered at one go
constexpr double kPartSeconds = 1;      // parts of longer ones are longer where they take less than this,
constexpr uint32_t kEvenness = 8;       // up to this part of what pixels have
constexpr double kMostGrowth = 16;      // of a part over the one before

BandErrors film_errors(const SpectralFilm& film, const std::vector<std::size_t>& channels) {
  const std::size_t stride = film.options().channels;
  std::vector<float> mean(film.rect().width * stride), variance(mean.size());
  std::vector<double> pixel_mean(channels.size()), pixel_variance(channels.size());
  ErrorSums sums(channels.size());
  for (uint32_t y = 0; y < film.rect().height; ++y) {
    film.row(y, mean, variance);
    for (std::size_t first = 0; first < mean.size(); first += stride) {
      for (std::size_t band = 0; band < channels.size(); ++band) {
        pixel_mean[band] = mean[first + channels[band]];
        pixel_variance[band] = variance[first + channels[band]];
      }
      sums.add(pixel_mean, pixel_variance);
    }
  }
  return sums.errors();
}

}  // namespace

bool replicates_in_parts(uint64_t samples_per_pixel, uint32_t replicates) {
  return ReplicatePlan::deal(samples_per_pixel, replicates).size(0) > kWholeSamples;
}

Passes::Passes(Backend& backend, const SessionSettings& settings, uint32_t replicates,
               const std::vector<std::size_t>& channels, const std::atomic<bool>& stop,
               const std::function<void(const Progress&)>& progress)
    : backend_(backend),
      settings_(settings),
      replicates_(replicates),
      channels_(channels),
      stop_(stop),
      progress_(progress),
      in_parts_(settings.stop.is_fixed() &&
                replicates_in_parts(*settings.stop.samples_per_pixel, replicates)),
      whole_steps_(backend.sum_rule().step) {
  if (settings.checkpoint) keeper_.emplace(settings);
}

void Passes::expect(uint64_t total, uint64_t resumed) {
  total_ = total;
  done_ = resumed_ = resumed;
}

void Passes::render(SpectralFilm& film) {
  start_ = Clock::now();
  if (keeper_) keeper_->restart();
  if (settings_.stop.is_fixed()) {
    render_fixed(film);
  } else {
    ended_by_ = render_passes(film);
    if (settings_.stop.relative_error && errors_done_ != done_) update_errors(film);
    if (!stop_) tell_progress(1);
  }
  if (stop_) ended_by_ = StopReason::kInterrupt;
  seconds_ += seconds_since(start_);
}

void Passes::render_fixed(SpectralFilm& film) {
  const ReplicatePlan plan = ReplicatePlan::deal(*settings_.stop.samples_per_pixel, replicates_);
  const auto on_samples = [this](uint64_t pixels) { advance(pixels); };
  uint32_t done = 0;
  if (!film.options().held) done = backend_.render_replicates(film, plan, stop_, on_samples);
  for (uint32_t r = done; r < plan.replicates && !stop_; ++r) {
    const auto target = static_cast<uint32_t>(plan.size(r));
    if (!film.options().held || !film.keeps_sums()) {
      render_replicate(film, r, target);
    } else {
      bring_to(film, r, target, stop_, on_samples);
    }
  }
  film.finish_replicates();
}

/// Samples first, first + 1, ... of a replicate that are rendered at one go. Long replicates come in parts,
/// so that an interrupted render is even; the first part is a single sample, so that every pixel soon has some, the next ones as many as
/// pixels have, up to kWholeSamples, and more where the clock says that they are short. With a checkpoint parts follow its clock alone.
/// Each part brings the film back from the backend: few are better. What is seen of them later is where the render was
/// interrupted: sums do not depend on the parts that they come in.
uint32_t Passes::next_part(uint32_t first, uint32_t target) const {
  const uint32_t left = target - first;
  const uint32_t least = std::clamp(first, 1u, kWholeSamples);
  const uint32_t most = first > 0 ? std::max(kWholeSamples, first / kEvenness) : 1;
  const uint32_t wanted = keeper_ ? step_ : std::clamp(step_, least, most);
  if ((!keeper_ && !in_parts_) || wanted >= left) return left;
  const uint64_t end = uint64_t{first} + wanted,
                 whole = (end + whole_steps_ - 1) / whole_steps_ * whole_steps_;
  return static_cast<uint32_t>(std::min<uint64_t>(left, whole - first));
}

/// All blocks of a film that takes one replicate after the other.
void Passes::render_replicate(SpectralFilm& film, uint32_t replicate, uint32_t target) {
  for (uint32_t first = 0; first < target && !stop_;) {
    const uint32_t count = next_part(first, target);
    const auto begin = Clock::now();
    backend_.render(film, {replicate, first, count}, film.all_blocks(), stop_,
                    [this](uint64_t pixels) { advance(pixels); });
    first += count;
    adapt_step(count, seconds_since(begin));
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
      const uint32_t count = next_part(first, target);
      const auto begin = Clock::now();
      backend_.render(film, {replicate, first, count}, blocks, stop, on_samples);
      first += count;
      adapt_step(count, seconds_since(begin));
      if (keeper_) keeper_->save_if_due(film);
    }
  }
}

/// As many samples as take kPartSeconds, or a quarter of the checkpoint's interval, by the part before.
void Passes::adapt_step(uint32_t samples, double seconds) {
  const double wanted = keeper_ ? settings_.checkpoint_interval_seconds / 4 : kPartSeconds;
  const double fitting = samples * std::min(wanted / std::max(seconds, 1e-9), kMostGrowth);
  step_ = static_cast<uint32_t>(std::clamp(fitting, 1.0, 0x1p20));
}

/// Passes over all replicates, each as long as all before it, with a time limit as all before it in this session, until a rule is met. Where the number of
/// samples has a limit, it is dealt to the replicates as if there were no other rule. Without a time limit
/// passes end at powers of two, and the error is looked at there and at the limit alone: where a render was
/// interrupted has no say in where it ends.
StopReason Passes::render_passes(SpectralFilm& film) {
  const auto& samples = settings_.stop.samples_per_pixel;
  const ReplicatePlan plan{samples.value_or(uint64_t{replicates_} << 31), replicates_};
  const auto most = static_cast<uint32_t>(plan.size(0));
  std::atomic<bool> halt{false};
  const auto on_samples = [&](uint64_t pixels) {
    advance(pixels);
    if (stop_ || out_of_time()) halt = true;
  };
  uint32_t done = least_attempted(film);
  const uint32_t begin = done;
  if (is_pass_end(film) || done >= most) {
    if (const auto reason = look_at_error(film)) return *reason;
  }
  while (!halt && done < most) {
    done = pass_end(done, begin, most);
    for (uint32_t r = 0; r < replicates_ && !halt; ++r) {
      const auto target = static_cast<uint32_t>(std::min<uint64_t>(done, plan.size(r)));
      bring_to(film, r, target, halt, on_samples);
    }
    if (halt) break;
    if (const auto reason = look_at_error(film)) return *reason;
  }
  return halt ? StopReason::kTime : StopReason::kSamples;
}

/// Samples per replicate, `most` at the end, after the pass that begins with `done` of them; the session
/// began with `begin`.
uint32_t Passes::pass_end(uint32_t done, uint32_t begin, uint32_t most) const {
  if (!settings_.stop.seconds) return std::min(most, std::bit_ceil(done + 1));
  const uint32_t so_far = done - begin;  // what the rate is known from
  return done + samples_that_fit(so_far, std::min(std::max(1u, so_far), most - done));
}

/// Whether all replicates of all blocks have as many samples as after some pass to a target error.
bool Passes::is_pass_end(const SpectralFilm& film) const {
  const uint32_t least = least_attempted(film);
  for (uint32_t r = 0; r < replicates_; ++r) {
    for (uint32_t b = 0; b < film.blocks().size(); ++b) {
      if (film.attempted(r, b) != least) return false;
    }
  }
  return std::has_single_bit(least);
}

uint32_t Passes::least_attempted(const SpectralFilm& film) const {
  uint32_t least = ~0u;
  for (uint32_t r = 0; r < replicates_; ++r) {
    for (uint32_t b = 0; b < film.blocks().size(); ++b) least = std::min(least, film.attempted(r, b));
  }
  return least;
}

void Passes::update_errors(const SpectralFilm& film) {
  errors_ = film_errors(film, channels_);
  errors_done_ = done_;
}

/// Whether the errors end the render, where there is a target.
std::optional<StopReason> Passes::look_at_error(const SpectralFilm& film) {
  if (!settings_.stop.relative_error) return std::nullopt;
  update_errors(film);
  if (errors_.worst && *errors_.worst <= *settings_.stop.relative_error) return StopReason::kError;
  // Without any light there is no relative error: a black image is given up after this many
  // samples per pixel.
  constexpr uint64_t kBlackSamples = 1024;
  const bool dark = !errors_.worst && uint64_t{least_attempted(film)} * replicates_ >= kBlackSamples;
  return dark ? std::optional(StopReason::kDark) : std::nullopt;
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

/// Part of the work that is done, by the rule that is nearest to its end. The error goes with 1 / sqrt(samples):
/// of the samples that a target error takes, those at the last look at the error were (target / error)^2; 1 is
/// for the end alone.
double Passes::fraction() const {
  const auto done = static_cast<double>(done_);
  double fraction = 0;
  if (settings_.stop.seconds) fraction = std::min(1.0, seconds_since(start_) / *settings_.stop.seconds);
  if (total_ > 0) fraction = std::max(fraction, done / static_cast<double>(total_));
  if (settings_.stop.relative_error && errors_.worst && errors_done_ > 0) {
    const double ratio = *settings_.stop.relative_error / *errors_.worst;
    fraction = std::max(fraction, std::min(0.99, ratio * ratio * done / static_cast<double>(errors_done_)));
  }
  return std::min(fraction, 1.0);  // a checkpoint may have more samples than are asked for
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
  state.error = errors_.worst;
  progress_(state);
}

}  // namespace kiloband
