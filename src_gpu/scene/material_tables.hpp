// Tables of scalars that materials keep beside their record on the device.
#pragma once

#include <vector>

#include "scene/compile/flat_scene.hpp"

namespace kiloband::gpu {

inline constexpr int kRoughPlasticNodes = 64;  // external transmittance at cos = i / 63
inline constexpr int kConductorCells = 64;     // bound of Fresnel's reflectance at cos = i / 64, 65 nodes

/// All tables one after another. KbMaterial::table becomes the offset of the material's, or KB_NONE:
///   rough plastic  kRoughPlasticNodes transmittances; its fdr_int becomes the rough internal reflectance
///   conductor      rough or not, unless it is a perfect mirror: kConductorCells + 1 upper bounds of the
///                  reflectance over the rendered channels and the guide bands
///   compensated    after these, the compensation table of shared/thermal.h
/// At the end come the scene's thermal tables; KbThermal::table and field_offset are moved there.
/// Equal materials share a table, unless they are compensated. A rough plastic takes about 20 ms, a metal
/// 10 us per channel.
/// throws std::logic_error  a material refers to a spectrum that is not there
std::vector<float> make_material_tables(FlatScene& scene);

}  // namespace kiloband::gpu
