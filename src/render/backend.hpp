// Backend: adds samples of a flattened scene to a film. Everything above knows no backend.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/diagnostics.hpp"
#include "film/spectral_film.hpp"
#include "film/statistics.hpp"
#include "render/traced_path.hpp"
#include "scene/compile/flat_scene.hpp"

namespace kiloband {

enum class WavelengthMode { kShared, kPerPath };
enum class SamplerType { kIndependent, kSobol };
/// How directions are sampled at rough boundaries whose index depends on wavelength: for several channels at
/// once, or for one that goes on alone (what smooth boundaries always do).
enum class RoughDispersion { kSpectralMis, kDegrade };

/// What defines the random numbers of a render;
/// equal settings give equal bits on a device and instruction set.
struct SamplingSettings {
  WavelengthMode wavelengths = WavelengthMode::kShared;
  SamplerType sampler = SamplerType::kSobol;
  uint64_t seed = 0;
  uint32_t replicates = 16;
  RoughDispersion rough_dispersion = RoughDispersion::kSpectralMis;
};

/// Samples first .. first + count - 1 of one replicate, in every pixel. Sample i of replicate r of R is the
/// pixel's sample number r + i R.
struct SampleRange {
  uint32_t replicate = 0;
  uint32_t first = 0;
  uint32_t count = 0;
};

/// A sample whose value was NaN or infinite; it left the mean.
struct InvalidSample {
  uint32_t x, y, sample;
};

/// What computes, and how.
struct BackendInfo {
  std::string name;                    // "cpu", "opencl"
  std::string device;                  // processor or device name
  std::string isa;                     // instruction set, or driver
  std::string method = "dpept-batch";  // how paths are evaluated: "dpept-batch", "dpept-path" or "pt"
};

/// What one of several devices has done.
struct DeviceShare {
  std::string backend, device;
  uint64_t paths = 0;
  double busy_seconds = 0;  // in which it rendered
  std::string failure;      // why it was left out; empty: it was not
};

/// What a backend has done over its life; each fills it as far as it can.
struct BackendStatistics {
  uint64_t paths = 0, vertices = 0, rays = 0, invalid_samples = 0;
  std::vector<InvalidSample> first_invalid;         // at most 16
  std::map<std::string, double> kernel_seconds;     // on the device, by kernel
  std::map<std::string, uint64_t> kernel_launches;  // how many took these seconds
  uint64_t device_memory_bytes = 0;                 // peak, beside the host's
  uint32_t pool_slots = 0;            // paths in flight that the device has room for, as it last rendered
  double longest_launch_seconds = 0;  // of a kernel, measured on the device: display drivers kill long ones
  uint64_t device_rounds = 0, device_waits = 0;  // rounds of paths; how often the host waited for the device
  uint32_t device_losses = 0;                    // how often the device was lost and set up again
  std::vector<DeviceShare> devices;              // of a backend of several
};

/// Auxiliary values of one pixel, from the ray through its centre.
struct AuxiliaryPixel {
  float depth = 0;           // m along the ray; 0 where nothing is hit
  KbFloat3 normal{0, 0, 0};  // shading normal, world
  float object = -1;         // shape index, -1: nothing
  float material = -1;       // material index of the side that is seen
};

/// The rectangle that is rendered of the full film: its crop window.
inline PixelRect film_rect(const Film& film) {
  return {film.crop_x, film.crop_y, film.crop_width, film.crop_height};
}
inline PixelRect film_rect(const FlatScene& scene) {
  return film_rect(scene.film);
}

class Backend {
 public:
  virtual ~Backend() = default;

  /// Renders the range in the film's blocks `blocks` and adds them; a film that keeps sums must be of this
  /// backend's sum_rule() and have range.first samples of the replicate there. Returns early when stop
  /// becomes true: samples in flight are finished and delivered. `progress` is called now and then, from one
  /// thread at a time, with the pixel samples done; it must not use relative names of files.
  /// throws DeviceError  the device has failed: every block has all of its samples of the range, or none
  virtual void render(SpectralFilm& film, const SampleRange& range, const std::vector<uint32_t>& blocks,
                      const std::atomic<bool>& stop, const std::function<void(uint64_t)>& progress) = 0;
  /// Renders whole replicates of all blocks of a folded film that has nothing yet, the first ones of the plan in their order, where this
  /// is sooner done than by render() of each. The film is the same as after these and finish_replicates(); of a replicate in
  /// which stop becomes true, it has the samples that there are.
  /// returns how many there are: at most all, 0 where there is no such way, or not enough memory for it
  virtual uint32_t render_replicates(SpectralFilm& /*film*/, const ReplicatePlan& /*plan*/,
                                     const std::atomic<bool>& /*stop*/,
                                     const std::function<void(uint64_t)>& /*progress*/) {
    return 0;
  }
  /// [y][x] of the rectangle.
  virtual std::vector<AuxiliaryPixel> auxiliary(const PixelRect& rect) = 0;

  /// The paths of one sample of every pixel of `rect`, [y][x], normalised (traced_path.hpp). rect lies in one
  /// block of 32 x 32 pixels; range.count is 1.
  virtual std::vector<TracedPath> trace(const PixelRect& rect, const SampleRange& range) = 0;

  /// The scene's camera was moved (move_camera() in scene/compile), between two renders: what follows has the bits of a backend that is
  /// made for the scene as it is now.
  virtual void camera_moved() = 0;

  virtual BackendInfo info() const = 0;
  virtual BackendStatistics statistics() const = 0;
  /// Factors that turn film values of all channels, derived ones included, into W m^-2 sr^-1.
  virtual std::vector<double> film_scale() const = 0;
  /// How samples are added; follows from scene, settings and device alone.
  virtual SumRule sum_rule() const = 0;
  /// Blocks that keep all of the backend busy where each gets so many samples; with fewer a part of it idles.
  virtual uint32_t blocks_at_once(uint32_t samples) const = 0;
};

}  // namespace kiloband
