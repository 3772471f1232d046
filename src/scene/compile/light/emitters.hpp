// Emitters to records, and how they are chosen. Internal to src/scene.
#pragma once

#include <memory>
#include <vector>

#include "scene/compile/material/thermal.hpp"
#include "scene/compile/texture/textures.hpp"

namespace kiloband {

class EmitterCompiler {
 public:
  EmitterCompiler(const CompileContext& context, TextureCompiler& textures, const ThermalCompiler& thermal);

  // shape_lights.cpp
  /// Of the last shape record.
  /// throws InputError  as TextureCompiler
  void add_area_emitter(const Shape& shape);
  /// A shape with a temperature of its own is a light for next-event estimation, on both sides.
  /// heat: of the last shape record
  void add_thermal_emitter(const Heat& heat);

  /// All without a shape. FlatScene::scene_radius is set.
  void add_emitters();
  /// Their probabilities, or the light tree.
  void select_emitters();

 private:
  /// The spectrum that stands for an emitter's colour and the factor that makes it a power (W/nm); mixtures
  /// have further terms.
  struct Power {
    Spectrum spectrum;
    double factor;
    WeightedSpectra more = {};
    std::vector<double> by_band = {};  // if not empty: power in each guide band (W) instead
  };
  static Power scaled_power(const WeightedSpectra& colour, double factor);
  static double band_power(const Power& power, const Channel& band);  // W

  void add(const KbEmitter& record, const std::string& name);
  KbEmitter make_emitter(const Emitter& emitter);
  void add_ambient_environment();
  void add_suns();
  std::vector<double> shares_by_power() const;
  void select_with_tree(std::vector<double> shares);
  // environments.cpp
  void add_environment_map(KbEmitter& record, const EnvmapEmitter& emitter, const SpectrumSource& use);
  void add_spectral_environment(KbEmitter& record, const SpectralEnvmapEmitter& emitter,
                                const SpectrumSource& use);
  // projected_lights.cpp
  void add_spot_picture(KbEmitter& record, const SpotEmitter& spot, double solid_angle,
                        const SpectrumSource& use);
  void add_projector(KbEmitter& record, const ProjectorEmitter& projector, const SpectrumSource& use);
  /// A picture times a spectrum, and what it emits if its mean is over `factor`.
  uint32_t picture(const Texture& texture, const Spectrum& light, double factor, const SpectrumSource& use);
  uint32_t bitmap_picture(const std::shared_ptr<const BitmapTexture>& texture, const Spectrum& light,
                          double factor, const SpectrumSource& use);
  uint32_t checkerboard_picture(const CheckerboardTexture& texture, const Spectrum& light, double factor,
                                const SpectrumSource& use);
  // tree_lights.cpp
  std::size_t tree_light_count() const;
  bool wants_light_tree() const;
  double add_light_tree(std::vector<double>& shares);

  const SceneDescription& in_;
  FlatScene& out_;
  SpectrumTableBuilder& spectra_;
  TextureCompiler& textures_;
  const ThermalCompiler& thermal_;
  std::vector<Power> powers_;  // per emitter
};

}  // namespace kiloband
