// Indices of refraction: numbers, Mitsuba's material names, files of optical constants.
#pragma once

#include <optional>

#include "scene/read_context.hpp"
#include "spectral/spectrum_files.hpp"

namespace kiloband {

/// A number or one of Mitsuba's names ("bk7", "water", ...). An <integer> is refused, as in Mitsuba.
/// throws InputError  unknown name; not > 0
double read_ior(const ObjectReader& object, std::string_view name, double fallback);

/// The file that a string parameter names, read as optical constants; nullopt if the parameter is absent.
/// There are no built-in materials yet: what is not an existing file is an error that says so. n must be > 0,
/// k >= 0.
std::optional<OpticalConstants> read_material_file(ReadContext& context, const ObjectReader& object,
                                                   std::string_view name);

}  // namespace kiloband
