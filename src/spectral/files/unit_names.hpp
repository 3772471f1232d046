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

/// "W", "mW" and "MW", which case tells apart; all others in any case.
std::optional<KnownUnit> known_unit(std::string_view name);

/// The same text in ASCII: "u" for micro, digits for superscripts, "*" for dots, "angstrom" for its sign.
std::string units_in_ascii(std::string_view text);

}  // namespace kiloband
