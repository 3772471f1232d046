#include "render/session.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numeric>

#include "render/checkpoint.hpp"
#include "render/cube_output.hpp"

namespace kiloband {
namespace {

using Clock = std::chrono::steady_clock;

constexpr uint32_t kPartSamples = 16;  // most samples of a replicate that are rendered at a time

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::vector<uint32_t> all_blocks(const SpectralFilm& film) {
  std::vector<uint32_t> blocks(film.blocks().size());
  std::iota(blocks.begin(), blocks.end(), 0u);
  return blocks;
}

/// One session: the state that its steps share.
class Session {
 public:
  Session(const FlatScene& scene, const std::vector<std::string>& derived_names, Backend& backend,
          const SessionSettings& settings, const std::atomic<bool>& stop,
          const std::function<void(const Progress&)>& progress)
      : scene_(scene),
        backend_(backend),
        settings_(settings),
        stop_(stop),
        progress_(progress),
        bands_(select_bands(scene, derived_names)),
        channels_(scene.channels.size() + derived_names.size()),
        replicates_(session_replicates(settings)) {}

  RenderReport run() {
    const PixelRect image{scene_.film.crop_x, scene_.film.crop_y, scene_.film.crop_width,
                          scene_.film.crop_height};
    FilmOptions options;
    options.channels = channels_;
    options.replicates = replicates_;
    options.variance = settings_.variance;
    const bool revisits =
        settings_.checkpoint || !settings_.stop.samples_per_pixel;  // passes come back to replicates
    options.held = settings_.keep_replicates || revisits;
    options.memory_bytes = settings_.memory_budget_bytes;
    options.parts = !options.held && replicates_in_parts(*settings_.stop.samples_per_pixel, replicates_);
    const std::size_t row_bytes =
        image.width * (SpectralFilm::bytes_per_pixel(options) + output_bytes_per_pixel());
    const std::size_t strip = strip_rows(row_bytes, image.height);
    report_.replicates = replicates_;
    const bool whole = revisits || row_bytes * image.height <= settings_.memory_budget_bytes;
    strip_ = static_cast<uint32_t>(strip);
    whole ? run_whole(image, options) : run_strips(image, options);
    report_.interrupted = stop_;
    if (!report_.mean_relative_error)
      report_.mean_relative_error = error_;  // --target-error without --variance
    finish_image_moments();
    return report_;
  }

 private:
  std::size_t output_bytes_per_pixel() const {
    return bands_.bands.size() * sizeof(float) * (settings_.variance ? 2 : 1) / 8;
  }

  /// Rows of a strip: a quarter of the budget, whole blocks.
  std::size_t strip_rows(std::size_t row_bytes, uint32_t height) const {
    const std::size_t wanted = settings_.memory_budget_bytes / 4 / std::max<std::size_t>(row_bytes, 1);
    const std::size_t rows = std::max<std::size_t>(wanted / kBlockSize * kBlockSize, kBlockSize);
    return std::min<std::size_t>(rows, height);
  }

  /// The whole image is one film (in memory, or held in a scratch file): replicate after replicate over all
  /// blocks, so that an interrupted render is even.
  void run_whole(const PixelRect& image, const FilmOptions& options) {
    make_output(
        settings_.stop.samples_per_pixel.value_or(0));  // hours of rendering must not end at a file name
    SpectralFilm film(image, options);
    if (settings_.resume && std::filesystem::exists(*settings_.checkpoint)) {
      report_.resumed_samples = done_ = read_checkpoint(*settings_.checkpoint, film, settings_.fingerprint);
    }
    start_ = last_checkpoint_ = Clock::now();
    if (settings_.stop.samples_per_pixel) {
      total_ = image.pixels() * *settings_.stop.samples_per_pixel;
      render_fixed(film);
    } else {
      render_passes(film);
    }
    report_.sampling_seconds += seconds_since(start_);
    if (settings_.checkpoint) write_checkpoint(*settings_.checkpoint, film, settings_.fingerprint);
    film.add_image_sums(image_sums_, image_counts_);
    const auto output = make_output(least_samples(film));
    write(film, *output);
    finish(*output);
  }

  std::unique_ptr<CubeOutput> make_output(uint64_t samples_per_pixel) const {
    return std::make_unique<CubeOutput>(scene_, bands_, backend_.film_scale(), settings_, replicates_,
                                        samples_per_pixel, strip_);
  }

  static uint64_t least_samples(const SpectralFilm& film) {
    uint64_t least = ~0ull;
    for (uint32_t y = 0; y < film.rect().height; ++y) {
      for (uint32_t x = 0; x < film.rect().width; ++x) least = std::min(least, film.samples(x, y));
    }
    return least;
  }

  void finish(CubeOutput& output) {
    const auto writing = Clock::now();
    output.finish(report_);
    report_.output_seconds += seconds_since(writing);
  }

