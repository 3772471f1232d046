// A render session: deals samples to replicates and passes, keeps within memory, writes the outputs.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.hpp"
#include "cube/cube_io.hpp"
#include "render/backend.hpp"
#include "render/error_sums.hpp"

namespace kiloband {

/// When a render stops: at the first that is reached of those that are set, at least one.
struct StopRule {
  std::optional<uint64_t> samples_per_pixel;
  std::optional<double> seconds;
  std::optional<double> relative_error;  // of the worst band: BandErrors::worst

  /// The number of samples is known before: every replicate is rendered to its end before the next. Otherwise
  /// passes come back to all replicates.
  bool is_fixed() const { return !seconds && !relative_error; }
};

/// What ended a render.
enum class StopReason {
  kSamples,
  kTime,
  kError,
  kDark,      // a target error, and nothing but darkness after 1024 samples per pixel
  kInterrupt  // the caller
};

struct SessionSettings {
  StopRule stop;
  uint32_t replicates = 16;       // wanted; fewer where there are not 2 samples for each
  bool replicates_fixed = false;  // those of the checkpoint that is gone on with: never fewer
  bool variance = false;
  bool keep_replicates = false;
  std::vector<std::filesystem::path> outputs;
  std::optional<Quantity> quantity;              // default: EXR density, ENVI integral
  std::optional<std::filesystem::path> preview;  // PNG
  std::vector<std::string> aux;                  // depth, normal, object, material
  std::map<std::string, std::string> metadata;
  DiagnosticSink sink;  // receives warnings
  /// Saved now and then and at the end, over what is there;
  /// that this is wanted is up to check_checkpoint_file().
  std::optional<std::filesystem::path> checkpoint;
  double checkpoint_interval_seconds = 60;
  bool resume = false;       // go on from the checkpoint if it exists
  uint64_t fingerprint = 0;  // render_fingerprint(), for checkpoints
  std::size_t memory_budget_bytes = std::size_t{1}
                                    << 30;  // for the film; beyond it strips of rows are streamed
};

/// How far a render is. error is the last known BandErrors::worst.
struct Progress {
  double fraction = 0;  // of the work, by the rule that is nearest to its end (time rule: of the time)
  uint64_t pixel_samples = 0;
  double seconds = 0;
  double rate = 0;  // pixel samples per second, those of a checkpoint not counted
  std::optional<double> error;
};

struct RenderReport {
  uint64_t samples_per_pixel = 0;  // smallest over pixels
  uint64_t largest_samples_per_pixel = 0;
  uint32_t replicates = 0;
  double sampling_seconds = 0, output_seconds = 0;
  std::vector<Band> bands;  // of the output
  /// Of these bands; needs two replicates, and variance or a target error.
  BandErrors errors;
  StopReason ended_by = StopReason::kSamples;
  uint64_t pixels_without_sample = 0;
  uint64_t underflowed_values = 0;  // positive in the film, 0 as the file's float
  uint64_t underflowed_variances = 0;
  /// Means (of replicates too) that are infinite or NaN, their pixel having samples.
  uint64_t overflowed_values = 0;
  uint64_t overflowed_variances = 0;
  uint64_t resumed_samples = 0;  // pixel samples that came from a checkpoint
  bool interrupted = false;
  bool streamed = false;  // strips, since the film did not fit the budget
  std::vector<std::filesystem::path> written;
  /// The image's mean per output band, W m^-2 sr^-1.
  std::vector<double> image_mean;
};

/// The bands of the output: every rendered channel, or the named ones and the derived if the film is a
/// specfilm with responses.
struct BandSelection {
  std::vector<Band> bands;
  std::vector<std::size_t> film_channels;  // per band, index into the film's channels
};
BandSelection select_bands(const FlatScene& scene, const ChannelList& derived);

/// Renders and writes.
/// derived  DerivedChannels::bands
/// backend  made with the session_replicates() that the stop rule leaves (SamplingSettings::replicates)
/// throws InputError, DeviceError; nothing half written is left under the final names
RenderReport run_session(const FlatScene& scene, const ChannelList& derived, Backend& backend,
                         const SessionSettings& settings, const std::atomic<bool>& stop,
                         const std::function<void(const Progress&)>& progress);

/// The replicates that a session will use, to be given to the backend's SamplingSettings.
uint32_t session_replicates(const SessionSettings& settings);

/// Long replicates are rendered a few samples at a time over the image (or strip), so that an interrupted
/// render is even: FilmOptions::sums.
bool replicates_in_parts(uint64_t samples_per_pixel, uint32_t replicates);

}  // namespace kiloband
