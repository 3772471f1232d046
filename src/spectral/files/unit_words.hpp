// The words of a text that may state a unit of wavelength.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kiloband {

struct UnitWord {
  std::string text;          // in lower case; "cm-1" for all ways to write it
  bool is_foreign = false;   // a unit in which no wavelength can be: `text` as the file spells it
  bool in_brackets = false;  // alone in round or square ones
  bool is_capital = false;   // begins with a capital letter
};

/// In order, without units of power, whose lengths are no wavelengths. "cm-1" is also written "cm^{-1}", "1 / cm", "per cm"; other inverse
/// lengths ("1/um", "rad/cm") and powers of ten ("10^-7 m") are foreign, as are frequencies and energies.
std::vector<UnitWord> unit_words(std::string_view text);

}  // namespace kiloband