  /// Strips of rows: each is finished and written before the next begins.
  void run_strips(const PixelRect& image, const FilmOptions& options) {
    report_.streamed = true;
    total_ = image.pixels() * *settings_.stop.samples_per_pixel;
    const auto output = make_output(*settings_.stop.samples_per_pixel);
    for (uint32_t y = 0; y < image.height; y += strip_) {
      const PixelRect rect{image.x0, image.y0 + y, image.width, std::min(strip_, image.height - y)};
      if (stop_) {
        output->write_missing(rect);
        continue;
      }
      SpectralFilm film(rect, options);
      start_ = Clock::now();
      render_fixed(film);
      report_.sampling_seconds += seconds_since(start_);
      film.add_image_sums(image_sums_, image_counts_);
      write(film, *output);
    }
    finish(*output);
  }

  void write(const SpectralFilm& film, CubeOutput& output) {
    const auto writing = Clock::now();
    output.write(film, backend_);
    report_.output_seconds += seconds_since(writing);
  }

  void render_fixed(SpectralFilm& film) {
    const ReplicatePlan plan = ReplicatePlan::deal(*settings_.stop.samples_per_pixel, replicates_);
    const auto on_samples = [this](uint64_t pixels) { advance(pixels); };
    for (uint32_t r = 0; r < plan.replicates && !stop_; ++r) {
      const auto target = static_cast<uint32_t>(plan.size(r));
      if (!film.options().held) {
        render_replicate(film, r, target, on_samples);
      } else {
        bring_to(film, r, target, stop_, on_samples);
      }
    }
    film.finish_replicates();
  }

  /// All blocks of a folded film, in parts if the replicate is long. The first replicate begins with single
  /// samples, so that every pixel soon has some.
  void render_replicate(SpectralFilm& film, uint32_t replicate, uint32_t target,
                        const std::function<void(uint64_t)>& on_samples) {
    uint32_t count = film.options().parts ? kPartSamples : target;
    for (uint32_t first = 0; first < target && !stop_; first += count) {
      if (film.options().parts) count = replicate > 0 ? kPartSamples : std::clamp(first, 1u, kPartSamples);
      count = std::min(count, target - first);
      backend_.render(film, {replicate, first, count}, all_blocks(film), stop_, on_samples);
    }
  }

  /// Renders what blocks of a held film lack of a replicate's first `target` samples; with a checkpoint in
  /// steps of a few samples, so that it can be saved in between.
  void bring_to(SpectralFilm& film, uint32_t replicate, uint32_t target, const std::atomic<bool>& stop,
                const std::function<void(uint64_t)>& on_samples) {
    std::map<uint32_t, std::vector<uint32_t>> behind;  // samples that blocks have: which blocks
    for (uint32_t b = 0; b < film.blocks().size(); ++b) {
      if (const uint32_t done = film.attempted(replicate, b); done < target) behind[done].push_back(b);
    }
    for (const auto& [done, blocks] : behind) {
      for (uint32_t first = done; first < target && !stop;) {
        const uint32_t count = std::min(target - first, settings_.checkpoint ? step_ : target - first);
        const auto begin = Clock::now();
        backend_.render(film, {replicate, first, count}, blocks, stop, on_samples);
        first += count;
        if (settings_.checkpoint) save_now_and_then(film, seconds_since(begin));
      }
    }
  }

  void save_now_and_then(const SpectralFilm& film, double step_seconds) {
    const double interval = settings_.checkpoint_interval_seconds;
    if (step_seconds < interval / 8 && step_ < 1u << 20) step_ *= 2;
    if (step_seconds > interval / 2 && step_ > 1) step_ /= 2;
    if (seconds_since(last_checkpoint_) < interval) return;
    write_checkpoint(*settings_.checkpoint, film, settings_.fingerprint);
    last_checkpoint_ = Clock::now();
  }

