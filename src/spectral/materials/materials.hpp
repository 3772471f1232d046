// Built-in optical constants: metals and transparent materials by name. docs/materials.md lists them.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "spectral/files/spectrum_files.hpp"

namespace kiloband {

/// What is known of a material beside its numbers. Outside [min_nm, max_nm] it has none.
struct BuiltInMaterial {
  std::string_view name;  // "Au"
  std::string_view substance;
  double min_nm, max_nm;
  std::string_view source;
};

/// In the order of their names as listed in the documentation.
std::vector<BuiltInMaterial> built_in_metals();
std::vector<BuiltInMaterial> built_in_dielectrics();

/// n and k (always given) of a metal: the model's interpolation error is below 1e-5 of the value. Capital and
/// small letters are the same. Nothing for an unknown name.
std::optional<OpticalConstants> find_metal(std::string_view name);
/// Index of refraction of a transparent material; formulas are tabulated with an error below 1e-6.
std::optional<Spectrum> find_dielectric(std::string_view name);

}  // namespace kiloband
