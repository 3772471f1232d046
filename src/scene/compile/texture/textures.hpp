// Textures to records and texels. Internal to src/scene.
#pragma once

#include <map>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "scene/compile/compile_context.hpp"

namespace kiloband {

/// What a bitmap's values stand for; one image used in two ways is compiled twice. An environment's are emission that its compiler
/// scales: nobody else may have them.
enum class BitmapUse {
  kReflectance,
  kEmission,
  kEnvironment,
  kPicture,
  kOpacity,
  kRoughness,
  kHeight,
  kNormals
};

/// A sum of spectra.
using WeightedSpectra = std::vector<std::pair<Spectrum, double>>;

/// The largest values that textures emit, which the scales of channels depend on.
struct EmissionPeaks {
  double raw = 0, rgb = 0;                 // largest texel scale of emitting bitmaps
  uint32_t rgb_row = KB_NONE;              // D65, which those of colours are multiplied by
  std::vector<Spectrum> spectra;           // the largest value of spectral textures that emit
  std::map<uint32_t, double> row_factors;  // largest weight of rows that are endmembers
};

/// The texels of an image as what they are used for; textures that differ in all else share them.
struct TexelBlock {
  uint32_t first_texel = 0, first_bound = 0;
  double mean = 0, bound = 0, peak = 0;  // of the values, of the texels' bounds, of their scales
};

/// Textures that several users share are compiled once.
class TextureCompiler {
 public:
  explicit TextureCompiler(const CompileContext& context);

  /// KB_REF_* of a reflectance, or of what emits.
  /// throws InputError  as for all of the following: what the channels or 32-bit indices cannot take
  uint32_t reference(const Texture& texture, const SpectrumSource& use);
  /// Index of a record, as of the others here. height: that a value of 1 stands for (kHeight)
  uint32_t bitmap(const std::shared_ptr<const BitmapTexture>& texture, BitmapUse use, float height = 1);
  /// share: an opacity or a weight, which of a colour is the luminance
  uint32_t mesh_attribute(const std::shared_ptr<const MeshAttributeTexture>& texture,
                          const SpectrumSource& use, bool share = false);
  uint32_t spectral_bitmap(const std::shared_ptr<const SpectralBitmapTexture>& texture,
                           const SpectrumSource& use);
  /// One of its own. scale: of its values
  uint32_t add_spectral_texture(const SpectralBitmapTexture& texture, const SpectrumSource& use,
                                double scale);
  /// A record of texels that exist.
  uint32_t add_record(const KbTexture& record, double mean, double bound);

  double mean(const Texture& texture);   // over the guide bands; a bitmap's by its texels' values
  double bound(const Texture& texture);  // over guide bands and channels
  double mean_of(uint32_t index) const { return means_[index]; }
  double bound_of(uint32_t index) const { return bounds_[index]; }
  /// Of a spectral texture: its mean.
  const WeightedSpectra& colour_of(uint32_t index) const { return colours_.at(index); }

  EmissionPeaks& peaks() { return peaks_; }
  const EmissionPeaks& peaks() const { return peaks_; }

 private:
  uint32_t checkerboard(const std::shared_ptr<const CheckerboardTexture>& texture, const SpectrumSource& use);
  uint32_t texels_of(const Texture& texture);  // the record of one that has texels, as a reflectance
  uint32_t d65_row();
  const TexelBlock& texels(const BitmapTexture& texture, BitmapUse use, float height);
  static KbFloat4 texel_of(const float* rgb, BitmapUse use, float height);
  float texel_bound(const KbFloat4& texel) const;
  // attributes.cpp
  static std::vector<KbFloat4> attribute_texels(const std::vector<const std::vector<float>*>& parts,
                                                double unit, bool share);
  void finish_attribute(KbTexture record, std::size_t count, bool emits);
  // spectral_textures.cpp
  void add_bands(KbTexture& record, const SpectralBitmapTexture& texture, const SpectrumSource& use,
                 double scale);
  void add_weights(KbTexture& record, const SpectralBitmapTexture& texture, const SpectrumSource& use);
  uint32_t first_value_unit(const SpectralImage& image, const SourcePosition& position);

  FlatScene& out_;
  SpectrumTableBuilder& spectra_;
  CurrentMesh& current_;
  // Keys hold what they name: another texture must not get its address.
  std::map<std::tuple<std::shared_ptr<const BitmapTexture>, BitmapUse, float>, uint32_t> bitmaps_;
  std::map<std::tuple<std::shared_ptr<const Image>, BitmapUse, float, bool>, TexelBlock>
      blocks_;                                                                      // bool: raw
  std::map<std::tuple<const void*, const void*, BitmapUse>, uint32_t> attributes_;  // by texture and mesh
  std::map<std::pair<const void*, bool>, uint32_t> checkerboards_;     // by texture and whether it emits
  std::map<std::pair<const void*, bool>, uint32_t> spectral_bitmaps_;  // the same
  std::vector<double> means_, bounds_;           // per record: mean value, largest texel bound
  std::map<uint32_t, WeightedSpectra> colours_;  // of spectral textures: their mean
  uint64_t value_units_ = 0;                     // of spectral texels, see KbTexture::first_value
  EmissionPeaks peaks_;
};

/// KbTexture::first_texel of a bitmap of `count` texels after `before` others.
/// name  the bitmap's, for messages
/// throws InputError  the last texel's index does not fit into 32 bits
uint32_t first_texel_index(std::size_t before, std::size_t count, const SourcePosition& position,
                           const std::string& name);

/// The number that a colour is where one is wanted: Rec. 709 with D65's white, as Mitsuba's.
float luminance_of(const float* rgb);

/// Row-major 2x3.
void store_uv_transform(const glm::dmat3& to_uv, float (&out)[6]);

}  // namespace kiloband
