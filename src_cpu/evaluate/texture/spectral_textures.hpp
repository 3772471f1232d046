// Lookups of spectral textures as dense rows, so that the fast steps of evaluation can use them.
#pragma once

#include <vector>

#include "src_cpu/evaluate/dense_spectra.hpp"

namespace kiloband::cpu {

/// A lookup blends the values of its four texels once per vertex. Bands: those of the M values that the
/// channels meet are blended, and then
/// interpolated at every channel's wavelength, whose place between the band centres is found once per offset
/// mu. Weights: the P blended weights sum the dense rows of the endmembers.
class SpectralTextures {
 public:
  SpectralTextures(const FlatScene& scene, const EvaluatorKernels& kernels);

  /// The lookup at the offset of `spectra` in `out`, padded; emission in film units, as DenseSpectra has it.
  void fill(const KbTextureSample& sample, DenseSpectra& spectra, float* out);

 private:
  /// Where the channels lie between the centres of a band set.
  struct BandRows {
    uint64_t generation = 0;
    std::vector<uint32_t> lowest, highest;  // index at the channel's ends
    std::size_t begin = 0, end = 0;         // bands that any channel can meet
    std::vector<double> inverse_gap;        // 1 / (distance of centre i + 1 from i), nm^-1
    hwy::AlignedFreeUniquePtr<int32_t[]> index;
    hwy::AlignedFreeUniquePtr<float[]> first, second;  // weights of values index and index + 1
  };

  BandRows make_rows(const BandSet& set) const;
  const BandRows& band_rows(uint32_t set, const DenseSpectra& spectra);
  void blend(const KbTexture& texture, uint32_t index, const KbTextureSample& sample);

  const FlatScene& scene_;
  const EvaluatorKernels& kernels_;
  std::vector<BandRows> rows_;  // by band set
  std::vector<float> blended_;  // of the lookup at hand, and one more: the neighbour of the last band
  std::vector<const float*> members_;
};

}  // namespace kiloband::cpu
