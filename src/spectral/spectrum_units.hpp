// Which units a text file states for its columns.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace kiloband {

enum class WavelengthUnit { kNanometre, kMicrometre, kWavenumber };

/// "nm", "um", "cm-1".
const char* unit_name(WavelengthUnit unit);
/// "wavelength 5 um" or "wavenumber 2000 cm-1", for messages.
std::string describe(double value, WavelengthUnit unit);
/// Wavelength in nm of a number in `unit`.
double to_nanometres(double value, WavelengthUnit unit);

/// The first unit of wavelength named in the text as a word of its own ("wavelength_um", "Wavelength
/// (micrometers)", "wavenumber", "cm-1"); Latin-1 and UTF-8 micro signs are understood.
std::optional<WavelengthUnit> find_unit(std::string_view text);
/// The same for a comment, which may speak of other things: the unit must follow a word such as "wavelength"
/// (or precede it, or stand in a comment of at most three words).
std::optional<WavelengthUnit> find_unit_in_comment(std::string_view comment);

/// Whether a column's name says percent.
bool says_percent(std::string_view name);
/// Whether a comment says that values are in percent.
bool comment_says_percent(std::string_view comment);

}  // namespace kiloband