  /// Passes over all replicates, each as long as all before it, until the rule is met.
  void render_passes(SpectralFilm& film) {
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

  uint32_t least_attempted(const SpectralFilm& film) const {
    uint32_t least = ~0u;
    for (uint32_t r = 0; r < replicates_; ++r) {
      for (uint32_t b = 0; b < film.blocks().size(); ++b) least = std::min(least, film.attempted(r, b));
    }
    return least;
  }

  bool error_is_small(const SpectralFilm& film) {
    if (!settings_.stop.relative_error) return false;
    error_ = film_error(film);
    // Without any light there is no relative error: a black image is given up after this many samples per
    // pixel.
    constexpr uint64_t kBlackSamples = 1024;
    if (!error_) return uint64_t{least_attempted(film)} * replicates_ >= kBlackSamples;
    return *error_ <= *settings_.stop.relative_error;
  }

  /// Samples per replicate of the next pass, so that it ends near the time limit: all replicates stay even.
  uint32_t samples_that_fit(uint32_t done, uint32_t wanted) const {
    if (done == 0) return wanted;
    const double rate = done / seconds_since(start_);
    const double left = *settings_.stop.seconds - seconds_since(start_);
    return static_cast<uint32_t>(std::clamp(rate * left, 1.0, static_cast<double>(wanted)));
  }

  bool out_of_time() const {
    return settings_.stop.seconds && seconds_since(start_) >= *settings_.stop.seconds;
  }

  std::optional<double> film_error(const SpectralFilm& film) const {
    std::vector<double> mean_sum(channels_), variance_sum(channels_);
    std::vector<float> mean(film.rect().width * channels_), variance(mean.size());
    uint64_t pixels = 0;
    for (uint32_t y = 0; y < film.rect().height; ++y) {
      film.row(y, mean, variance);
      for (std::size_t first = 0; first < mean.size(); first += channels_) {
        if (!std::isfinite(variance[first])) continue;  // fewer than two replicates with a valid sample
        ++pixels;
        for (std::size_t c = 0; c < channels_; ++c) {
          mean_sum[c] += mean[first + c];
          variance_sum[c] += variance[first + c];
        }
      }
    }
    return relative_error(mean_sum, variance_sum, pixels);
  }

  void advance(uint64_t pixels) {
    done_ += pixels;
    if (!progress_) return;
    Progress state;
    state.pixel_samples = done_;
    state.rate = seconds_since(start_) + report_.sampling_seconds > 0
                     ? static_cast<double>(done_ - report_.resumed_samples) /
                           (report_.sampling_seconds + seconds_since(start_))
                     : 0;
    state.seconds = report_.sampling_seconds + seconds_since(start_);
    state.error = error_;
    if (total_ > 0) state.fraction = static_cast<double>(done_) / static_cast<double>(total_);
    if (settings_.stop.seconds)
      state.fraction = std::min(1.0, seconds_since(start_) / *settings_.stop.seconds);
    progress_(state);
  }

  void finish_image_moments() {
    const ReplicateMoments moments = moments_of_sums(image_sums_, image_counts_);
    const std::vector<double> scale = backend_.film_scale();
    std::vector<float> variance(moments.channels());
    moments.variance_of_mean(0, variance);
    for (const std::size_t c : bands_.film_channels) {
      report_.image_mean.push_back(moments.mean(0)[c] * scale[c]);
      report_.image_standard_error.push_back(std::sqrt(variance[c]) * scale[c]);
    }
  }

  const FlatScene& scene_;
  Backend& backend_;
  const SessionSettings& settings_;
  const std::atomic<bool>& stop_;
  const std::function<void(const Progress&)>& progress_;
  BandSelection bands_;
  std::size_t channels_;
  uint32_t replicates_, strip_ = 0;
  RenderReport report_;
  Clock::time_point start_, last_checkpoint_;
  uint32_t step_ = 1;  // samples per replicate between looks at the checkpoint clock
  uint64_t done_ = 0, total_ = 0;
  std::optional<double> error_;
  std::vector<std::vector<double>> image_sums_;
  std::vector<uint64_t> image_counts_;
};

}  // namespace

uint32_t session_replicates(const SessionSettings& settings) {
  if (!settings.stop.samples_per_pixel) return settings.replicates;
  return ReplicatePlan::deal(*settings.stop.samples_per_pixel, settings.replicates).replicates;
}

bool replicates_in_parts(uint64_t samples_per_pixel, uint32_t replicates) {
  return ReplicatePlan::deal(samples_per_pixel, replicates).size(0) > kPartSamples;
}

BandSelection select_bands(const FlatScene& scene, const std::vector<std::string>& derived_names) {
  BandSelection selection;
  const bool named_only =
      !scene.film.responses.empty();  // sub-channels of a specfilm's responses are not output
  for (std::size_t k = 0; k < scene.channels.size(); ++k) {
    if (named_only && scene.channels[k].name.empty()) continue;
    selection.bands.push_back({scene.channels[k], false});
    selection.film_channels.push_back(k);
  }
  const Channel range = hull(scene.channels);
  for (std::size_t d = 0; d < derived_names.size(); ++d) {
    selection.bands.push_back({{range.min_nm, range.max_nm, derived_names[d]}, true});
    selection.film_channels.push_back(scene.channels.size() + d);
  }
  return selection;
}

RenderReport run_session(const FlatScene& scene, const std::vector<std::string>& derived_names,
                         Backend& backend, const SessionSettings& settings, const std::atomic<bool>& stop,
                         const std::function<void(const Progress&)>& progress) {
  return Session(scene, derived_names, backend, settings, stop, progress).run();
}

}  // namespace kiloband
