#include "cube/exr/exr_names.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"

namespace kiloband {
namespace {

constexpr double kLightSpeed = 299792458;  // m/s, exact

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Power of ten of an SI prefix that the layout allows.
std::optional<int> prefix_exponent(std::string_view prefix) {
  constexpr std::array<std::pair<std::string_view, int>, 17> kPrefixes = {{{"", 0},
                                                                           {"Y", 24},
                                                                           {"Z", 21},
                                                                           {"E", 18},
                                                                           {"P", 15},
                                                                           {"T", 12},
                                                                           {"G", 9},
                                                                           {"M", 6},
                                                                           {"k", 3},
                                                                           {"h", 2},
                                                                           {"da", 1},
                                                                           {"d", -1},
                                                                           {"c", -2},
                                                                           {"m", -3},
                                                                           {"u", -6},
                                                                           {"n", -9},
                                                                           {"p", -12}}};
  for (const auto& [name, exponent] : kPrefixes)
    if (name == prefix) return exponent;
  return std::nullopt;
}

/// Wavelength in nm of value * 10^exponent in metres or hertz. Nanometres stay as they are written.
double to_nm(double value, int exponent, bool hertz) {
  if (hertz) return kLightSpeed * 1e9 / (value * std::pow(10.0, exponent));
  const int shift = exponent + 9;
  if (shift == 0) return value;
  return without_roundings(shift > 0 ? value * std::pow(10.0, shift) : value / std::pow(10.0, -shift));
}

/// As written, and as a wavelength.
struct NumberWithUnit {
  double value, nm;
};

/// "\d*<decimal>?\d*([Ee][+-]?\d+)?" and a unit of length or frequency; the whole text.
std::optional<NumberWithUnit> parse_with_unit(std::string_view text, char decimal) {
  std::string number;
  std::size_t i = 0, digits = 0;
  bool decimal_seen = false;
  for (; i < text.size(); ++i) {
    if (is_digit(text[i]))
      ++digits;
    else if (text[i] != decimal || decimal_seen)
      break;
    else
      decimal_seen = true;
    number += is_digit(text[i]) ? text[i] : '.';
  }
  if (i < text.size() && (text[i] == 'E' || text[i] == 'e')) {
    std::size_t j = i + 1;
    if (j < text.size() && (text[j] == '+' || text[j] == '-')) ++j;
    const std::size_t first = j;
    while (j < text.size() && is_digit(text[j])) ++j;
    if (j > first) {  // otherwise the E is the prefix exa
      number += text.substr(i, j - i);
      i = j;
    }
  }
  std::string_view unit = text.substr(i);
  // What is left before the unit's letter must be a prefix, or nothing.
  const bool hertz = unit.ends_with("Hz");
  if (digits == 0 || (!hertz && !unit.ends_with('m'))) return std::nullopt;
  const auto exponent = prefix_exponent(unit.substr(0, unit.size() - (hertz ? 2 : 1)));
  const auto value = parse_number(number);
  if (!exponent || !value) return std::nullopt;
  const double nm = to_nm(*value, *exponent, hertz);
  if (!(nm > 0) || !std::isfinite(nm)) return std::nullopt;
  return NumberWithUnit{*value, nm};
}

}  // namespace

std::optional<SpectralName> parse_spectral_name(std::string_view name) {
  SpectralName result;
  if (name.starts_with("T.")) {
    result.kind = 'T';
    name.remove_prefix(2);
  } else if (name.size() > 3 && name[0] == 'S' && name[1] >= '0' && name[1] <= '3' && name[2] == '.') {
    result.stokes = name[1] - '0';
    name.remove_prefix(3);
  } else {
    return std::nullopt;
  }
  const auto number = parse_with_unit(name, ',');
  if (!number) return std::nullopt;
  result.value = number->value;
  result.centre_nm = number->nm;
  return result;
}

std::string spectral_name(double centre_nm) {
  std::array<char, 400> text;
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), centre_nm, std::chars_format::fixed, 6).ptr;
  std::replace(text.data(), end, '.', ',');
  return "S0." + std::string(text.data(), end) + "nm";
}

std::vector<std::string> exr_band_names(const std::vector<Band>& bands) {
  std::vector<std::string> names;
  names.reserve(bands.size());
  for (const Band& band : bands)
    names.push_back(band.derived ? "response." + band.channel.name : spectral_name(band.channel.centre_nm()));
  return make_unique_names(std::move(names));
}

std::string sensitivity_text(const Channel& channel) {
  return format_number(channel.min_nm) + "nm:1;" + format_number(channel.max_nm) + "nm:1;";
}

std::optional<Sensitivity> parse_sensitivity(std::string_view text) {
  std::vector<std::pair<double, double>> points;  // nm, response
  for (const std::string_view part : split(text, ';')) {
    if (trimmed(part).empty()) continue;
    const std::size_t colon = part.find(':');
    if (colon == std::string_view::npos) return std::nullopt;
    const auto wavelength = parse_with_unit(trimmed(part.substr(0, colon)), '.');
    const auto response = parse_number(part.substr(colon + 1));
    if (!wavelength || !response) return std::nullopt;
    points.emplace_back(wavelength->nm, *response);
  }
  if (points.size() < 2) return std::nullopt;
  const auto [low, high] = std::minmax_element(points.begin(), points.end());
  if (!(low->first < high->first)) return std::nullopt;
  const bool box = std::all_of(points.begin(), points.end(),
                               [&](const auto& point) { return point.second == points.front().second; });
  return Sensitivity{low->first, high->first, box};
}

}  // namespace kiloband
