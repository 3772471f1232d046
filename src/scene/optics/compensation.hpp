// Tables of the energy that rough materials lose in single scattering (layout: shared/thermal.h).
#pragma once

#include <vector>

#include "scene/optics/coating.hpp"
#include "shared/records.h"

namespace kiloband {

/// The indices that a dielectric's table must reach: interior over exterior.
struct IndexRange {
  double min, max;
};

/// The table of a rough material. Its albedos have an error below 1e-4 for roughness 0.001 to 1, below 3e-4
/// inside dielectrics; anisotropic metals 2e-4 for ratios of the roughnesses up to 10, anisotropic
/// dielectrics 1.5e-3 for ratios up to 4. Takes about 0.1 s, anisotropic 1 s;
/// a dispersive index: 9 times that.
std::vector<float> make_compensation_table(const KbMaterial& material, const IndexRange& index);

/// Reflected part R / E of what a rough boundary scatters in a direction: tables of KB_THERMAL_ROUGH.
/// plastics: R of F, E of F = 1. Interpolation error for roughness 0.0001 to 1 and indices from
/// 1.05 on: below 7e-5 from outside; from inside 1.2e-5 in the mean over directions, at any up to index 1.5 (4) below
/// 7e-4 (2.1e-3), but 6e-3 (1.4e-2) at cosines within 0.001 of the critical angle's and 2e-3 within half a degree
/// of grazing.
std::vector<float> make_reflected_part(const KbMaterial& material);
/// Rough plastics: the diffuse base's albedo for reflectance 1 at KB_COAT_NODES cosines,
/// linear in between.
/// eta  of the coating: interior over exterior index
std::vector<float> make_coat_part(const Coating& coating, double eta);

inline bool is_anisotropic(const KbMaterial& material) {
  return material.alpha_u != material.alpha_v;
}
/// Nodes of s in all these tables.
inline uint32_t nodes_of_s(const KbMaterial& material) {
  return is_anisotropic(material) ? 17 : 1;
}

}  // namespace kiloband
