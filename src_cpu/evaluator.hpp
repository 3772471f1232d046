// Deferred evaluation of saved paths for all channels, SIMD over channels (paper section 5, algorithm 1).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "scene/flat_scene.hpp"
#include "src_cpu/path_buffer.hpp"

namespace kiloband {

enum class Isa { kAuto, kSse4, kAvx2, kAvx512 };
const char* to_string(Isa isa);
/// The best instruction set of this machine that the program has code for; throws DeviceError if `wanted` is not available.
Isa resolve_isa(Isa wanted);

/// Derived channels: row d weights channel values, response(lambda_k) / number of channels that cover lambda_k.
struct DerivedChannels {
  std::vector<std::string> names;
  std::vector<RegularTable> responses;
};

/// Dense spectra of one wavelength offset mu: row s of `rows` holds spectrum s at lambda_k = (1 - mu) min_k + mu max_k
/// for every channel, padded with zeros to `stride` floats (a multiple of kChannelPadding; rows are 64-byte aligned).
/// Emission rows hold radiance * width_k / channel_scale_k, so that path sums are channel values in film units.
struct DenseSpectra;

/// Evaluates saved paths of one thread; owns scratch memory, so one per thread.
class Evaluator {
 public:
  static constexpr std::size_t kChannelPadding = 64;

  Evaluator(const FlatScene& scene, const DerivedChannels& derived, Isa isa);
  ~Evaluator();
  Evaluator(Evaluator&&) noexcept;

  /// Floats per pixel in `sums`: channels and derived channels, padded.
  std::size_t stride() const;
  /// Where derived channel d stands in a pixel's row (channels stand at 0 .. K-1).
  std::size_t derived_offset() const;

  /// Adds every path's channel values to sums[path.pixel * stride() + k], all paths at the wavelength offset mu (`shared`).
  void add_shared(const PathBuffer& paths, double mu, std::span<float> sums);
  /// The same with an offset of its own for each path (`per-path`); mu has one entry per path.
  void add_per_path(const PathBuffer& paths, std::span<const float> mu, std::span<float> sums);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The oracle: one path, one wavelength offset, scalar double precision, as plain as it can be. Returns K channel values
/// followed by the derived ones, in W m^-2 sr^-1 (channel_scale undone).
std::vector<double> evaluate_path_reference(const FlatScene& scene, const DerivedChannels& derived,
                                            const PathBuffer& paths, std::size_t path, double mu);

}  // namespace kiloband
