// What surfaces emit by Kirchhoff's law: a thermal record for each pair of material and temperature.
#include "scene/compile/material/thermal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/optics/compensation.hpp"
#include "scene/optics/metal_emissivity.hpp"
#include "shared/estimator.h"

namespace kiloband {
namespace {

bool is_textured(const Texture& texture) {
  return !std::holds_alternative<Spectrum>(texture);
}

/// Is the spectrum 1 in every rendered channel?
bool is_one(const Texture& texture) {
  const auto* spectrum = std::get_if<Spectrum>(&texture);
  return spectrum && spectrum->is_constant() && (*spectrum)(550) == 1;
}

KbThermal empty_thermal(uint32_t type) {
  KbThermal record{};
  record.type = type;
  record.ref[0] = record.ref[1] = record.ref[2] = record.table = record.field = KB_NONE;
  record.eta = record.alpha_u = record.alpha_v = 1;
  return record;
}

}  // namespace

ThermalCompiler::ThermalCompiler(const CompileContext& context, TextureCompiler& textures,
                                 MaterialCompiler& materials)
    : in_(context.in),
      sink_(context.options.sink),
      out_(context.out),
      spectra_(context.spectra),
      textures_(textures),
      materials_(materials) {}

/// A reflectance of 0 outside its data would be an emissivity of 1.
void ThermalCompiler::require_emission_data(const Texture& texture, const SpectrumSource& use) const {
  if (const auto* board = std::get_if<std::shared_ptr<const CheckerboardTexture>>(&texture)) {
    require_emission_data((*board)->color0, {use.name + " color0", use.position});
    require_emission_data((*board)->color1, {use.name + " color1", use.position});
  }
  const auto refuse = [&](const char* type) {
    throw InputError(use.position,
                     use.name + ": a surface that emits thermally cannot have a " + type + " here");
  };
  if (std::holds_alternative<std::shared_ptr<const MeshAttributeTexture>>(texture)) refuse("mesh_attribute");
  if (std::holds_alternative<std::shared_ptr<const SpectralBitmapTexture>>(texture))
    refuse("spectral_bitmap");
  const auto* spectrum = std::get_if<Spectrum>(&texture);
  const auto data = spectrum ? spectrum->data_range() : std::nullopt;
  if (!data || spectrum->extrapolates()) return;
  for (const Channel& channel : out_.channels) {
    if (channel.min_nm >= data->min_nm * (1 - 1e-9) && channel.max_nm <= data->max_nm * (1 + 1e-9)) continue;
    throw InputError(use.position,
                     fmt::format("{}: data from {:g} to {:g} nm do not cover channel {:g}-{:g} nm, where the "
                                 "surface emits thermally: 'extrapolate' would continue them",
                                 use.name, data->min_nm, data->max_nm, channel.min_nm, channel.max_nm));
  }
}

/// throws InputError for materials whose emission cannot be had
void ThermalCompiler::check_thermal(const Bsdf& bsdf, const KbMaterial& material) const {
  const std::string name = describe(bsdf);
  if (std::holds_alternative<BumpedBsdf>(bsdf.model))
    throw InputError(bsdf.position, name + ": a shape that emits thermally cannot have a bump or normal map");
  if (std::holds_alternative<PrincipledBsdf>(bsdf.model))
    throw InputError(bsdf.position,
                     name +
                         ": a principled material cannot emit thermally: what it absorbs has no "
                         "closed form; use a plastic, a conductor or a dielectric");
  const auto require = [&](const Texture& texture, const char* parameter) {
    require_emission_data(texture, {name + ": " + parameter, bsdf.position});
  };
  if (const auto* diffuse = std::get_if<DiffuseBsdf>(&bsdf.model))
    require(diffuse->reflectance, "reflectance");
  const auto refuse_map = [&](const std::optional<Roughness>& roughness) {
    if (roughness && (roughness->map_u || roughness->map_v))
      throw InputError(bsdf.position,
                       name + ": alpha: a material that emits thermally cannot have a texture here");
  };
  if (const auto* metal = std::get_if<ConductorBsdf>(&bsdf.model)) {
    refuse_map(metal->roughness);
    require(metal->specular_reflectance, "specular_reflectance");
    if (is_textured(metal->specular_reflectance) && !(material.flags & KB_MATERIAL_PERFECT_MIRROR)) {
      throw InputError(
          bsdf.position,
          name + ": specular_reflectance: a metal that emits thermally cannot have a texture here");
    }
  }
  if (const auto* plastic = std::get_if<PlasticBsdf>(&bsdf.model)) {
    require(plastic->specular_reflectance, "specular_reflectance");
    require(plastic->diffuse_reflectance, "diffuse_reflectance");
    if (plastic->nonlinear && is_textured(plastic->diffuse_reflectance)) {
      throw InputError(bsdf.position,
                       name +
                           ": diffuse_reflectance: a nonlinear plastic that emits thermally cannot "
                           "have a texture here");
    }
  }
  if (const auto* glass = std::get_if<DielectricBsdf>(&bsdf.model)) {
    refuse_map(glass->roughness);
    require(glass->specular_reflectance, "specular_reflectance");
    require(glass->specular_transmittance, "specular_transmittance");
    const bool lossless = is_one(glass->specular_reflectance) && is_one(glass->specular_transmittance);
    if ((material.flags & KB_MATERIAL_DISPERSIVE) && !lossless) {
      throw InputError(bsdf.position, name +
                                          ": a dispersive dielectric that emits thermally must have "
                                          "specular_reflectance 1 and specular_transmittance 1");
    }
  }
}

/// Emissivities of metals are tabulated at 17 azimuths at most, which ratios of a brushed metal suit.
void ThermalCompiler::warn_of_ratio(const Bsdf& bsdf, const KbMaterial& material) const {
  constexpr float kRatio = 20;  // error 7e-4 (metal_emissivity.hpp)
  if (!is_metal(material) || !(material.flags & KB_MATERIAL_COMPENSATED)) return;
  const float u = std::max(material.alpha_u, KB_MIN_ALPHA), v = std::max(material.alpha_v, KB_MIN_ALPHA);
  const float ratio = std::max(u, v) / std::min(u, v);
  if (ratio <= kRatio * (1 + 1e-6f) || (material.flags & KB_MATERIAL_PERFECT_MIRROR)) return;
  warn(sink_, bsdf.position,
       fmt::format("{}: alpha: roughnesses in a ratio of {:.3g}, more than {:g}: the emissivity may be off "
                   "by {}",
                   describe(bsdf), ratio, kRatio, ratio <= 100 ? 0.01 : 0.2));
}

/// Energy compensation scales each of a path's bounces: where light stays inside for many of them, weights have a long tail.
void ThermalCompiler::warn_of_trapped_light(const Bsdf& bsdf, const KbMaterial& material) const {
  constexpr float kRoughness = 0.1f,
                  kIndex = 2.5f;  // 0.99 +- 0.01 of Planck's law there, 0.96 at an index of 3
  const auto* glass = std::get_if<DielectricBsdf>(&bsdf.model);
  if (!glass || !glass->roughness || std::max(material.alpha_u, material.alpha_v) < kRoughness) return;
  const float index = std::max(material.eta, 1 / material.eta);
  if (index < kIndex || !is_one(glass->specular_reflectance)) return;
  warn(sink_, bsdf.position,
       fmt::format(
           "{}: a rough dielectric of relative index {:.3g} that absorbs nothing keeps light inside for many "
           "bounces: means of few thousand samples may be some percent too small",
           describe(bsdf), index));
}

uint32_t ThermalCompiler::add_thermal(KbThermal record, uint32_t heat) {
  record.field = heats_[heat].field;
  record.field_offset = heats_[heat].field_offset;
  out_.features.temperature_field |= record.field != KB_NONE;
  out_.thermals.push_back(record);
  return static_cast<uint32_t>(out_.thermals.size() - 1);
}

uint32_t ThermalCompiler::black(uint32_t heat) {
  if (heats_[heat].temperature_k == 0) return KB_NONE;
  const auto [place, is_new] = thermals_.try_emplace({KB_NONE, heat}, KB_NONE);
  if (!is_new) return place->second;
  KbThermal record = empty_thermal(KB_THERMAL_UNIFORM);
  record.ref[0] = black_row(heat);
  return place->second = add_thermal(record, heat);
}

uint32_t ThermalCompiler::thermal(const std::shared_ptr<const Bsdf>& bsdf, uint32_t material, uint32_t heat) {
  const KbMaterial& record = out_.materials[material];
  check_thermal(*bsdf, record);
  if (heats_[heat].temperature_k == 0) return KB_NONE;
  const auto [place, is_new] = thermals_.try_emplace({material, heat}, KB_NONE);
  if (!is_new) return place->second;
  warn_of_ratio(*bsdf, record);
  warn_of_trapped_light(*bsdf, record);
  const KbThermal made = thermal_of(record, describe(*bsdf), heat);
  const bool nothing = std::ranges::all_of(made.ref, [](uint32_t ref) { return ref == KB_NONE; });
  if (!nothing || made.type == KB_THERMAL_NODES) place->second = add_thermal(made, heat);
  return place->second;
}

KbThermal ThermalCompiler::thermal_of(const KbMaterial& material, const std::string& name, uint32_t heat) {
  const bool mirror = material.flags & KB_MATERIAL_PERFECT_MIRROR;
  if (is_metal(material) && !mirror) return thermal_of_metal(material, name, heat);
  if (material.type == KB_MATERIAL_DIFFUSE || is_metal(material)) {
    KbThermal record = empty_thermal(KB_THERMAL_UNIFORM);
    record.ref[0] = complement(material.ref_a, heat);
    return record;
  }
  const bool rough = material.flags & KB_MATERIAL_COMPENSATED;
  KbThermal record = empty_thermal(rough ? KB_THERMAL_ROUGH : KB_THERMAL_SMOOTH);
  record.eta = material.eta;
  record.alpha_u = std::max(material.alpha_u, KB_MIN_ALPHA);
  record.alpha_v = std::max(material.alpha_v, KB_MIN_ALPHA);
  record.nodes_s = nodes_of_s(material);
  record.ref[0] = complement(material.ref_a, heat);
  const bool plastic = material.type == KB_MATERIAL_PLASTIC || material.type == KB_MATERIAL_ROUGH_PLASTIC;
  if (!plastic) record.flags |= material.flags & KB_MATERIAL_THIN ? KB_THERMAL_THIN : KB_THERMAL_TRANSMITS;
  const bool nonlinear = plastic && (material.flags & KB_MATERIAL_NONLINEAR);
  record.ref[1] = nonlinear ? nonlinear_complement(material, heat) : complement(material.ref_b, heat);
  record.q = 1;
  if (!rough || (!plastic && record.ref[0] == KB_NONE && record.ref[1] == KB_NONE)) return record;
  if (plastic) record.ref[2] = black_row(heat);
  record.table = append_table(out_, make_reflected_part(material));
  if (plastic) append_table(out_, make_coat_part(materials_.coating(material), material.eta));
  return record;
}

/// Rows at nodes of directions.
KbThermal ThermalCompiler::thermal_of_metal(const KbMaterial& material, const std::string& name,
                                            uint32_t heat) {
  const bool rough = material.flags & KB_MATERIAL_COMPENSATED;
  const MetalEmissivity metal({out_.spectra[material.eta_row].table, out_.spectra[material.k_row].table,
                               out_.spectra[material.ref_a].table},
                              rough ? std::optional(Facets(material)) : std::nullopt, spectra_.range());
  KbThermal record = empty_thermal(KB_THERMAL_NODES);
  record.alpha_u = rough ? std::sqrt(std::max(material.alpha_u, KB_MIN_ALPHA)) : 1;
  record.alpha_v = rough ? std::sqrt(std::max(material.alpha_v, KB_MIN_ALPHA)) : 1;
  record.nodes_cos = static_cast<uint32_t>(metal.cosines().size());
  record.nodes_s = metal.nodes_s();
  std::vector<float> cosines;
  for (const double cosine : metal.cosines()) cosines.push_back(static_cast<float>(cosine));
  record.table = append_table(out_, cosines);
  record.first_row = static_cast<uint32_t>(out_.spectra.size());
  for (const RegularTable& row : metal.rows()) emission_row(heat, row, name + ": emissivity");
  return record;
}

/// 1 - rho e / (1 - rho + rho e) = (1 - rho) / (1 - rho + rho e), e = escape: what a base of reflectance rho under a
/// nonlinear coating absorbs of what one of reflectance 1 would return.
uint32_t ThermalCompiler::nonlinear_complement(const KbMaterial& material, uint32_t heat) {
  const auto absorbed_of = [&](double value) { return (1 - value) / (1 - value + value * material.escape); };
  const RegularTable& rho = out_.spectra[material.ref_b & KB_REF_INDEX_MASK].table;
  constexpr int kParts = 32;  // of a cell: the formula bends between the reflectance's entries
  RegularTable absorbed;
  absorbed.min_nm = rho.min_nm;
  absorbed.step_nm = rho.step_nm / kParts;
  absorbed.extrapolate = true;
  for (std::size_t i = 0; i + 1 < rho.values.size(); ++i) {
    for (int part = 0; part < kParts; ++part) {
      const double t = static_cast<double>(part) / kParts;
      const double value = (1 - t) * rho.values[i] + t * rho.values[i + 1];
      absorbed.values.push_back(absorbed_of(value));
    }
  }
  absorbed.values.push_back(absorbed_of(rho.values.back()));
  return largest_value(absorbed) > 0
             ? KB_REF_SPECTRUM | emission_row(heat, absorbed, "emissivity of a coated base")
             : KB_NONE;
}

}  // namespace kiloband
