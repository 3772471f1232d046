// Principled materials: shared/principled.h.
#include <algorithm>

#include "scene/compile/material/materials.hpp"
#include "spectral/colour/colour.hpp"

namespace kiloband {
namespace {

/// Under D65, relative to what reflects all. 0 where the visible is outside the data.
double luminance_under_d65(const Spectrum& reflectance) {
  double sum = 0, white = 0;
  for (double nm = kCieMinNm; nm <= kCieMaxNm; nm += 1) {
    const double weight = cie_y()(nm) * illuminant_d65()(nm);
    white += weight;
    sum += weight * reflectance(nm);
  }
  return sum / white;
}

bool is_tinted(const PrincipledBsdf& model) {
  const auto present = [&](KbPrincipledNumber n) {
    return model.numbers[n].map || model.numbers[n].number > 0;
  };
  return present(KB_PRINCIPLED_SPEC_TINT) || present(KB_PRINCIPLED_SHEEN_TINT);
}

}  // namespace

KbMaterial MaterialCompiler::make(const PrincipledBsdf& model, const std::string& name,
                                  const SourcePosition& position) {
  KbMaterial record = empty_material(KB_MATERIAL_PRINCIPLED);
  record.flags = KB_MATERIAL_GGX | KB_MATERIAL_SAMPLE_VISIBLE | (model.thin ? KB_MATERIAL_THIN : 0);
  record.ref_a = textures_.reference(model.base_color, {name + ": base_color", position, false});
  record.bound_a = static_cast<float>(textures_.bound(model.base_color));
  record.bound_b = 1;
  record.eta = static_cast<float>(model.numbers[KB_PRINCIPLED_ETA].number);
  out_.features.principled = true;
  return record;
}

std::vector<float> MaterialCompiler::principled_numbers(const PrincipledBsdf& model, const std::string& name,
                                                        const SourcePosition& position) {
  std::vector<float> numbers(KB_PRINCIPLED_NUMBERS);
  for (std::size_t n = 0; n < model.numbers.size(); ++n)
    numbers[n] = static_cast<float>(model.numbers[n].number);
  const bool tinted = is_tinted(model);
  if (const auto* spectrum = std::get_if<Spectrum>(&model.base_color))
    numbers[KB_PRINCIPLED_LUMINANCE] = tinted ? static_cast<float>(luminance_under_d65(*spectrum)) : 0;
  else if (tinted && !std::holds_alternative<std::shared_ptr<const BitmapTexture>>(model.base_color))
    throw InputError(position, name + ": base_color: tints need a spectrum or a bitmap here");
  numbers[KB_PRINCIPLED_BASE] = static_cast<float>(textures_.mean(model.base_color));
  for (std::size_t i = 0; i < model.rates.size(); ++i)
    numbers[KB_PRINCIPLED_RATES + i] = static_cast<float>(model.rates[i]);
  return numbers;
}

/// Of the last material; rows of those before it are filled up.
void MaterialCompiler::add_principled_maps(const PrincipledBsdf& model) {
  std::vector<uint32_t> row(KB_PRINCIPLED_MAPPED, KB_NONE);
  const auto use = [&](const std::shared_ptr<const BitmapTexture>& map) {
    return KB_REF_BITMAP | textures_.bitmap(map, BitmapUse::kRoughness);
  };
  for (std::size_t n = 0; n < model.numbers.size(); ++n)
    if (model.numbers[n].map) row[n] = use(model.numbers[n].map);
  const auto* colour = std::get_if<std::shared_ptr<const BitmapTexture>>(&model.base_color);
  if (colour && is_tinted(model)) row[KB_PRINCIPLED_LUMINANCE] = use(*colour);
  // A row also where there is no map: kernels that are not made for the scene look.
  out_.features.principled_map |= std::ranges::any_of(row, [](uint32_t ref) { return ref != KB_NONE; });
  out_.principled_maps.resize((out_.materials.size() - 1) * KB_PRINCIPLED_MAPPED, KB_NONE);
  out_.principled_maps.insert(out_.principled_maps.end(), row.begin(), row.end());
}

}  // namespace kiloband
