// Deferred evaluation of saved paths for all channels, SIMD over channels (DPEPT paper, section 5).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "scene/description/derived_channels.hpp"
#include "src_cpu/lanes/isa.hpp"
#include "src_cpu/path/path_buffer.hpp"

namespace kiloband::cpu {

/// Where the sums of a block's pixels stand: a row each.
struct SumRows {
  std::span<float* const> pixels;
  /// Rows of a film: derived channels follow the channels at once, and nothing behind them is touched. Else stride()
  /// floats, derived channels at derived_offset(), and padding receives zeros.
  bool packed = false;
};

/// Evaluates saved paths of one thread; owns scratch memory, so one per thread. `scene` must outlive it.
///
/// A path's product of reflectances, light and radiance stay in registers over all its vertices, for 4
/// vectors of channels at a time (64 channels with AVX-512); what the vertices refer to is resolved once per
/// path. Values are film units: channel k times 1 / channel_scale[k]. A channel's bits depend on the path, mu and the instruction
/// set, not on the other channels. Emission rows (SpectrumRow::is_emission, and illuminants of textures)
/// carry width_k / channel_scale_k; a textured emitter without an illuminant is taken to be
/// in W m^-2 sr^-1 nm^-1 as it is.
class Evaluator {
 public:
  /// throws DeviceError if the machine lacks `isa`; std::logic_error if channel_scale has not K entries
  Evaluator(const FlatScene& scene, const DerivedChannels& derived, Isa isa);
  ~Evaluator();
  Evaluator(Evaluator&&) noexcept;

  /// Floats per pixel in `sums`: channels and derived channels, each padded to 64, and an odd
  /// multiple of it: with a power of two the rows of a block's pixels would compete
  /// for a few sets of the caches.
  std::size_t stride() const;
  /// Where derived channel d stands in a pixel's row (channels stand at 0 .. K-1).
  std::size_t derived_offset() const;
  /// The film's unit of derived channel d in W m^-2 sr^-1: the largest channel_scale of the channels that its
  /// response covers (1 if none); what channel_scale is to a channel.
  double derived_scale(std::size_t d) const;

  /// Adds every path's channel values to its pixel's row, all paths at the wavelength offset
  /// mu (`shared`). mu in [0, 1].
  /// throws std::logic_error  a path refers to what the scene or `rows` does not have
  void add_shared(const PathBuffer& paths, double mu, const SumRows& rows);
  /// The same with an offset of its own for each path (`per-path`); mu has one entry per path.
  void add_per_path(const PathBuffer& paths, std::span<const float> mu, const SumRows& rows);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kiloband::cpu
