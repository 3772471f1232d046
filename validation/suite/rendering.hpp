// Scenes rendered by replicates, as the comparison core wants them.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "render/backend_registry.hpp"
#include "scene/compile/flat_scene.hpp"
#include "stats/comparison/replicate_image.hpp"

namespace kiloband::validation {

/// One way to compute an image.
struct Configuration {
  std::string backend = "cpu";  // or "opencl:dpept-batch", "opencl:dpept-path", "opencl:pt"
  WavelengthMode wavelengths = WavelengthMode::kShared;
  SamplerType sampler = SamplerType::kSobol;
  RoughDispersion rough_dispersion = RoughDispersion::kSpectralMis;
  bool specialised = true;  // OpenCL: kernels compiled for the scene; false: one program for all scenes

  /// "cpu shared sobol", with "degrade" behind it where rough dispersion degrades.
  std::string label() const;
};

struct CaseScene {
  std::filesystem::path file;
  std::vector<std::pair<std::string, std::string>> defines;
  std::string bands;               // empty: the scene's
  uint32_t width = 0, height = 0;  // 0: the scene's
};

/// throws InputError  the scene is wrong
std::shared_ptr<const FlatScene> load(const CaseScene& scene);

/// Replicates 0 .. replicates - 1, each of `samples` samples in every pixel.
struct Sampling {
  uint64_t seed = 0;
  uint32_t replicates = 32;
  uint32_t samples = 1;
};

struct Rendering {
  stats::ReplicateImage image;  // W m^-2 sr^-1, integrals over the channels
  double seconds = 0;           // of rendering, set-up left out
  uint64_t invalid_samples = 0;
  bool stopped = false;  // the image is incomplete
};

/// Whether a run goes on, and how far it is.
struct Watch {
  const std::atomic<bool>* stop = nullptr;
  std::function<void(double fraction)> progress;  // of one rendering; may be empty
  bool stopped() const { return stop && stop->load(); }
};

using kiloband::film_rect;

/// The means of a film's replicates, each channel times its scale.
stats::ReplicateImage image_of(const SpectralFilm& film, const PixelRect& rect, uint32_t replicates,
                               const std::vector<double>& scale);

/// `samples` of each replicate into the film, until the watch stops it.
void render_replicates(Backend& backend, SpectralFilm& film, uint32_t replicates, uint32_t samples,
                       const Watch& watch);

const BackendRegistry& backends();
/// "opencl": the method that the backend chooses. Throws what making the backend throws.
std::unique_ptr<Backend> make_backend(const Configuration& configuration,
                                      const std::shared_ptr<const FlatScene>& scene,
                                      const SamplingSettings& settings);

Rendering render(const std::shared_ptr<const FlatScene>& scene, const Configuration& configuration,
                 const Sampling& sampling, const Watch& watch);

}  // namespace kiloband::validation
