// Names of units as text files write them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace kiloband {

enum class Dimension { kPower, kEnergy, kTime, kLength, kWavenumber, kSolidAngle, kOther };

struct KnownUnit {
  std::string_view name;  // lower case
  Dimension dimension;    // kOther: a unit that nothing here can be measured in
  double scale;           // to W, J, s, m, sr
};

constexpr bool is_ascii_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
constexpr bool is_ascii_digit(char c) {
  return c >= '0' && c <= '9';
}

/// "W", "mW" and "MW", which case tells apart; all others in any case.
std::optional<KnownUnit> known_unit(std::string_view name);

/// The same text in ASCII: "u" for micro, digits for superscripts, "*" for dots, "-" for typographic signs, "angstrom" for its sign; without the
/// dollars of LaTeX, and "cm-1" for "cm -1". What is no UTF-8 is taken for Latin-1.
std::string units_in_ascii(std::string_view text);

/// An exponent of one digit in such a text, "2", "-2", "^-2", "^{-2}", "^(-2)": moves `at` behind it; empty where there is none.
std::optional<int> take_exponent(std::string_view text, std::size_t& at);

}  // namespace kiloband
