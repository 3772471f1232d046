// Which units a text file states for its columns.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace kiloband {

enum class WavelengthUnit {
  kNanometre,
  kMicrometre,
  kWavenumber,
  kAngstrom,
  kMillimetre,
  kCentimetre,
  kMetre
};

/// "nm", "um", "cm-1", "angstrom", "mm", "cm", "m".
const char* unit_name(WavelengthUnit unit);
/// "wavelength 5 um" or "wavenumber 2000 cm-1", for messages.
std::string describe(double value, WavelengthUnit unit);
/// Wavelength in nm of a number in `unit`.
double to_nanometres(double value, WavelengthUnit unit);

/// The first unit of wavelength named in the text as a word of its own ("wavelength_um", "Wavelength
/// (micrometers)", "wavenumber", "cm-1"); Latin-1 and UTF-8 micro signs are understood. Lengths in a unit of
/// power ("W/m2/nm") are none.
std::optional<WavelengthUnit> find_unit(std::string_view text);
/// Whether the first word of the text is a unit of wavelength: "microns".
bool begins_with_unit(std::string_view text);
/// A unit of frequency or energy, which no column of wavelengths may have: "THz", "eV".
std::optional<std::string> find_foreign_unit(std::string_view text);
/// The same for a comment, which may speak of other things: the unit must follow a word such as "wavelength"
/// (or precede it, or stand in a comment of at most three words). mm, cm and m are not looked for.
std::optional<WavelengthUnit> find_unit_in_comment(std::string_view comment);

}  // namespace kiloband
