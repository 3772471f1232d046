#include "render/session.hpp"

#include <algorithm>
#include <chrono>

#include "render/checkpoint/checkpoint.hpp"
#include "render/cube_output.hpp"
#include "render/passes.hpp"
#include "render/sample_counter.hpp"

namespace kiloband {
namespace {

using Clock = std::chrono::steady_clock;

/// One session: the state that its steps share.
class Session {
 public:
  Session(const FlatScene& scene, const ChannelList& derived, Backend& backend,
          const SessionSettings& settings, const std::atomic<bool>& stop,
          const std::function<void(const Progress&)>& progress)
      : scene_(scene),
        backend_(backend),
        settings_(settings),
        stop_(stop),
        bands_(select_bands(scene, derived)),
        channels_(scene.channels.size() + derived.size()),
        replicates_(session_replicates(settings)),
        passes_(backend, settings, replicates_, bands_.film_channels, stop, progress) {}

  RenderReport run() {
    const PixelRect image = film_rect(scene_);
    // Passes come back to replicates.
    const bool revisits = settings_.checkpoint || !settings_.stop.is_fixed();
    const FilmOptions options = film_options(revisits);
    const std::size_t row_bytes =
        image.width * (SpectralFilm::bytes_per_pixel(options) + output_bytes_per_pixel());
    const std::size_t strip = strip_rows(row_bytes, image.height);
    report_.replicates = replicates_;
    report_.bands = bands_.bands;
    const bool whole = revisits || row_bytes * image.height <= settings_.memory_budget_bytes;
    strip_ = static_cast<uint32_t>(strip);
    whole ? run_whole(image, options) : run_strips(image, options);
    // Not what is asked for while a complete image is written.
    report_.ended_by = left_out_ ? StopReason::kInterrupt : passes_.ended_by();
    report_.interrupted = report_.ended_by == StopReason::kInterrupt;
    if (!settings_.variance) report_.errors = passes_.errors();  // of a target error
    report_.sampling_seconds = passes_.seconds();
    finish_image_moments();
    return report_;
  }

 private:
  FilmOptions film_options(bool revisits) const {
    FilmOptions options;
    options.channels = channels_;
    options.replicates = replicates_;
    options.variance = settings_.variance;
    options.held = settings_.keep_replicates || revisits;
    options.memory_bytes = settings_.memory_budget_bytes;
    if (revisits || replicates_in_parts(*settings_.stop.samples_per_pixel, replicates_))
      options.sums = backend_.sum_rule();
    options.most_samples = most_samples();
    return options;
  }

  /// Of a replicate; a checkpoint may have more than are asked for.
  uint32_t most_samples() const {
    if (!settings_.stop.samples_per_pixel) return ~0u;
    const uint64_t most = ReplicatePlan::deal(*settings_.stop.samples_per_pixel, replicates_).size(0);
    const uint32_t resumed = resumes() ? checkpoint_outline(*settings_.checkpoint).most_samples : 0;
    return std::max(static_cast<uint32_t>(most), resumed);
  }

  bool resumes() const {
    return settings_.resume && settings_.checkpoint && checkpoint_exists(*settings_.checkpoint);
  }

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
    CubeOutput output = make_output();
    SpectralFilm film(image, options);
    if (resumes()) {
      report_.resumed_samples = read_checkpoint(*settings_.checkpoint, film, settings_.fingerprint);
      passes_.keeper()->resumed();
    }
    passes_.expect(image.pixels() * settings_.stop.samples_per_pixel.value_or(0), report_.resumed_samples);
    passes_.render(film);
    if (settings_.checkpoint) passes_.keeper()->save_last(film);
    film.add_image_sums(image_sums_, image_counts_);
    SampleCounter counter(replicates_, settings_.keep_replicates);
    counter.add(film);
    output.set_counts(counter.counts());
    write(film, output);
    finish(output);
  }

