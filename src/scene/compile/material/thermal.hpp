// Temperatures of shapes, and what their surfaces emit by Kirchhoff's law. Internal to src/scene.
#pragma once

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "scene/compile/material/materials.hpp"

namespace kiloband {

/// A temperature: of shapes that have the same, number or field.
struct Heat {
  double temperature_k = 0;  // of a field the largest
  uint32_t field = KB_NONE, field_offset = 0;
  double mean_k = 0;  // of a field
};

class ThermalCompiler {
 public:
  ThermalCompiler(const CompileContext& context, TextureCompiler& textures, MaterialCompiler& materials);

  /// Index of the shape's temperature, or KB_NONE where it does not emit by Kirchhoff's law. Temperatures of vertices are
  /// those of the mesh that is about to be added.
  uint32_t heat_of(const Shape& shape);
  const std::vector<Heat>& heats() const { return heats_; }

  /// The thermal record of a material, or of a black back; KB_NONE where nothing is emitted.
  /// throws InputError  a material whose emission cannot be had
  uint32_t thermal(const std::shared_ptr<const Bsdf>& bsdf, uint32_t material, uint32_t heat);
  uint32_t black(uint32_t heat);

  bool emits(const KbSurface& surface) const;
  /// An estimate of one side's emissivity, that only noise depends on; of blends by their mean weight.
  double side_estimate(const KbSurface& surface, bool front, double lambda_nm) const;

 private:
  uint32_t add_thermal(KbThermal record, uint32_t heat);
  KbThermal thermal_of(const KbMaterial& material, const std::string& name, uint32_t heat);
  KbThermal thermal_of_metal(const KbMaterial& material, const std::string& name, uint32_t heat);
  uint32_t nonlinear_complement(const KbMaterial& material, uint32_t heat);
  void check_thermal(const Bsdf& bsdf, const KbMaterial& material) const;
  void warn_of_trapped_light(const Bsdf& bsdf, const KbMaterial& material) const;
  void warn_of_ratio(const Bsdf& bsdf, const KbMaterial& material) const;
  void require_emission_data(const Texture& texture, const SpectrumSource& use) const;
  // temperature.cpp
  uint32_t image_heat(const std::shared_ptr<const BitmapTexture>& image);
  uint32_t vertex_heat(const std::vector<float>& temperatures);
  /// The row of an emissivity times Planck's law; of fields, of the emissivity alone.
  uint32_t emission_row(uint32_t heat, const RegularTable& emissivity, const std::string& name);
  uint32_t black_row(uint32_t heat);
  /// What 1 - a reflectance emits; KB_NONE where that is 0.
  uint32_t complement(uint32_t ref, uint32_t heat);
  uint32_t complement_row(uint32_t row, uint32_t heat);
  uint32_t complement_bitmap(uint32_t index, uint32_t heat);
  uint32_t complement_checkerboard(uint32_t index, uint32_t heat);
  double mean_weight(const KbSurface& blend) const;
  double emissivity_estimate(uint32_t thermal, double lambda_nm) const;
  double reference_estimate(uint32_t ref, double lambda_nm) const;

  const SceneDescription& in_;
  const DiagnosticSink& sink_;
  FlatScene& out_;
  SpectrumTableBuilder& spectra_;
  TextureCompiler& textures_;
  MaterialCompiler& materials_;
  std::vector<Heat> heats_;
  std::map<const void*, uint32_t> image_heats_;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> emission_rows_, complements_,
      thermals_;                                    // by what and heat
  std::map<uint32_t, uint32_t> complement_texels_;  // first texel of the complement, by bitmap
};

}  // namespace kiloband
