// Units that a text states for values: "W/m2/micron", "mW cm-2 sr-1 um-1", "1/cm".
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace kiloband {

/// A unit of power per interval of wavelength or wavenumber, or an inverse length.
struct ValueUnit {
  std::string text;              // as the file spells it
  double factor = 1;             // to W, m^2, sr and nm or cm-1; of an inverse length: to 1/m
  bool per_area = false;         // power per m^2
  bool per_solid_angle = false;  // power per sr
  bool per_wavenumber = false;   // an interval of wavenumber in cm-1, not of wavelength
  bool is_understood = true;     // false: a unit, but none of these ("photons/s/cm2/nm", "W/m2", "W/m2/Hz")
  bool is_scaled = false;   // a power of ten stands before or behind it: "10^-3 W/m2/nm", "W/m2/nm x 1000"
  std::size_t factors = 0;  // units that it is made of, W/m2/nm: 3
};

/// The first unit of power in the text that is understood, or else the first. Factors are joined by "/",
/// "per", blanks, "*", "." or "_"; what follows a slash stands below it unless its exponent is negative
/// ("W/m2 sr um"); "cm-1" is a wavenumber. Latin-1 and UTF-8 spellings of micro,
/// superscripts and middle dots are understood.
std::optional<ValueUnit> find_power_unit(std::string_view text);

/// The first inverse length in the text: "1/m", "cm-1", "km^-1", "per cm".
std::optional<ValueUnit> find_inverse_length(std::string_view text);

/// The text without its units of power, whose lengths are no wavelengths.
std::string without_power_units(std::string_view text);

}  // namespace kiloband
