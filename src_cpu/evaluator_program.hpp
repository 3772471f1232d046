// Turns a saved path into steps with pointers into dense rows, once per path, for the kernels to run per
// channel block.
#pragma once

#include <span>
#include <vector>

#include "src_cpu/dense_spectra.hpp"
#include "src_cpu/path_buffer.hpp"

namespace kiloband {

class ProgramBuilder {
 public:
  explicit ProgramBuilder(const FlatScene& scene) : scene_(scene) {}

  /// The program of the path in `slots` at the offset of `spectra`; valid until the next call.
  /// throws std::logic_error if the path refers to what the scene does not have
  PathProgram build(std::span<const KbPathVertex> slots, DenseSpectra& spectra);

 private:
  void reserve(std::size_t slots);
  void add_vertex(const KbPathVertex& vertex, const KbTextureSample* samples, bool last,
                  DenseSpectra& spectra);
  void add_general(const KbPathVertex& vertex, const KbTextureSample* samples, DenseSpectra& spectra);
  void add_medium(const KbPathVertex& vertex, const KbPathVertex* extensions, DenseSpectra& spectra);
  void add_fresnel(GeneralVertex& out, uint32_t material, DenseSpectra& spectra) const;
  const TextureTerms* texture(const KbTextureSample& sample, bool emission, DenseSpectra& spectra);

  const FlatScene& scene_;
  std::vector<PathStep> steps_;
  std::vector<GeneralVertex> generals_;  // reserved: steps point into it
  std::vector<TextureTerms> textures_;   // reserved: generals point into it
  std::vector<KbPlumeCell> cells_;       // reserved: generals point into it
  bool textured_ = false, gas_ = false;
};

}  // namespace kiloband
