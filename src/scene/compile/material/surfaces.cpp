#include "scene/compile/material/surfaces.hpp"

#include <algorithm>

namespace kiloband {
namespace {

using BsdfPointer = std::shared_ptr<const Bsdf>;

bool is_rough(const Bsdf& bsdf) {
  if (const auto* bumped = std::get_if<BumpedBsdf>(&bsdf.model)) return is_rough(*bumped->nested);
  if (const auto* conductor = std::get_if<ConductorBsdf>(&bsdf.model))
    return conductor->roughness.has_value();
  if (const auto* dielectric = std::get_if<DielectricBsdf>(&bsdf.model))
    return dielectric->roughness.has_value();
  const auto* plastic = std::get_if<PlasticBsdf>(&bsdf.model);
  return plastic && plastic->roughness;
}

/// The same with another model.
template <class Model>
BsdfPointer with(const Bsdf& bsdf, Model model) {
  return std::make_shared<const Bsdf>(Bsdf{bsdf.id, bsdf.position, std::move(model)});
}

/// A blend of `bsdf` with the one or the other part of a blend in it.
template <class Rebuild>
BsdfPointer moved_out(const Bsdf& bsdf, const BlendBsdf& inner, const Rebuild& rebuild) {
  return with(bsdf,
              BlendBsdf{inner.weight, with(bsdf, rebuild(inner.first)), with(bsdf, rebuild(inner.second))});
}

/// A mask or twosided bsdf with a blend in it, as a blend of such bsdfs; others as they are. One level: the parts may
/// have blends in them. Null: there is none.
BsdfPointer distributed(const Bsdf& bsdf) {
  if (const auto* mask = std::get_if<MaskBsdf>(&bsdf.model)) {
    const BsdfPointer moved = distributed(*mask->nested);  // of a twosided bsdf
    const auto* inner = std::get_if<BlendBsdf>(moved ? &moved->model : &mask->nested->model);
    if (!inner) return nullptr;
    return moved_out(bsdf, *inner, [&](const BsdfPointer& part) { return MaskBsdf{mask->opacity, part}; });
  }
  const auto* sides = std::get_if<TwoSidedBsdf>(&bsdf.model);
  if (!sides) return nullptr;
  if (const auto* front = std::get_if<BlendBsdf>(&sides->front->model))
    return moved_out(bsdf, *front, [&](const BsdfPointer& part) { return TwoSidedBsdf{part, sides->back}; });
  const auto* back = sides->back ? std::get_if<BlendBsdf>(&sides->back->model) : nullptr;
  if (!back) return nullptr;
  return moved_out(bsdf, *back, [&](const BsdfPointer& part) { return TwoSidedBsdf{sides->front, part}; });
}

KbSurface empty_surface() {
  KbSurface record{};
  record.front = record.back = record.opacity_ref = record.front_thermal = record.back_thermal = KB_NONE;
  record.first = record.second = record.weight_ref = KB_NONE;
  record.opacity = 1;
  return record;
}

}  // namespace

SurfaceCompiler::SurfaceCompiler(const CompileContext& context, TextureCompiler& textures,
                                 MaterialCompiler& materials, ThermalCompiler& thermal)
    : out_(context.out),
      sink_(context.options.sink),
      current_(context.mesh),
      textures_(textures),
      materials_(materials),
      thermal_(thermal),
      surfaces_(context.mesh) {}

uint32_t SurfaceCompiler::add(const KbSurface& record) {
  out_.surfaces.push_back(record);
  return static_cast<uint32_t>(out_.surfaces.size() - 1);
}

void SurfaceCompiler::set_share(const Texture& texture, const SpectrumSource& use, uint32_t& ref,
                                float& constant) {
  if (const auto* spectrum = std::get_if<Spectrum>(&texture); spectrum && spectrum->is_constant()) {
    constant = static_cast<float>((*spectrum)(550));
  } else if (const auto* image = std::get_if<std::shared_ptr<const BitmapTexture>>(&texture)) {
    ref = KB_REF_BITMAP | textures_.bitmap(*image, BitmapUse::kOpacity);
  } else if (const auto* attribute = std::get_if<std::shared_ptr<const MeshAttributeTexture>>(&texture)) {
    ref = KB_REF_BITMAP | textures_.mesh_attribute(*attribute, use, true);
  } else {
    throw InputError(use.position, use.name + ": only a number or a bitmap is supported here");
  }
}

/// Whether a part of it, or all of it, refracts light: panes do not, nor does the opening of a mask.
bool SurfaceCompiler::refracts(const KbSurface& surface, bool wholly) const {
  if (surface.flags & KB_SURFACE_BLEND) {
    const bool first = refracts(out_.surfaces[surface.first], wholly);
    const bool second = refracts(out_.surfaces[surface.second], wholly);
    return wholly ? first && second : first || second;
  }
  if (!(surface.flags & KB_SURFACE_TRANSMISSIVE)) return false;
  const KbMaterial& material = out_.materials[surface.front];
  const bool open = surface.opacity_ref != KB_NONE || surface.opacity < 1;
  return bends_light(material) && !(material.flags & KB_MATERIAL_THIN) && !(wholly && open);
}

/// Inside glass of index n the radiance of equilibrium is n² B. What is opaque emits B there, an opening lets B in and n² B out.
void SurfaceCompiler::warn_of_inside(const KbSurface& surface, const Bsdf& bsdf, uint32_t heat) const {
  if (heat == KB_NONE || thermal_.heats()[heat].temperature_k == 0) return;
  if (!refracts(surface, false) || refracts(surface, true)) return;
  warn(sink_, bsdf.position,
       describe(bsdf) +
           ": thermal emission: a dielectric in a mask, or blended with what does not refract: a closed body "
           "of it is not in equilibrium with its surroundings");
}

/// Blends are outermost: what is in a mask or a twosided bsdf was moved out.
uint32_t SurfaceCompiler::blend(const BlendBsdf& model, const Bsdf& bsdf, uint32_t heat) {
  out_.features.blend = true;
  KbSurface record = empty_surface();
  record.flags = KB_SURFACE_BLEND;
  set_share(model.weight, {describe(bsdf) + ": weight", bsdf.position, false}, record.weight_ref,
            record.weight);
  record.first = part(model.first, heat);
  record.second = part(model.second, heat);
  const KbSurface& first = out_.surfaces[record.first];
  record.front = first.front;
  record.back = first.back;
  record.flags |= (first.flags | out_.surfaces[record.second].flags) & KB_SURFACE_THERMAL;
  return add(record);
}

uint32_t SurfaceCompiler::surface(const std::shared_ptr<const Bsdf>& bsdf, uint32_t heat) {
  const bool is_new = !surfaces_.find(*bsdf, heat);
  const uint32_t index = part(bsdf, heat);
  if (is_new) warn_of_inside(out_.surfaces[index], *bsdf, heat);
  return index;
}

uint32_t SurfaceCompiler::part(const std::shared_ptr<const Bsdf>& bsdf, uint32_t heat) {
  if (const auto* known = surfaces_.find(*bsdf, heat)) return *known;
  const std::size_t lookups = current_.lookups;
  const BsdfPointer outermost = distributed(*bsdf);
  if (outermost) distributed_.push_back(outermost);  // keeps its parts, too
  const Bsdf& used = outermost ? *outermost : *bsdf;
  const auto* parts = std::get_if<BlendBsdf>(&used.model);
  const uint32_t index = parts ? blend(*parts, used, heat) : new_surface(bsdf, heat);
  surfaces_.add(*bsdf, heat, lookups, index);
  return index;
}

uint32_t SurfaceCompiler::new_surface(const std::shared_ptr<const Bsdf>& bsdf, uint32_t heat) {
  KbSurface record = empty_surface();
  std::shared_ptr<const Bsdf> inner = bsdf;
  if (const auto* mask = std::get_if<MaskBsdf>(&inner->model)) {
    out_.features.mask = true;
    set_share(mask->opacity, {describe(*bsdf) + ": opacity", bsdf->position, false}, record.opacity_ref,
              record.opacity);
    inner = mask->nested;
  }
  if (std::holds_alternative<NullBsdf>(inner->model)) {  // nothing is there that could emit
    record.flags |= KB_SURFACE_NULL;
    return add(record);
  }
  const std::string& outer_id = inner->id.empty() ? bsdf->id : inner->id;
  std::shared_ptr<const Bsdf> front = inner, back;
  if (const auto* two_sided = std::get_if<TwoSidedBsdf>(&inner->model)) {
    front = two_sided->front;
    back = two_sided->back ? two_sided->back : front;
    record.flags |= KB_SURFACE_TWO_SIDED;
    out_.features.two_sided = true;
  }
  const bool emits = heat != KB_NONE;
  record.front = materials_.material(front, emits && is_rough(*front), outer_id);
  if (back) record.back = materials_.material(back, emits && is_rough(*back), outer_id);
  const uint32_t type = out_.materials[record.front].type;
  const auto* bumped = std::get_if<BumpedBsdf>(&front->model);
  const auto* principled = std::get_if<PrincipledBsdf>(bumped ? &bumped->nested->model : &front->model);
  if (!back && (type == KB_MATERIAL_DIELECTRIC || type == KB_MATERIAL_ROUGH_DIELECTRIC ||
                (principled && passes_light(*principled))))
    record.flags |= KB_SURFACE_TRANSMISSIVE;
  if (emits) {
    record.flags |= KB_SURFACE_THERMAL;
    record.front_thermal = thermal_.thermal(front, record.front, heat);
    const bool same = record.flags & KB_SURFACE_TRANSMISSIVE;
    record.back_thermal = same   ? record.front_thermal
                          : back ? thermal_.thermal(back, record.back, heat)
                                 : thermal_.black(heat);
    out_.features.thermal |= record.front_thermal != KB_NONE || record.back_thermal != KB_NONE;
  }
  return add(record);
}

}  // namespace kiloband
