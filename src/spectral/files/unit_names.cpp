#include "spectral/files/unit_names.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "spectral/files/text_table.hpp"

namespace kiloband {
namespace {

constexpr KnownUnit kUnits[] = {{"w", Dimension::kPower, 1},
                                {"mw", Dimension::kPower, 1e-3},
                                {"uw", Dimension::kPower, 1e-6},
                                {"nw", Dimension::kPower, 1e-9},
                                {"kw", Dimension::kPower, 1e3},
                                {"watt", Dimension::kPower, 1},
                                {"watts", Dimension::kPower, 1},
                                {"milliwatt", Dimension::kPower, 1e-3},
                                {"milliwatts", Dimension::kPower, 1e-3},
                                {"microwatt", Dimension::kPower, 1e-6},
                                {"microwatts", Dimension::kPower, 1e-6},
                                {"kilowatt", Dimension::kPower, 1e3},
                                {"kilowatts", Dimension::kPower, 1e3},
                                {"j", Dimension::kEnergy, 1},
                                {"erg", Dimension::kEnergy, 1e-7},
                                {"ergs", Dimension::kEnergy, 1e-7},
                                {"s", Dimension::kTime, 1},
                                {"sec", Dimension::kTime, 1},
                                {"m", Dimension::kLength, 1},
                                {"meter", Dimension::kLength, 1},
                                {"meters", Dimension::kLength, 1},
                                {"metre", Dimension::kLength, 1},
                                {"metres", Dimension::kLength, 1},
                                {"km", Dimension::kLength, 1e3},
                                {"cm", Dimension::kLength, 1e-2},
                                {"mm", Dimension::kLength, 1e-3},
                                {"um", Dimension::kLength, 1e-6},
                                {"micron", Dimension::kLength, 1e-6},
                                {"microns", Dimension::kLength, 1e-6},
                                {"micrometer", Dimension::kLength, 1e-6},
                                {"micrometers", Dimension::kLength, 1e-6},
                                {"micrometre", Dimension::kLength, 1e-6},
                                {"micrometres", Dimension::kLength, 1e-6},
                                {"nm", Dimension::kLength, 1e-9},
                                {"nanometer", Dimension::kLength, 1e-9},
                                {"nanometers", Dimension::kLength, 1e-9},
                                {"nanometre", Dimension::kLength, 1e-9},
                                {"nanometres", Dimension::kLength, 1e-9},
                                {"angstrom", Dimension::kLength, 1e-10},
                                {"angstroms", Dimension::kLength, 1e-10},
                                {"ang", Dimension::kLength, 1e-10},
                                {"wavenumber", Dimension::kWavenumber, 1},
                                {"sr", Dimension::kSolidAngle, 1},
                                {"ster", Dimension::kSolidAngle, 1},
                                {"steradian", Dimension::kSolidAngle, 1},
                                {"steradians", Dimension::kSolidAngle, 1},
                                {"hz", Dimension::kOther, 1},
                                {"khz", Dimension::kOther, 1},
                                {"mhz", Dimension::kOther, 1},
                                {"ghz", Dimension::kOther, 1},
                                {"thz", Dimension::kOther, 1},
                                {"ev", Dimension::kOther, 1},
                                {"photon", Dimension::kOther, 1},
                                {"photons", Dimension::kOther, 1},
                                {"quanta", Dimension::kOther, 1},
                                {"mol", Dimension::kOther, 1},
                                {"molecule", Dimension::kOther, 1},
                                {"molecules", Dimension::kOther, 1},
                                {"molec", Dimension::kOther, 1},
                                {"atm", Dimension::kOther, 1},
                                {"ppm", Dimension::kOther, 1},
                                {"db", Dimension::kOther, 1}};

constexpr KnownUnit kMegawatt{"MW", Dimension::kPower, 1e6};

}  // namespace

std::string units_in_ascii(std::string_view text) {
  constexpr std::pair<std::string_view, std::string_view> kSpellings[] = {{"\xE2\x81\xBB", "-"},
                                                                          {"\xE2\x88\x92", "-"},
                                                                          {"\xE2\x8B\x85", "*"},
                                                                          {"\xE2\x84\xAB", "angstrom"},
                                                                          {"\xC3\x85", "angstrom"},
                                                                          {"\xC2\xB5", "u"},
                                                                          {"\xCE\xBC", "u"},
                                                                          {"\xC2\xB9", "1"},
                                                                          {"\xC2\xB2", "2"},
                                                                          {"\xC2\xB3", "3"},
                                                                          {"\xC2\xB7", "*"},
                                                                          {"\xC2\xA0", " "},
                                                                          {"\xB5", "u"},
                                                                          {"\xB9", "1"},
                                                                          {"\xB2", "2"},
                                                                          {"\xB3", "3"},
                                                                          {"\xB7", "*"},
                                                                          {"\xC5", "angstrom"},
                                                                          {"**", "^"}};
  std::string result(text);
  for (const auto& [from, to] : kSpellings) replace_all(result, from, to);
  return result;
}

std::optional<KnownUnit> known_unit(std::string_view name) {
  if (name == kMegawatt.name) return kMegawatt;
  const std::string lower = lowered(name);
  const auto* found = std::ranges::find(kUnits, std::string_view(lower), &KnownUnit::name);
  return found == std::end(kUnits) ? std::nullopt : std::optional(*found);
}

}  // namespace kiloband
