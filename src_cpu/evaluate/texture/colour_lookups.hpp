// Lookups in textures of colours as dense rows, so that the fast steps of evaluation can use them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "src_cpu/evaluate/dense_spectra.hpp"
#include "src_cpu/evaluate/texture/texel_corners.hpp"

namespace kiloband::cpu {

/// The channels that rows of a path need.
struct ChannelRange {
  std::size_t begin, end;
  bool one_group;  // the group of the channel that the path has kept: blocks of others have ended
};

/// A lookup blends the spectra of its four texels. Where a texture has few colours (up to a factor), each is a spectrum like others: its row is
/// made when it is first asked for and serves all lookups at a wavelength offset. Others are evaluated four at once, see ColourTerms.
class ColourLookups {
 public:
  /// Colours that have rows, of all textures together: at 512 channels 2 MiB a thread (twice that if all reflect and emit).
  static constexpr std::size_t kMostRows = 1024;
  /// Texels of a texture whose colours are looked at: 256 KiB a thread.
  static constexpr std::size_t kMostTexels = 65536;

  ColourLookups(const FlatScene& scene, const EvaluatorKernels& kernels);

  bool has_rows(uint32_t texture) const { return first_[texture] != kNone; }
  /// The lookup at the offset of `spectra` times `factor` (null: 1) for these channels, in `out` or a row that lives until the next offset.
  /// factor: of a texture always the same, or null
  const float* row(uint32_t texture, const TexelCorners& corners, const float* factor, DenseSpectra& spectra,
                   ChannelRange range, float* out);
  /// The same from its terms. Any factor; it may be `out`.
  void evaluate(uint32_t texture, const TexelCorners& corners, const float* factor, DenseSpectra& spectra,
                ChannelRange range, float* out) const;

 private:
  static constexpr std::size_t kNone = std::size_t(-1);
  struct Row {
    uint64_t generation = 0;
    const float* data = nullptr;
  };

  const float* colour_row(std::size_t number, const float* factor, DenseSpectra& spectra);

  const FlatScene& scene_;
  const EvaluatorKernels& kernels_;
  std::vector<std::size_t> first_;  // by texture: of its texels in row_of_; kNone: it has no rows
  std::vector<uint32_t> row_of_;    // by texel
  std::vector<KbFloat4> colours_;   // by row; a texture's own
  std::vector<Row> rows_;           // without, then with factor
  uint64_t generation_ = 0;
  RowPool pool_;
};

}  // namespace kiloband::cpu