  CubeOutput make_output() const {
    return {scene_, bands_, backend_.film_scale(), settings_, replicates_, strip_};
  }

  void finish(CubeOutput& output) {
    const auto writing = Clock::now();
    output.finish(report_);
    report_.output_seconds += seconds_since(writing);
  }

  /// Strips of rows: each is finished and written before the next begins.
  void run_strips(const PixelRect& image, const FilmOptions& options) {
    report_.streamed = true;
    passes_.expect(image.pixels() * *settings_.stop.samples_per_pixel, 0);
    CubeOutput output = make_output();
    SampleCounter counter(replicates_, settings_.keep_replicates);
    output.set_counts(counter.expected(*settings_.stop.samples_per_pixel));
    for (uint32_t y = 0; y < image.height; y += strip_) {
      const PixelRect rect{image.x0, image.y0 + y, image.width, std::min(strip_, image.height - y)};
      if (stop_) {
        left_out_ = true;
        output.write_missing(rect);
        counter.add_missing();
        continue;
      }
      SpectralFilm film(rect, options);
      passes_.render(film);
      film.add_image_sums(image_sums_, image_counts_);
      counter.add(film);
      write(film, output);
    }
    output.set_counts(counter.counts());
    finish(output);
  }

  void write(const SpectralFilm& film, CubeOutput& output) {
    const auto writing = Clock::now();
    const PixelRect& rect = film.rect();
    for (uint32_t y = 0; y < rect.height; y += output.rows_at_once()) {
      const uint32_t rows = std::min(output.rows_at_once(), rect.height - y);
      std::vector<AuxiliaryPixel> auxiliary;
      if (!settings_.aux.empty()) auxiliary = backend_.auxiliary({rect.x0, rect.y0 + y, rect.width, rows});
      output.write(film, y, rows, auxiliary);
    }
    if (settings_.keep_replicates) output.write_replicates(film);
    report_.output_seconds += seconds_since(writing);
  }

  void finish_image_moments() {
    const ReplicateMoments moments = moments_of_sums(image_sums_, image_counts_);
    const std::vector<double> scale = backend_.film_scale();
    for (const std::size_t c : bands_.film_channels)
      report_.image_mean.push_back(moments.mean(0)[c] * scale[c]);
  }

  const FlatScene& scene_;
  Backend& backend_;
  const SessionSettings& settings_;
  const std::atomic<bool>& stop_;
  BandSelection bands_;
  std::size_t channels_;
  uint32_t replicates_, strip_ = 0;
  bool left_out_ = false;  // strips, of an interrupted render
  RenderReport report_;
  Passes passes_;
  std::vector<std::vector<double>> image_sums_;
  std::vector<uint64_t> image_counts_;
};

}  // namespace

uint32_t session_replicates(const SessionSettings& settings) {
  const auto& samples = settings.stop.samples_per_pixel;
  if (!samples || settings.replicates_fixed) return settings.replicates;
  return ReplicatePlan::deal(*samples, settings.replicates).replicates;
}

BandSelection select_bands(const FlatScene& scene, const ChannelList& derived) {
  BandSelection selection;
  const bool named_only =
      !scene.film.responses.empty();  // sub-channels of a specfilm's responses are not output
  for (std::size_t k = 0; k < scene.channels.size(); ++k) {
    if (named_only && scene.channels[k].name.empty()) continue;
    selection.bands.push_back({scene.channels[k], false});
    selection.film_channels.push_back(k);
  }
  for (std::size_t d = 0; d < derived.size(); ++d) {
    selection.bands.push_back({derived[d], true});
    selection.film_channels.push_back(scene.channels.size() + d);
  }
  return selection;
}

RenderReport run_session(const FlatScene& scene, const ChannelList& derived, Backend& backend,
                         const SessionSettings& settings, const std::atomic<bool>& stop,
                         const std::function<void(const Progress&)>& progress) {
  return Session(scene, derived, backend, settings, stop, progress).run();
}

}  // namespace kiloband
