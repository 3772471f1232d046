#include "scene/compile/material/materials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/optics/facet_quadrature.hpp"

namespace kiloband {

std::string describe(const Bsdf& bsdf) {
  return bsdf.id.empty() ? "bsdf" : "bsdf '" + bsdf.id + "'";
}

namespace {

/// Part of diffuse light from the thinner side of a boundary that passes it, 2 int_0^1 (1 - F(c)) c dc for an index
/// eta >= 1 of the far side over the near one. 1 - F rises within c = 1 / eta, so that the midpoint rule is in v = sqrt(c):
/// relative error below 1e-7 for eta up to 1000.
double diffuse_transmittance(double eta) {
  constexpr int kSteps = 20000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double v = (i + 0.5) / kSteps;
    sum += (1 - dielectric_reflectance(v * v, eta)) * v * v * v;
  }
  return 4 * sum / kSteps;
}

/// Part of diffuse light inside a coating of index eta that leaves through it. Light inside leaves by a cone of
/// 1 - c^2 < 1 / eta^2 alone, which no rule over the hemisphere resolves at large indices; by reciprocity it is
/// what enters from outside over eta^2 (the same pairs of directions, equal etendue).
double diffuse_escape(double eta) {
  return eta >= 1 ? diffuse_transmittance(eta) / (eta * eta) : diffuse_transmittance(1 / eta);
}

void set_roughness(KbMaterial& record, const Roughness& roughness) {
  if (roughness.distribution == Microfacet::kGgx) record.flags |= KB_MATERIAL_GGX;
  record.alpha_u = static_cast<float>(roughness.alpha_u);
  record.alpha_v = static_cast<float>(roughness.alpha_v);
  if (roughness.sample_visible) record.flags |= KB_MATERIAL_SAMPLE_VISIBLE;
}

}  // namespace

KbMaterial empty_material(uint32_t type) {
  KbMaterial record{};
  record.type = type;
  record.ref_a = record.ref_b = record.eta_row = record.k_row = record.ext_row = KB_NONE;
  record.eta = record.eta_ext = record.escape = 1;
  record.table = KB_NONE;
  return record;
}

MaterialCompiler::MaterialCompiler(const CompileContext& context, TextureCompiler& textures)
    : sink_(context.options.sink),
      out_(context.out),
      spectra_(context.spectra),
      current_(context.mesh),
      textures_(textures),
      materials_(context.mesh) {}

bool is_metal(const KbMaterial& material) {
  return material.type == KB_MATERIAL_CONDUCTOR || material.type == KB_MATERIAL_ROUGH_CONDUCTOR;
}

bool bends_light(const KbMaterial& material) {
  return material.eta != 1 || (material.flags & KB_MATERIAL_DISPERSIVE);
}

KbMaterial MaterialCompiler::make(const DiffuseBsdf& model, const std::string& name,
                                  const SourcePosition& position) {
  KbMaterial record = empty_material(KB_MATERIAL_DIFFUSE);
  record.ref_a = textures_.reference(model.reflectance, {name + ": reflectance", position, false});
  record.bound_a = static_cast<float>(textures_.bound(model.reflectance));
  out_.features.diffuse = true;
  return record;
}

/// Optical constants must cover every channel: an index of 0 outside the data would be no material at all.
static void require_data(const Spectrum& spectrum, const FlatScene& scene, const SpectrumSource& use) {
  const auto data = spectrum.data_range();
  if (!data || spectrum.extrapolates()) return;
  for (const ChannelList* list : {&scene.channels, &scene.guide}) {
    for (const Channel& channel : *list) {
      if (channel.min_nm < data->min_nm * (1 - 1e-9) || channel.max_nm > data->max_nm * (1 + 1e-9)) {
        throw InputError(use.position,
                         fmt::format("{}: data from {:g} to {:g} nm do not cover channel {:g}-{:g} nm: "
                                     "--bands names others",
                                     use.name, data->min_nm, data->max_nm, channel.min_nm, channel.max_nm));
      }
    }
  }
}

