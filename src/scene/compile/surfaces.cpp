// What the bsdf of a shape comes to: the materials of its two sides and its opacity.
#include "scene/compile/flattener.hpp"

namespace kiloband {

void Flattener::set_opacity(KbSurface& record, const MaskBsdf& mask, const SpectrumSource& use) {
  out_.features.mask = true;
  if (const auto* spectrum = std::get_if<Spectrum>(&mask.opacity)) {
    record.opacity = static_cast<float>(spectra_.guide_mean(*spectrum));
  } else if (const auto* image = std::get_if<std::shared_ptr<const BitmapTexture>>(&mask.opacity)) {
    record.opacity_ref = KB_REF_BITMAP | bitmap(*image, BitmapUse::kOpacity);
  } else {
    throw InputError(use.position, use.name + ": only a number or a bitmap is supported here");
  }
}

static bool is_rough(const Bsdf& bsdf) {
  if (const auto* conductor = std::get_if<ConductorBsdf>(&bsdf.model))
    return conductor->roughness.has_value();
  if (const auto* dielectric = std::get_if<DielectricBsdf>(&bsdf.model))
    return dielectric->roughness.has_value();
  const auto* plastic = std::get_if<PlasticBsdf>(&bsdf.model);
  return plastic && plastic->roughness;
}

uint32_t Flattener::surface(const std::shared_ptr<const Bsdf>& bsdf, uint32_t heat) {
  if (const auto found = surfaces_.find({bsdf.get(), heat}); found != surfaces_.end()) return found->second;
  KbSurface record{};
  record.back = record.opacity_ref = record.front_thermal = record.back_thermal = KB_NONE;
  record.opacity = 1;
  std::shared_ptr<const Bsdf> inner = bsdf;
  if (const auto* mask = std::get_if<MaskBsdf>(&inner->model)) {
    set_opacity(record, *mask, {describe(*bsdf) + ": opacity", bsdf->position, false});
    inner = mask->nested;
  }
  if (std::holds_alternative<NullBsdf>(inner->model)) {  // nothing is there that could emit
    record.front = KB_NONE;
    record.flags |= KB_SURFACE_NULL;
    out_.surfaces.push_back(record);
    return surfaces_[{bsdf.get(), heat}] = static_cast<uint32_t>(out_.surfaces.size() - 1);
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
  record.front = material(front, emits && is_rough(*front), outer_id);
  if (back) record.back = material(back, emits && is_rough(*back), outer_id);
  const uint32_t type = out_.materials[record.front].type;
  if (!back && (type == KB_MATERIAL_DIELECTRIC || type == KB_MATERIAL_ROUGH_DIELECTRIC))
    record.flags |= KB_SURFACE_TRANSMISSIVE;
  if (emits) {
    record.flags |= KB_SURFACE_THERMAL;
    record.front_thermal = thermal(front, record.front, heat);
    const bool same = record.flags & KB_SURFACE_TRANSMISSIVE;
    record.back_thermal = same ? record.front_thermal : back ? thermal(back, record.back, heat) : black(heat);
    out_.features.thermal |= record.front_thermal != KB_NONE || record.back_thermal != KB_NONE;
  }
  out_.surfaces.push_back(record);
  return surfaces_[{bsdf.get(), heat}] = static_cast<uint32_t>(out_.surfaces.size() - 1);
}

}  // namespace kiloband
