// Temperatures of shapes, emission spectra that go with them, and hot shapes as lights.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/compile/material/thermal.hpp"
#include "spectral/planck.hpp"

namespace kiloband {

uint32_t ThermalCompiler::image_heat(const std::shared_ptr<const BitmapTexture>& image) {
  const auto [place, is_new] = image_heats_.try_emplace(image.get(), static_cast<uint32_t>(heats_.size()));
  if (!is_new) return place->second;
  Heat heat;
  heat.field = textures_.bitmap(image, BitmapUse::kOpacity);
  heat.temperature_k = *std::ranges::max_element(image->image->pixels);
  heat.mean_k = textures_.mean_of(heat.field);
  heats_.push_back(heat);
  return place->second;
}

/// The vertices are those that add_mesh() is about to add.
uint32_t ThermalCompiler::vertex_heat(const std::vector<float>& temperatures) {
  Heat heat;
  heat.field = KB_FIELD_VERTEX;
  heat.field_offset =
      static_cast<uint32_t>(out_.tables.size()) - static_cast<uint32_t>(out_.positions.size());
  for (const float t : temperatures) heat.mean_k += t / static_cast<double>(temperatures.size());
  heat.temperature_k = *std::ranges::max_element(temperatures);
  out_.tables.insert(out_.tables.end(), temperatures.begin(), temperatures.end());
  heats_.push_back(heat);
  return static_cast<uint32_t>(heats_.size() - 1);
}

uint32_t ThermalCompiler::heat_of(const Shape& shape) {
  if (shape.thermal && shape.thermal->texture) return image_heat(shape.thermal->texture);
  if (shape.thermal && !shape.thermal->attribute.empty())
    return vertex_heat(
        std::get<MeshShape>(shape.geometry).mesh->vertex_attributes.at(shape.thermal->attribute));
  if (!shape.thermal && (shape.emitter || !in_.ambient_temperature_k)) return KB_NONE;
  const double temperature_k = shape.thermal ? shape.thermal->temperature_k : *in_.ambient_temperature_k;
  const auto known = std::ranges::find_if(
      heats_, [&](const Heat& heat) { return heat.field == KB_NONE && heat.temperature_k == temperature_k; });
  if (known != heats_.end()) return static_cast<uint32_t>(known - heats_.begin());
  heats_.push_back({temperature_k});
  return static_cast<uint32_t>(heats_.size() - 1);
}

uint32_t ThermalCompiler::emission_row(uint32_t heat, const RegularTable& emissivity,
                                       const std::string& name) {
  SpectrumRow row;
  row.name = name;
  row.table = emissivity;
  row.bound = 1;
  if (heats_[heat].field == KB_NONE) {
    row.is_planck = row.is_emission = true;
    row.temperature_k = heats_[heat].temperature_k;
  }
  return spectra_.add(std::move(row));
}

uint32_t ThermalCompiler::black_row(uint32_t heat) {
  const auto [place, is_new] = emission_rows_.try_emplace({KB_NONE, heat}, KB_NONE);
  if (!is_new) return place->second;
  RegularTable one;  // Planck's law alone needs none
  if (heats_[heat].field != KB_NONE)
    one.min_nm = spectra_.range().min_nm, one.values = {1, 1}, one.extrapolate = true;
  return place->second = emission_row(heat, one, "black body");
}

uint32_t ThermalCompiler::complement_row(uint32_t row, uint32_t heat) {
  const auto [place, is_new] = emission_rows_.try_emplace({row, heat}, KB_NONE);
  if (!is_new) return place->second;
  RegularTable table = out_.spectra[row].table;
  for (double& value : table.values) value = 1 - value;
  // Where data are missing only guide bands can be: thermal.cpp sees to the channels.
  table.extrapolate = true;
  return place->second = emission_row(heat, table, out_.spectra[row].name + ": emissivity");
}

/// 1 - S(v) = S(-v): the complement of a sigmoid of scale 1 is the one with negated coefficients; of a flat
/// texel, 1 - its value. Lookups are linear in texels, so the complement of a lookup is
/// the lookup of complements.
uint32_t ThermalCompiler::complement_bitmap(uint32_t index, uint32_t heat) {
  KbTexture record = out_.textures[index];
  const std::size_t count = std::size_t{record.width} * record.height;
  const auto [place, is_new] = complement_texels_.try_emplace(index, 0);
  if (is_new) {
    place->second = first_texel_index(out_.texels.size(), count, {}, "complement of a reflectance");
    for (std::size_t i = 0; i < count; ++i) {
      KbFloat4 texel = out_.texels[record.first_texel + i];
      if (texel.x == 0 && texel.y == 0) {
        texel.w = 1 - texel.w;
      } else {
        texel = {-texel.x, -texel.y, -texel.z, texel.w};
      }
      out_.texels.push_back(texel);
      out_.texel_bounds.push_back(1);
    }
  }
  record.first_texel = place->second;
  record.illuminant_row = heats_[heat].field == KB_NONE ? black_row(heat) : KB_NONE;
  return textures_.add_record(record, 1 - textures_.mean_of(index), 1);
}

uint32_t ThermalCompiler::complement_checkerboard(uint32_t index, uint32_t heat) {
  KbCheckerboard record = out_.checkerboards[index];
  record.ref0 = complement_row(record.ref0 & KB_REF_INDEX_MASK, heat);
  record.ref1 = complement_row(record.ref1 & KB_REF_INDEX_MASK, heat);
  out_.checkerboards.push_back(record);
  return static_cast<uint32_t>(out_.checkerboards.size() - 1);
}

uint32_t ThermalCompiler::complement(uint32_t ref, uint32_t heat) {
  const auto [place, is_new] = complements_.try_emplace({ref, heat}, KB_NONE);
  if (!is_new) return place->second;
  const uint32_t index = ref & KB_REF_INDEX_MASK;
  if ((ref & KB_REF_KIND_MASK) == KB_REF_BITMAP) {
    place->second = KB_REF_BITMAP | complement_bitmap(index, heat);
  } else if ((ref & KB_REF_KIND_MASK) == KB_REF_CHECKERBOARD) {
    place->second = KB_REF_CHECKERBOARD | complement_checkerboard(index, heat);
  } else if (std::ranges::any_of(out_.spectra[index].table.values, [](double value) { return value < 1; })) {
    place->second = KB_REF_SPECTRUM | complement_row(index, heat);
  }
  return place->second;
}

// ---- selection of lights: estimates that only noise depends on ----

double ThermalCompiler::reference_estimate(uint32_t ref, double lambda_nm) const {
  if (ref == KB_NONE) return 0;
  const uint32_t index = ref & KB_REF_INDEX_MASK;
  const auto row = [&](uint32_t r) {
    const RegularTable& table = out_.spectra[r & KB_REF_INDEX_MASK].table;
    return table.values.empty() ? 1 : table(lambda_nm);
  };
  if ((ref & KB_REF_KIND_MASK) == KB_REF_BITMAP) return textures_.mean_of(index);
  if ((ref & KB_REF_KIND_MASK) == KB_REF_SPECTRUM) return row(index);
  return 0.5 * (row(out_.checkerboards[index].ref0) + row(out_.checkerboards[index].ref1));
}

/// At about 45 degrees.
double ThermalCompiler::emissivity_estimate(uint32_t thermal, double lambda_nm) const {
  if (thermal == KB_NONE) return 0;
  const KbThermal& record = out_.thermals[thermal];
  if (record.type == KB_THERMAL_UNIFORM) return reference_estimate(record.ref[0], lambda_nm);
  if (record.type == KB_THERMAL_NODES) {
    const float* cosines = &out_.tables[record.table];
    const auto node = std::lower_bound(cosines, cosines + record.nodes_cos, 0.7f) - cosines;
    return reference_estimate(record.first_row + static_cast<uint32_t>(node), lambda_nm);
  }
  const double r = std::pow((record.eta - 1) / (record.eta + 1), 2);
  return r * reference_estimate(record.ref[0], lambda_nm) +
         (1 - r) * reference_estimate(record.ref[1], lambda_nm);
}

/// Of a texture the mean of its values, as of all that only noise depends on.
double ThermalCompiler::mean_weight(const KbSurface& blend) const {
  if (blend.weight_ref == KB_NONE) return std::clamp<double>(blend.weight, 0, 1);
  return std::clamp(textures_.mean_of(blend.weight_ref & KB_REF_INDEX_MASK), 0.0, 1.0);
}

/// Of one side; of blends by their mean weight.
double ThermalCompiler::side_estimate(const KbSurface& surface, bool front, double lambda_nm) const {
  if (!(surface.flags & KB_SURFACE_BLEND))
    return emissivity_estimate(front ? surface.front_thermal : surface.back_thermal, lambda_nm);
  const double weight = mean_weight(surface);
  return (1 - weight) * side_estimate(out_.surfaces[surface.first], front, lambda_nm) +
         weight * side_estimate(out_.surfaces[surface.second], front, lambda_nm);
}

bool ThermalCompiler::emits(const KbSurface& surface) const {
  if (!(surface.flags & KB_SURFACE_BLEND))
    return surface.front_thermal != KB_NONE || surface.back_thermal != KB_NONE;
  return emits(out_.surfaces[surface.first]) || emits(out_.surfaces[surface.second]);
}

}  // namespace kiloband
