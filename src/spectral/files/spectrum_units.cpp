#include "spectral/files/spectrum_units.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "spectral/files/text_table.hpp"
#include "spectral/files/value_units.hpp"

namespace kiloband {
namespace {

/// Lower-case words without units of power; the ways to write micrometres and inverse centimetres made one.
std::vector<std::string> words(std::string_view text) {
  std::string plain = lowered(without_power_units(text));
  replace_all(plain, "cm^-1", "cm-1");
  replace_all(plain, "1/cm", "cm-1");
  std::vector<std::string> result;
  std::string word;
  for (const char c : plain + " ") {
    const bool in_word = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '%';
    if (in_word) {
      word += c;
    } else if (!word.empty()) {
      result.push_back(std::move(word));
      word.clear();
    }
  }
  return result;
}

template <std::size_t N>
bool is_one_of(const std::string& word, const std::array<const char*, N>& set) {
  return std::any_of(set.begin(), set.end(), [&](const char* element) { return word == element; });
}

std::optional<WavelengthUnit> unit_of(const std::string& word) {
  constexpr std::array kNm = {"nm", "nanometer", "nanometers", "nanometre", "nanometres"};
  constexpr std::array kUm = {"um",          "micrometer", "micrometers", "micrometre",
                              "micrometres", "micron",     "microns"};
  constexpr std::array kWavenumbers = {"cm-1", "wavenumber", "wavenumbers"};
  if (is_one_of(word, kNm)) return WavelengthUnit::kNanometre;
  if (is_one_of(word, kUm)) return WavelengthUnit::kMicrometre;
  constexpr std::array kAngstroms = {"angstrom", "angstroms", "ang"};
  if (is_one_of(word, kWavenumbers)) return WavelengthUnit::kWavenumber;
  if (is_one_of(word, kAngstroms)) return WavelengthUnit::kAngstrom;
  return std::nullopt;
}

/// Units that only the name of a column means: a comment may speak of a cell of 10 cm.
std::optional<WavelengthUnit> long_unit_of(const std::string& word) {
  constexpr std::array kMetres = {"m", "meter", "meters", "metre", "metres"};
  if (word == "mm") return WavelengthUnit::kMillimetre;
  if (word == "cm") return WavelengthUnit::kCentimetre;
  if (is_one_of(word, kMetres)) return WavelengthUnit::kMetre;
  return std::nullopt;
}

std::optional<WavelengthUnit> first_unit(std::span<const std::string> some_words) {
  for (const std::string& word : some_words)
    if (const auto unit = unit_of(word)) return unit;
  return std::nullopt;
}

}  // namespace

const char* unit_name(WavelengthUnit unit) {
  switch (unit) {
    case WavelengthUnit::kMicrometre:
      return "um";
    case WavelengthUnit::kWavenumber:
      return "cm-1";
    case WavelengthUnit::kAngstrom:
      return "angstrom";
    case WavelengthUnit::kMillimetre:
      return "mm";
    case WavelengthUnit::kCentimetre:
      return "cm";
    case WavelengthUnit::kMetre:
      return "m";
    default:
      return "nm";
  }
}

std::string describe(double value, WavelengthUnit unit) {
  return (unit == WavelengthUnit::kWavenumber ? "wavenumber " : "wavelength ") + format_number(value) + " " +
         unit_name(unit);
}

double to_nanometres(double value, WavelengthUnit unit) {
  switch (unit) {
    case WavelengthUnit::kMicrometre:
      return value * 1000;
    case WavelengthUnit::kWavenumber:
      return 1e7 / value;
    case WavelengthUnit::kAngstrom:
      return value / 10;
    case WavelengthUnit::kMillimetre:
      return value * 1e6;
    case WavelengthUnit::kCentimetre:
      return value * 1e7;
    case WavelengthUnit::kMetre:
      return value * 1e9;
    default:
      return value;
  }
}

std::optional<WavelengthUnit> find_unit(std::string_view text) {
  const std::vector<std::string> all = words(text);
  if (const auto unit = first_unit(all)) return unit;
  for (const std::string& word : all)
    if (const auto unit = long_unit_of(word)) return unit;
  return std::nullopt;
}

bool begins_with_unit(std::string_view text) {
  const std::vector<std::string> all = words(text);
  return !all.empty() && unit_of(all.front());
}

std::optional<std::string> find_foreign_unit(std::string_view text) {
  constexpr std::array kForeign = {"hz", "khz", "mhz", "ghz", "thz", "ev", "mev", "kev"};
  const std::vector<std::string> all = words(text);
  const auto found = std::ranges::find_if(all, [&](const auto& word) { return is_one_of(word, kForeign); });
  return found == all.end() ? std::nullopt : std::optional(*found);
}

std::optional<WavelengthUnit> find_unit_in_comment(std::string_view comment) {
  constexpr std::array kTriggers = {"wavelength", "wavelengths", "wavenumber", "wavenumbers", "lambda", "wl"};
  const std::vector<std::string> all = words(comment);
  const auto trigger =
      std::find_if(all.begin(), all.end(), [&](const std::string& w) { return is_one_of(w, kTriggers); });
  if (trigger == all.end()) return all.size() <= 3 ? first_unit(all) : std::nullopt;
  if (const auto after = first_unit({trigger, all.end()})) return after;
  return first_unit(all);
}

}  // namespace kiloband
