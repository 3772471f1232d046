// Turns a saved path into steps with pointers into dense rows, once per path,
// for the kernels to run per channel block.
#pragma once

#include <span>
#include <vector>

#include "src_cpu/evaluate/dense_spectra.hpp"
#include "src_cpu/evaluate/spectral_textures.hpp"
#include "src_cpu/evaluate/step_writer.hpp"
#include "src_cpu/geometry/texture/texel_corners.hpp"
#include "src_cpu/path/path_buffer.hpp"

namespace kiloband::cpu {

class ProgramBuilder {
 public:
  ProgramBuilder(const FlatScene& scene, const EvaluatorKernels& kernels)
      : scene_(scene), kernels_(kernels), spectral_(scene, kernels) {}

  /// The program of the path in `entries` at the offset of `spectra`; valid until the next call.
  /// throws std::logic_error if the path refers to what the scene does not have
  PathProgram build(std::span<const KbPathVertex> entries, DenseSpectra& spectra);
  /// Asks the caches for the texels of a path that will be built soon.
  void fetch_texels(std::span<const KbPathVertex> entries) const;

 private:
  /// The spectral factors that a vertex uses, as dense rows; null: not used.
  struct Factors {
    const float *a, *b, *emit, *nee;
  };

  void reserve(std::size_t entries);
  void grow(std::size_t entries);
  Factors factors(const KbPathVertex& vertex, const KbTextureSample* samples, DenseSpectra& spectra);
  void add_vertex(const KbPathVertex& vertex, const Factors& from, bool last, DenseSpectra& spectra);
  std::size_t add_plain(std::span<const KbPathVertex> entries, std::size_t first, DenseSpectra& spectra);
  GeneralVertex& new_general();
  void add_general(const KbPathVertex& vertex, const Factors& from, DenseSpectra& spectra);
  void add_medium(const KbPathVertex& vertex, const KbPathVertex* extensions, DenseSpectra& spectra);
  void add_fresnel(GeneralVertex& out, const KbPathVertex& vertex, DenseSpectra& spectra);
  void add_transmission(GeneralVertex& out, const KbPathVertex& vertex, DenseSpectra& spectra);
  const float* texture(const KbTextureSample& sample, bool emission, DenseSpectra& spectra);
  const float* thermal(const KbThermalSample& sample, DenseSpectra& spectra);
  void colour(uint32_t texture, const TexelCorners& corners, const float* factor, DenseSpectra& spectra,
              float* out) const;
  float* scratch_row(const DenseSpectra& spectra);

  const FlatScene& scene_;
  const EvaluatorKernels& kernels_;
  // Of the path at hand; these arrays have room for all that its entries can need, and others point into them.
  std::vector<PathStep> steps_;
  std::vector<GeneralVertex> generals_;
  std::size_t general_count_ = 0;
  StepWriter writer_;
  std::vector<FresnelTerms> fresnels_;
  std::vector<TransmissionTerms> transmissions_;
  SpectralTextures spectral_;
  std::vector<hwy::AlignedFreeUniquePtr<float[]>>
      scratch_;  // rows of this path; the first scratch_used_ are taken
  std::size_t scratch_used_ = 0;
  std::vector<KbPlumeCell> cells_;  // reserved: generals point into it
  bool gas_ = false;
  static constexpr std::size_t kAll = std::size_t(-1);
  std::size_t survivor_ = kAll;  // the only channel that the path still has
};

}  // namespace kiloband::cpu