KbMaterial MaterialCompiler::make(const ConductorBsdf& model, const std::string& name,
                                  const SourcePosition& position) {
  KbMaterial record = empty_material(model.roughness ? KB_MATERIAL_ROUGH_CONDUCTOR : KB_MATERIAL_CONDUCTOR);
  record.ref_a =
      textures_.reference(model.specular_reflectance, {name + ": specular_reflectance", position, false});
  record.bound_a = static_cast<float>(textures_.bound(model.specular_reflectance));
  const bool mirror =
      model.eta.is_constant() && model.eta(550) == 0 && model.k.is_constant() && model.k(550) == 1;
  if (mirror) {
    record.flags |= KB_MATERIAL_PERFECT_MIRROR;
  } else {
    const SpectrumSource eta_use{name + ": eta", position, false};
    const SpectrumSource k_use{name + ": k", position, false};
    require_data(model.eta, out_, eta_use);
    require_data(model.k, out_, k_use);
    record.eta_row = spectra_.row(model.eta, eta_use);
    record.k_row = spectra_.row(model.k, k_use);
  }
  if (model.roughness) set_roughness(record, *model.roughness);
  (model.roughness ? out_.features.rough_conductor : out_.features.conductor) = true;
  return record;
}

/// What is opaque within a few wavelengths is no glass.
static void warn_of_extinction(const DielectricBsdf& model, const FlatScene& scene, const std::string& name,
                               const SourcePosition& position, const DiagnosticSink& sink) {
  constexpr double kNegligible = 0.01;
  double largest = 0;
  for (const Channel& channel : scene.channels)
    if (model.int_k) largest = std::max(largest, model.int_k->max_over(channel.min_nm, channel.max_nm));
  if (largest <= kNegligible) return;
  warn(sink, position,
       fmt::format("{}: int_material: its extinction k, up to {:.3g} in the channels, has no effect: nothing "
                   "absorbs inside; a conductor takes the file as 'metal'",
                   name, largest));
}

KbMaterial MaterialCompiler::make(const DielectricBsdf& model, const std::string& name,
                                  const SourcePosition& position) {
  KbMaterial record = empty_material(model.roughness ? KB_MATERIAL_ROUGH_DIELECTRIC : KB_MATERIAL_DIELECTRIC);
  record.ref_a =
      textures_.reference(model.specular_reflectance, {name + ": specular_reflectance", position, false});
  record.ref_b =
      textures_.reference(model.specular_transmittance, {name + ": specular_transmittance", position, false});
  record.bound_a = static_cast<float>(textures_.bound(model.specular_reflectance));
  record.bound_b = static_cast<float>(textures_.bound(model.specular_transmittance));
  if (model.thin) record.flags |= KB_MATERIAL_THIN;
  const SpectrumSource int_use{name + ": int_ior", position, false};
  const SpectrumSource ext_use{name + ": ext_ior", position, false};
  require_data(model.int_ior, out_, int_use);
  require_data(model.ext_ior, out_, ext_use);
  warn_of_extinction(model, out_, name, position, sink_);
  const double ext = spectra_.guide_mean(model.ext_ior);
  record.eta = static_cast<float>(spectra_.guide_mean(model.int_ior) / ext);
  record.eta_ext = static_cast<float>(ext);
  if (!model.int_ior.is_constant() || !model.ext_ior.is_constant()) {
    record.flags |= KB_MATERIAL_DISPERSIVE;
    record.eta_row = spectra_.row(model.int_ior, int_use);
    if (!model.ext_ior.is_constant()) record.ext_row = spectra_.row(model.ext_ior, ext_use);
    out_.features.dispersion = true;
  }
  if (model.roughness && (record.flags & KB_MATERIAL_DISPERSIVE)) {
    out_.unit_row = spectra_.row(Spectrum::constant(1), {"degradation", position, false});
  }
  if (model.roughness) set_roughness(record, *model.roughness);
  (model.roughness ? out_.features.rough_dielectric : out_.features.dielectric) = true;
  return record;
}

KbMaterial MaterialCompiler::make(const PlasticBsdf& model, const std::string& name,
                                  const SourcePosition& position) {
  KbMaterial record = empty_material(model.roughness ? KB_MATERIAL_ROUGH_PLASTIC : KB_MATERIAL_PLASTIC);
  record.ref_a =
      textures_.reference(model.specular_reflectance, {name + ": specular_reflectance", position, false});
  record.ref_b =
      textures_.reference(model.diffuse_reflectance, {name + ": diffuse_reflectance", position, false});
  record.bound_a = static_cast<float>(textures_.bound(model.specular_reflectance));
  record.bound_b = static_cast<float>(textures_.bound(model.diffuse_reflectance));
  record.eta = static_cast<float>(model.int_ior / model.ext_ior);
  record.escape = static_cast<float>(diffuse_escape(model.int_ior / model.ext_ior));
  const double specular = textures_.mean(model.specular_reflectance);
  const double diffuse = textures_.mean(model.diffuse_reflectance);
  record.specular_weight =
      specular + diffuse > 0 ? static_cast<float>(specular / (specular + diffuse)) : 0.5f;
  if (model.nonlinear) record.flags |= KB_MATERIAL_NONLINEAR;
  if (model.roughness) {
    set_roughness(record, *model.roughness);
    record.escape = static_cast<float>(1 - coating(record).internal_reflectance);
  }
  (model.roughness ? out_.features.rough_plastic : out_.features.plastic) = true;
  return record;
}

