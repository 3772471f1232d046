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
/// (micrometers)", "wavenumber", "cm-1"); the ways to write them: unit_words.hpp. Lengths in a unit of power ("W/m2/nm") are none. mm, cm, m
/// and Ang count in brackets, behind "wavelength" and among at most three words. Empty where a foreign unit comes first.
std::optional<WavelengthUnit> find_unit(std::string_view text);
/// Whether the first word of the text is a unit of wavelength: "microns".
bool begins_with_unit(std::string_view text);
/// The unit of a first column with this name, or in a file with these header lines.
/// throws InputError  "where: a first column in 'THz': ...": frequencies, energies, inverse lengths other than cm-1, powers of ten
std::optional<WavelengthUnit> unit_of_column(const std::string& where, std::string_view text);
/// The same for a comment, which may speak of other things: the unit must follow a word such as "wavelength"
/// (or precede it, or stand in a comment of at most three words), a foreign one directly. mm, cm and m are not looked for.
std::optional<WavelengthUnit> unit_in_comment(const std::string& where, std::string_view comment);

}  // namespace kiloband
