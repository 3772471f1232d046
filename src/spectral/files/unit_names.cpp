#include "spectral/files/unit_names.hpp"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

#include "base/utf8.hpp"
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
                                {"centimeter", Dimension::kLength, 1e-2},
                                {"centimeters", Dimension::kLength, 1e-2},
                                {"centimetre", Dimension::kLength, 1e-2},
                                {"centimetres", Dimension::kLength, 1e-2},
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

using Spelling = std::pair<std::string_view, std::string_view>;

constexpr Spelling kSuperscripts[] = {{"\xE2\x81\xBB", "-"}, {"\xE2\x81\xBA", "+"}, {"\xE2\x81\xB0", "0"},
                                      {"\xC2\xB9", "1"},     {"\xC2\xB2", "2"},     {"\xC2\xB3", "3"},
                                      {"\xE2\x81\xB4", "4"}, {"\xE2\x81\xB5", "5"}, {"\xE2\x81\xB6", "6"},
                                      {"\xE2\x81\xB7", "7"}, {"\xE2\x81\xB8", "8"}, {"\xE2\x81\xB9", "9"}};
constexpr Spelling kUtf8[] = {
    {"\xC3\x85ngstr\xC3\xB6m", "angstrom"},
    {"\xC3\xA5ngstr\xC3\xB6m", "angstrom"},
    {"\xE2\x88\x92", "-"},  // minus, hyphens and the en dash that editors make of one
    {"\xE2\x80\x90", "-"},
    {"\xE2\x80\x91", "-"},
    {"\xE2\x80\x92", "-"},
    {"\xE2\x80\x93", "-"},
    {"\xE2\x8B\x85", "*"},
    {"\xC2\xB7", "*"},
    {"\xC3\x97", "x"},
    {"\xE2\x84\xAB", "angstrom"},
    {"\xC3\x85", "angstrom"},
    {"A\xCC\x8A", "angstrom"},
    {"\xC2\xB5", "u"},
    {"\xCE\xBC", "u"},
    {"\xC2\xA0", " "},
    {"\xE2\x80\xAF", " "}};
constexpr Spelling kLatin1[] = {{"\xC5ngstr\xF6m", "angstrom"},
                                {"\xE5ngstr\xF6m", "angstrom"},
                                {"\xB5", "u"},
                                {"\xB9", "1"},
                                {"\xB2", "2"},
                                {"\xB3", "3"},
                                {"\xB7", "*"},
                                {"\xD7", "x"},
                                {"\xC5", "angstrom"},
                                {"\xA0", " "}};

constexpr Spelling kSquares[] = {{"square meter", "m2"},
                                 {"square metre", "m2"},
                                 {"square centimeter", "cm2"},
                                 {"square centimetre", "cm2"}};

void replace(std::string& text, std::span<const Spelling> spellings) {
  for (const auto& [from, to] : spellings) replace_all(text, from, to);
}

/// "cm -1", as copied from a page: "cm-1".
std::string with_joined_exponents(const std::string& text) {
  std::string result;
  for (std::size_t at = 0; at < text.size(); ++at) {
    std::size_t sign = at;
    const bool behind_letter = !result.empty() && is_ascii_letter(result.back());
    while (behind_letter && sign < text.size() && text[sign] == ' ') ++sign;
    const auto digit_at = [&](std::size_t i) { return i < text.size() && is_ascii_digit(text[i]); };
    const bool exponent = sign > at && sign < text.size() && text[sign] == '-' && digit_at(sign + 1) &&
                          !digit_at(sign + 2) && (sign + 2 >= text.size() || text[sign + 2] != '.');
    if (exponent) at = sign;
    result += text[at];
  }
  return result;
}

}  // namespace

std::string units_in_ascii(std::string_view text) {
  std::string result(text);
  replace(result, kUtf8);
  for (const auto& [superscript, digit] : kSuperscripts)  // of a power of ten; behind a unit it needs no sign
    replace_all(result, "10" + std::string(superscript), "10^" + std::string(digit));
  replace(result, kSuperscripts);
  if (!is_utf8(text)) replace(result, kLatin1);
  replace_all(result, "**", "^");
  replace(result, kSquares);
  std::erase(result, '$');
  return with_joined_exponents(result);
}

std::optional<int> take_exponent(std::string_view text, std::size_t& at) {
  std::size_t p = at;
  const bool marked = p < text.size() && text[p] == '^';
  if (marked) ++p;
  const bool wrapped = marked && p < text.size() && (text[p] == '{' || text[p] == '(');
  if (wrapped) ++p;
  const bool negative = p < text.size() && text[p] == '-';
  if (negative || (p < text.size() && text[p] == '+')) ++p;
  if (p >= text.size() || !is_ascii_digit(text[p]) || (p + 1 < text.size() && is_ascii_digit(text[p + 1])))
    return std::nullopt;
  const int value = text[p++] - '0';
  if (wrapped && p < text.size() && (text[p] == '}' || text[p] == ')')) ++p;
  at = p;
  return negative ? -value : value;
}

std::optional<KnownUnit> known_unit(std::string_view name) {
  if (name == kMegawatt.name) return kMegawatt;
  const std::string lower = lowered(name);
  const auto* found = std::ranges::find(kUnits, std::string_view(lower), &KnownUnit::name);
  return found == std::end(kUnits) ? std::nullopt : std::optional(*found);
}

}  // namespace kiloband