KbBump MaterialCompiler::bump(const BumpedBsdf& bumped) {
  out_.features.bump = true;
  const BitmapUse use = bumped.normals ? BitmapUse::kNormals : BitmapUse::kHeight;
  KbBump record{textures_.bitmap(bumped.texture, use, static_cast<float>(bumped.scale)), 0};
  if (bumped.flip) record.flags |= KB_BUMP_FLIP;
  if (bumped.shadow) record.flags |= KB_BUMP_SHADOW;
  if (bumped.around_two_sided) record.flags |= KB_BUMP_OUTSIDE;
  return record;
}

/// throws InputError where the roughness is that of all wavelengths' tables
KbRoughness MaterialCompiler::roughness_maps(const Bsdf& scattering) {
  const std::optional<Roughness>* rough = nullptr;
  if (const auto* metal = std::get_if<ConductorBsdf>(&scattering.model)) rough = &metal->roughness;
  const auto* glass = std::get_if<DielectricBsdf>(&scattering.model);
  if (glass) rough = &glass->roughness;
  KbRoughness record{KB_NONE, KB_NONE};
  if (!rough || !*rough) return record;
  const auto use = [&](const std::shared_ptr<const BitmapTexture>& map) {
    return map ? KB_REF_BITMAP | textures_.bitmap(map, BitmapUse::kRoughness) : KB_NONE;
  };
  record = {use((*rough)->map_u), use((*rough)->map_v)};
  if (record.alpha_u_ref == KB_NONE && record.alpha_v_ref == KB_NONE) return record;
  if (glass && !(glass->int_ior.is_constant() && glass->ext_ior.is_constant()))
    throw InputError(scattering.position, describe(scattering) +
                                              ": alpha: a rough dielectric whose index depends on the "
                                              "wavelength cannot have a texture here");
  out_.features.roughness_map = true;
  return record;
}

uint32_t MaterialCompiler::material(const std::shared_ptr<const Bsdf>& bsdf, bool compensated,
                                    const std::string& outer_id) {
  if (const auto* known = materials_.find(*bsdf, compensated)) return *known;
  const std::size_t lookups = current_.lookups;
  const std::string name = describe(*bsdf);
  const auto* bumped = std::get_if<BumpedBsdf>(&bsdf->model);
  const std::shared_ptr<const Bsdf>& scattering = bumped ? bumped->nested : bsdf;
  KbMaterial record = std::visit(
      [&](const auto& model) -> KbMaterial {
        using Model = std::decay_t<decltype(model)>;
        if constexpr (std::is_same_v<Model, TwoSidedBsdf> || std::is_same_v<Model, MaskBsdf> ||
                      std::is_same_v<Model, BlendBsdf> || std::is_same_v<Model, NullBsdf>) {
          throw InputError(bsdf->position,
                           name + ": a twosided, mask, blend or null bsdf cannot be nested here");
        } else if constexpr (std::is_same_v<Model, BumpedBsdf>) {
          throw InputError(bsdf->position, name + ": a bumpmap or normalmap cannot be nested in another");
        } else {
          return make(model, name, bsdf->position);
        }
      },
      scattering->model);
  const auto* principled = std::get_if<PrincipledBsdf>(&scattering->model);
  set_tables(record, principled    ? principled_numbers(*principled, name, bsdf->position)
                     : compensated ? compensate(record, *scattering)
                                   : std::vector<float>());
  out_.materials.push_back(record);
  if (principled) add_principled_maps(*principled);
  out_.bumps.push_back(bumped ? bump(*bumped) : KbBump{KB_NONE, 0});
  out_.roughness.push_back(roughness_maps(*scattering));
  const std::string& own_id = bsdf->id.empty() ? scattering->id : bsdf->id;
  const std::string& id = own_id.empty() ? outer_id : own_id;
  out_.material_names.push_back(id.empty() ? fmt::format("material {}", out_.materials.size() - 1) : id);
  const auto index = static_cast<uint32_t>(out_.materials.size() - 1);
  if (constexpr uint32_t kMost = 1u << (32 - KB_VERTEX_MATERIAL_SHIFT); index >= kMost)
    throw InputError(bsdf->position, fmt::format("more than {} bsdfs", kMost));
  materials_.add(*bsdf, compensated, lookups, index);
  return index;
}

}  // namespace kiloband
