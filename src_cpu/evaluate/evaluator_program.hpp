// Turns a saved path into steps with pointers into dense rows, once per path,
// for the kernels to run per channel block.
#pragma once

#include <span>
#include <vector>

#include "src_cpu/evaluate/dense_spectra.hpp"
#include "src_cpu/evaluate/step_writer.hpp"
#include "src_cpu/evaluate/texture/colour_lookups.hpp"
#include "src_cpu/evaluate/texture/spectral_textures.hpp"
#include "src_cpu/path/path_buffer.hpp"

namespace kiloband::cpu {

class ProgramBuilder {
 public:
  /// factors: the kernels that make factors of vertices.
  ProgramBuilder(const FlatScene& scene, const EvaluatorKernels& kernels, const EvaluatorKernels& factors)
      : scene_(scene),
        factors_(factors),
        spectral_(scene, kernels),
        colours_(scene, kernels),
        scratch_(scene.channels.size()) {}

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
  Factors factors(const KbPathVertex& vertex, const KbTextureSample* samples, DenseSpectra& spectra);
  void add_vertex(const KbPathVertex& vertex, Factors from, bool last, DenseSpectra& spectra);
  std::size_t add_plain(std::span<const KbPathVertex> entries, std::size_t first, DenseSpectra& spectra);
  void add_medium(const KbPathVertex& vertex, const KbPathVertex* extensions, DenseSpectra& spectra);
  void add_deferred_light(const float* row, float weight, const float* light);
  /// B(w0, w1) of path_vertex.h: weight times row.
  struct Product {
    const float* row;
    float weight;
  };
  Product product(const KbPathVertex& vertex, const Factors& from, float w0, float w1, DenseSpectra& spectra);
  const float* reflectance(const KbPathVertex& vertex, const float* a, float cosine, DenseSpectra& spectra);
  const float* transmission(const KbPathVertex& vertex, const float* a, DenseSpectra& spectra);
  const float* blend(const Factors& from, float w0, float w1, const DenseSpectra& spectra);
  const KbMaterial& material_of(const KbPathVertex& vertex) const;
  const float* texture(const KbTextureSample& sample, bool emission, DenseSpectra& spectra);
  const float* thermal(const KbThermalSample& sample, DenseSpectra& spectra);
  ChannelRange needed(const DenseSpectra& spectra) const;

  const FlatScene& scene_;
  const EvaluatorKernels& factors_;
  // Of the path at hand; steps, gas and cells have room for all that its entries can need, and others point into them.
  std::vector<PathStep> steps_;
  StepWriter writer_;
  SpectralTextures spectral_;
  ColourLookups colours_;
  RowPool scratch_;  // rows of this path
  std::vector<GasVertex> gas_;
  std::vector<KbPlumeCell> cells_;
  static constexpr std::size_t kAll = std::size_t(-1);
  std::size_t survivor_ = kAll;  // the only channel that the path still has
};

}  // namespace kiloband::cpu
