// Indices of refraction: numbers, Mitsuba's material names, built-in materials, files of optical constants.
#pragma once

#include <optional>

#include "scene/read/context.hpp"
#include "spectral/files/spectrum_files.hpp"

namespace kiloband {

/// A number or one of Mitsuba's names ("bk7", "water", ...). An <integer> is refused, as in Mitsuba.
/// throws InputError  unknown name; not > 0
double read_ior(const ObjectReader& object, std::string_view name, double fallback);

enum class MaterialFamily { kMetal, kDielectric };

/// The optical constants that a string parameter names; nullopt if the parameter is absent. A value with '.'
/// or '/' and the name of an existing file are files, all else built-in materials of the family.
/// n must be > 0, k >= 0; metals have k. With the boolean parameter `extrapolate` the end values
/// continue outside the data.
/// throws InputError  neither a file nor a built-in name (with names near it)
std::optional<OpticalConstants> read_material(ReadContext& context, const ObjectReader& object,
                                              std::string_view name, MaterialFamily family);

/// n and k by Mitsuba's name of a conductor, the parameter `material`, from the built-in metals, with a note, since Mitsuba's data
/// are others; `extrapolate` as above. nullopt if it is absent or "none", the perfect mirror.
/// throws InputError  none of the built-in metals
std::optional<OpticalConstants> read_conductor_name(ReadContext& context, const ObjectReader& object);

/// throws InputError at `place`  n or k of a conductor is above kMaxMetalIndex
void check_metal_index(const Spectrum& spectrum, const std::string& label, const Place& place);

/// The index of a conductor: eta and k, Mitsuba's name, a built-in metal or a file, or the perfect mirror.
/// throws InputError  more than one of these; values out of range
void read_metal(ReadContext& context, const ObjectReader& object, ConductorBsdf& bsdf);

}  // namespace kiloband
