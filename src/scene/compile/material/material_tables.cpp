// What a material needs beside its record (shared/material_tables.h).
#include <map>
#include <tuple>

#include "scene/compile/flattener.hpp"
#include "scene/optics/coating.hpp"
#include "scene/optics/compensation.hpp"
#include "scene/optics/conductor_bound.hpp"

namespace kiloband {

uint32_t Flattener::append_table(const std::vector<float>& table) {
  const auto first = static_cast<uint32_t>(out_.tables.size());
  out_.tables.insert(out_.tables.end(), table.begin(), table.end());
  return first;
}

/// Equal coatings are computed once.
const Coating& Flattener::coating(const KbMaterial& material) {
  const auto key = std::make_tuple(material.flags & KB_MATERIAL_GGX, material.alpha_u, material.eta);
  const auto [place, is_new] = coatings_.try_emplace(key);
  if (is_new) place->second = make_coating(material);
  return place->second;
}

/// The bound of a metal, of which there may be many materials.
const std::vector<float>& Flattener::conductor_bound(const KbMaterial& material) {
  const auto [place, is_new] = conductor_bounds_.try_emplace(std::pair(material.eta_row, material.k_row));
  if (is_new) {
    place->second =
        make_conductor_bound(out_.spectra.at(material.eta_row).table, out_.spectra.at(material.k_row).table,
                             {&out_.channels, &out_.guide});
  }
  return place->second;
}

/// compensation: KB_MATERIAL_COMPENSATED, else empty
void Flattener::set_tables(KbMaterial& material, const std::vector<float>& compensation) {
  std::vector<float> table;
  if (material.type == KB_MATERIAL_ROUGH_PLASTIC) table = coating(material).transmittance;
  const bool metal = material.type == KB_MATERIAL_CONDUCTOR || material.type == KB_MATERIAL_ROUGH_CONDUCTOR;
  if (metal && !(material.flags & KB_MATERIAL_PERFECT_MIRROR)) table = conductor_bound(material);
  table.insert(table.end(), compensation.begin(), compensation.end());
  material.table = table.empty() ? KB_NONE : append_table(table);
}

}  // namespace kiloband
