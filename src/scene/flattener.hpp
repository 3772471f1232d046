// The steps of flattening; see flatten.cpp for their order. Internal to src/scene.
#pragma once

#include <map>
#include <memory>

#include "scene/flat_scene.hpp"
#include "scene/spectrum_table_builder.hpp"

namespace kiloband {

/// Turns a SceneDescription into the arrays of a FlatScene. Shared BSDFs and textures are flattened once.
class Flattener {
 public:
  Flattener(const SceneDescription& description, const FlattenOptions& options);
  FlatScene run();

 private:
  // flatten_textures.cpp
  uint32_t reference(const Texture& texture, const SpectrumSource& use);
  /// What a bitmap's values stand for; one image used in two ways is flattened twice.
  enum class BitmapUse { kReflectance, kEmission, kOpacity };
  uint32_t bitmap(const std::shared_ptr<const BitmapTexture>& texture, BitmapUse use);
  float texel_bound(const KbFloat4& texel) const;
  uint32_t checkerboard(const std::shared_ptr<const CheckerboardTexture>& texture, const SpectrumSource& use);
  double texture_mean(const Texture& texture);   // over the guide bands; a bitmap's by its texels' values
  double texture_bound(const Texture& texture);  // over guide bands and channels
  uint32_t d65_row();

  // flatten_materials.cpp
  uint32_t surface(const std::shared_ptr<const Bsdf>& bsdf);
  uint32_t material(const std::shared_ptr<const Bsdf>& bsdf);
  KbMaterial make(const DiffuseBsdf& model, const std::string& name, const SourcePosition& position);
  KbMaterial make(const ConductorBsdf& model, const std::string& name, const SourcePosition& position);
  KbMaterial make(const DielectricBsdf& model, const std::string& name, const SourcePosition& position);
  KbMaterial make(const PlasticBsdf& model, const std::string& name, const SourcePosition& position);
  void set_opacity(KbSurface& record, const MaskBsdf& mask, const SpectrumSource& use);

  // flatten_shapes.cpp
  void add_shapes();
  void add_mesh(KbShape& record, const Shape& shape, const Mesh& mesh);
  void add_areas(KbShape& record, const Shape& shape);
  void compute_bounds();

  // flatten_media.cpp
  void add_media();
  uint32_t medium(const std::shared_ptr<const Medium>& medium);
  uint32_t add_medium(const KbMedium& record, const std::string& name, const SourcePosition& position);
  uint32_t interior(uint32_t shape_index);
  void set_grid(KbMedium& record, const GridField& grid);
  void set_jet(KbMedium& record, const JetField& jet);
  void set_ladder(KbMedium& record) const;

  // flatten_emitters.cpp
  void add_emitters();
  void add_area_emitter(uint32_t shape_index);
  void add_environment_map(KbEmitter& record, const EnvmapEmitter& emitter, const SpectrumSource& use);
  KbEmitter make_emitter(const Emitter& emitter);
  void select_emitters();
  void set_channel_scales();

  // flatten_camera.cpp
  void set_camera();

  const SceneDescription& in_;
  const FlattenOptions& options_;
  FlatScene out_;
  SpectrumTableBuilder spectra_;
  std::map<const void*, uint32_t> surfaces_, materials_, checkerboards_, media_;
  std::map<std::pair<const void*, BitmapUse>, uint32_t> bitmaps_;
  uint32_t d65_row_ = KB_NONE;
  /// Per emitter: the spectrum that stands for its colour and the factor that makes it a power (W/nm).
  struct EmitterPower {
    Spectrum spectrum;
    double factor;
  };
  std::vector<EmitterPower> powers_;
  std::vector<double> texture_means_, texture_bounds_;    // per bitmap: mean value, largest texel bound
  double raw_emission_peak_ = 0, rgb_emission_peak_ = 0;  // largest texel scale of emitting bitmaps
};

/// KbTexture::first_texel of a bitmap of `count` texels after `before` others. name is the bitmap's, for the
/// message. throws InputError  the last texel's index does not fit into 32 bits
uint32_t first_texel_index(std::size_t before, std::size_t count, const SourcePosition& position,
                           const std::string& name);

/// Row-major 3x4 of an affine transform.
void store_transform(const Transform& transform, float (&out)[12]);

}  // namespace kiloband
