// What a material needs beside its record (shared/material_tables.h).
#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

#include "scene/compile/material/materials.hpp"
#include "scene/optics/coating.hpp"
#include "scene/optics/compensation.hpp"
#include "scene/optics/conductor_bound.hpp"
#include "scene/optics/metal_emissivity.hpp"

namespace kiloband {

uint32_t append_table(FlatScene& scene, const std::vector<float>& table) {
  const auto first = static_cast<uint32_t>(scene.tables.size());
  scene.tables.insert(scene.tables.end(), table.begin(), table.end());
  return first;
}

double largest_value(const RegularTable& table) {
  return table.values.empty() ? 1 : *std::ranges::max_element(table.values);
}

const Coating& MaterialCompiler::coating(const KbMaterial& material) {
  const auto key = std::make_tuple(material.flags & KB_MATERIAL_GGX, material.alpha_u, material.eta);
  const auto [place, is_new] = coatings_.try_emplace(key);
  if (is_new) place->second = make_coating(material);
  return place->second;
}

/// The bound of a metal, of which there may be many materials.
const std::vector<float>& MaterialCompiler::conductor_bound(const KbMaterial& material) {
  const auto [place, is_new] = conductor_bounds_.try_emplace(std::pair(material.eta_row, material.k_row));
  if (is_new) {
    place->second =
        make_conductor_bound(out_.spectra.at(material.eta_row).table, out_.spectra.at(material.k_row).table,
                             {&out_.channels, &out_.guide});
  }
  return place->second;
}

/// Single scattering scaled up to what would leave with multiple scattering; see shared/thermal.h.
std::vector<float> MaterialCompiler::compensate(KbMaterial& material, const Bsdf& bsdf) {
  material.flags |= KB_MATERIAL_COMPENSATED;
  out_.features.compensation = true;
  IndexRange index{material.eta, material.eta};
  if (material.flags & KB_MATERIAL_DISPERSIVE) {
    const auto& glass = std::get<DielectricBsdf>(bsdf.model);
    const Channel& r = spectra_.range();
    index.min = glass.int_ior.min_over(r.min_nm, r.max_nm) / glass.ext_ior.max_over(r.min_nm, r.max_nm);
    index.max = glass.int_ior.max_over(r.min_nm, r.max_nm) / glass.ext_ior.min_over(r.min_nm, r.max_nm);
  }
  std::vector<float> table = make_compensation_table(material, index);
  const bool mirror = material.flags & KB_MATERIAL_PERFECT_MIRROR;
  if (!is_metal(material) || mirror || (material.ref_a & KB_REF_KIND_MASK) != KB_REF_SPECTRUM) return table;
  const MetalEmissivity metal({out_.spectra[material.eta_row].table, out_.spectra[material.k_row].table,
                               out_.spectra[material.ref_a].table},
                              std::nullopt, spectra_.range());
  SpectrumRow row;
  row.name = describe(bsdf) + ": reflectance at normal incidence";
  row.table = metal.normal_reflectance();
  row.bound = static_cast<float>(largest_value(row.table));
  material.bound_b = row.bound;
  material.ref_b = KB_REF_SPECTRUM | spectra_.add(std::move(row), bsdf.position);
  return table;
}

/// compensation: KB_MATERIAL_COMPENSATED, else empty
void MaterialCompiler::set_tables(KbMaterial& material, const std::vector<float>& compensation) {
  std::vector<float> table;
  if (material.type == KB_MATERIAL_ROUGH_PLASTIC) table = coating(material).transmittance;
  if (is_metal(material) && !(material.flags & KB_MATERIAL_PERFECT_MIRROR)) table = conductor_bound(material);
  table.insert(table.end(), compensation.begin(), compensation.end());
  material.table = table.empty() ? KB_NONE : append_table(out_, table);
}

}  // namespace kiloband
