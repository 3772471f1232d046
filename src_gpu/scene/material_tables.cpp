#include "src_gpu/scene/material_tables.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "shared/fresnel.h"
#include "src_gpu/scene/rough_transmittance.hpp"

namespace kiloband::gpu {
namespace {

/// The index may vary inside a channel, which can carry F a little over its values
/// at the ends and the middle.
constexpr float kSlack = 1.002f;

class Builder {
 public:
  explicit Builder(FlatScene& scene) : scene_(scene) {}

  std::vector<float> build() {
    for (KbMaterial& material : scene_.materials) {
      const uint32_t compensation = material.table;
      material.table = KB_NONE;
      if (material.type == KB_MATERIAL_ROUGH_PLASTIC) add_rough_plastic(material);
      const bool metal =
          material.type == KB_MATERIAL_CONDUCTOR || material.type == KB_MATERIAL_ROUGH_CONDUCTOR;
      if (metal && !(material.flags & KB_MATERIAL_PERFECT_MIRROR)) add_conductor(material);
      if (material.flags & KB_MATERIAL_COMPENSATED) add_compensation(material, compensation);
    }
    add_thermals();
    return std::move(tables_);
  }

 private:
  struct RoughPlastic {
    uint32_t table;
    float internal_reflectance;
  };

  uint32_t append(const std::vector<float>& values) {
    const auto offset = static_cast<uint32_t>(tables_.size());
    tables_.insert(tables_.end(), values.begin(), values.end());
    return offset;
  }

  /// Behind a copy of the material's other table.
  void add_compensation(KbMaterial& material, uint32_t first) {
    std::vector<float> table;
    if (material.table != KB_NONE) {
      const bool plastic = material.type == KB_MATERIAL_ROUGH_PLASTIC;
      const auto begin = tables_.begin() + material.table;
      table.assign(begin, begin + (plastic ? kRoughPlasticNodes : kConductorCells + 1));
    }
    const float* source = &scene_.thermal_tables.at(first);
    const std::size_t sides = material.type == KB_MATERIAL_ROUGH_DIELECTRIC ? 2 : 1;
    const std::size_t nodes =
        sides * static_cast<std::size_t>(source[0]) * static_cast<std::size_t>(source[1]);
    table.insert(table.end(), source, source + KB_COMPENSATION_HEADER + nodes * KB_COMPENSATION_NODES);
    material.table = append(table);
  }

  void add_thermals() {
    const uint32_t shift = append(scene_.thermal_tables);
    for (KbThermal& thermal : scene_.thermals) {
      if (thermal.table != KB_NONE) thermal.table += shift;
      thermal.field_offset += shift;
    }
  }

  void add_rough_plastic(KbMaterial& material) {
    const auto key = std::make_tuple(material.distribution, material.alpha_u, material.eta);
    auto found = rough_plastics_.find(key);
    if (found == rough_plastics_.end()) {
      const RoughTransmittance made = make_rough_transmittance(material);
      const RoughPlastic plastic{append(made.external), made.internal_reflectance};
      found = rough_plastics_.emplace(key, plastic).first;
    }
    material.table = found->second.table;
    material.fdr_int = found->second.internal_reflectance;
  }

  void add_conductor(KbMaterial& material) {
    const auto key = std::make_pair(material.eta_row, material.k_row);
    auto found = conductors_.find(key);
    if (found == conductors_.end())
      found = conductors_.emplace(key, append(reflectance_bound(material))).first;
    material.table = found->second;
  }

  /// F falls from normal incidence to a minimum and rises to 1 at grazing incidence, so that nodes bound what
  /// is between them.
  std::vector<float> reflectance_bound(const KbMaterial& material) const {
    const RegularTable& n = scene_.spectra.at(material.eta_row).table;
    const RegularTable& k = scene_.spectra.at(material.k_row).table;
    std::vector<float> bound(kConductorCells + 1, 0.0f);
    for (const ChannelList* list : {&scene_.channels, &scene_.guide})
      for (const Channel& channel : *list)
        for (const double lambda_nm : {channel.min_nm, channel.centre_nm(), channel.max_nm})
          raise(bound, static_cast<float>(n(lambda_nm)), static_cast<float>(k(lambda_nm)));
    return bound;
  }

  static void raise(std::vector<float>& bound, float n, float k) {
    for (int i = 0; i <= kConductorCells; ++i) {
      const float f = kb_fresnel_conductor(static_cast<float>(i) / kConductorCells, n, k);
      bound[i] = std::max(bound[i], f <= 1 ? std::min(1.0f, kSlack * f) : 1.0f);  // NaN: 1
    }
  }

  FlatScene& scene_;
  std::vector<float> tables_;
  std::map<std::tuple<uint32_t, float, float>, RoughPlastic> rough_plastics_;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> conductors_;
};

}  // namespace

std::vector<float> make_material_tables(FlatScene& scene) {
  return Builder(scene).build();
}

}  // namespace kiloband::gpu
