// What is timed: a scene on a backend, made ready.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "film/spectral_film.hpp"
#include "stats/comparison/replicate_image.hpp"
#include "validation/speed/bench.hpp"

namespace kiloband::speed {

/// A scene of the cases. Everything is rendered from first_nm to last_nm in equal channels.
struct SceneFile {
  std::string name;  // "cornell_box"
  std::filesystem::path file;
  double first_nm = 400, last_nm = 700;
  std::vector<std::pair<std::string, std::string>> defines;
};

/// The repository's, and with settings.data public ones; cornell_box first.
std::vector<SceneFile> bench_scenes(const Settings& settings);
/// One of them.
SceneFile bench_scene(const Settings& settings, const std::string& name);

/// Pixels of a side of images whose rates are measured, so that every contender has enough to do: a GPU has a million paths in flight.
/// With many channels fewer: films stay below 1 GiB.
uint32_t image_side(bool gpu, bool quick, uint32_t channels);
/// The same for whoever takes part in the run.
uint32_t image_side(const Bench& bench, uint32_t channels);

/// "400:700:64"; first, count: of the channels [first, first + count) of `channels` alone
std::string bands_text(const SceneFile& scene, uint32_t channels);
std::string bands_text(const SceneFile& scene, uint32_t channels, uint32_t first, uint32_t count);

/// setup.channels, width, height and depth are looked at. bands: empty for all channels
std::shared_ptr<const FlatScene> load(const SceneFile& scene, const Setup& setup,
                                      const std::string& bands = {});

/// The backend that the setup names. replicates: how many independently randomised ones there will be
struct Subject {
  std::shared_ptr<const FlatScene> scene;
  std::unique_ptr<Backend> backend;
};
/// throws DeviceError, DeviceOutOfMemory
Subject make_subject(const Settings& settings, const Setup& setup, std::shared_ptr<const FlatScene> scene,
                     uint32_t replicates, uint64_t seed);

/// The command that renders setup's image. extra: options that no setup has
std::string render_command(const Settings& settings, const SceneFile& scene, const Setup& setup,
                           uint64_t seed, const std::string& extra = {});
/// The command that repeats a case: `kiloband bench CASE ...`.
std::string bench_command(const Settings& settings, const std::string& name);

/// Seconds of `samples` of every pixel, in one replicate, without variances.
double time_samples(Subject& subject, uint32_t samples, const Watch& watch);
/// Seconds of `frames` samples of every pixel, one at a time into a film that goes on, as a viewer asks for them.
double time_frames(Subject& subject, uint32_t frames, const Watch& watch);
/// Samples per pixel that take about `seconds`, of at most `most`. Renders: what compiles kernels is done then.
uint32_t samples_for(Subject& subject, double seconds, uint32_t most, const Watch& watch);

/// Images of independently randomised repetitions.
struct Repetitions {
  uint32_t width = 0, height = 0;
  std::size_t channels = 0;
  std::vector<std::vector<float>> images;  // [repetition][pixel][channel]
  std::vector<double> seconds;             // of each
};

/// `count` images of setup.samples per pixel, each of setup.replicates replicates; the subject was made for all of
/// them together. What was not finished when the watch stopped is left out.
Repetitions repeat(Subject& subject, const Setup& setup, uint32_t count, const Watch& watch);

/// settings.backends, cut at the colon.
struct BackendName {
  std::string backend, method;
};
std::vector<BackendName> bench_backends(const Settings& settings);

}  // namespace kiloband::speed
