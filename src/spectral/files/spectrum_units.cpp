#include "spectral/files/spectrum_units.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <vector>

#include "base/error.hpp"
#include "spectral/files/text_table.hpp"
#include "spectral/files/unit_words.hpp"

namespace kiloband {
namespace {

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
  constexpr std::array kAngstroms = {"angstrom", "angstroms"};
  if (is_one_of(word, kWavenumbers)) return WavelengthUnit::kWavenumber;
  if (is_one_of(word, kAngstroms)) return WavelengthUnit::kAngstrom;
  return std::nullopt;
}

/// Words that short units of length also are: a comment may speak of a cell of 10 cm, and people have initials.
std::optional<WavelengthUnit> long_unit_of(const UnitWord& word) {
  constexpr std::array kMetres = {"m", "meter", "meters", "metre", "metres"};
  if (word.text == "mm") return WavelengthUnit::kMillimetre;
  if (word.text == "cm" || word.text.starts_with("centimet")) return WavelengthUnit::kCentimetre;
  if (word.text == "ang") return WavelengthUnit::kAngstrom;
  if (is_one_of(word.text, kMetres) && (word.text.size() > 1 || !word.is_capital))
    return WavelengthUnit::kMetre;
  return std::nullopt;
}

bool is_wavelength(const std::string& word) {
  constexpr std::array kWords = {"wavelength", "wavelengths", "wavenumber", "wavenumbers", "lambda", "wl"};
  return is_one_of(word, kWords);
}

bool joins(const std::string& word) {
  constexpr std::array kWords = {"in", "of", "is", "are", "unit", "units"};
  return is_one_of(word, kWords);
}

using Words = std::span<const UnitWord>;

/// The next word that is more than "in".
const UnitWord* next_word(Words words, std::size_t i) {
  do ++i;
  while (i < words.size() && joins(words[i].text));
  return i < words.size() ? &words[i] : nullptr;
}

/// The first unit, which may be foreign; "wavenumber" is one where no foreign one follows at once.
struct Found {
  std::optional<WavelengthUnit> unit;
  std::string foreign;
};

Found first_unit(Words words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const UnitWord* next = is_wavelength(words[i].text) ? next_word(words, i) : nullptr;
    for (const UnitWord* word : {&words[i], next})
      if (word && word->is_foreign) return {std::nullopt, word->text};
    if (const auto unit = unit_of(words[i].text)) return {unit, {}};
  }
  return {};
}

/// mm, cm, m and Ang: in brackets, behind "wavelength", or among few words.
std::optional<WavelengthUnit> first_long_unit(Words words) {
  constexpr std::size_t kFew = 3;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const UnitWord* next = is_wavelength(words[i].text) ? next_word(words, i) : nullptr;
    if (next && long_unit_of(*next)) return long_unit_of(*next);
    if ((words[i].in_brackets || words.size() <= kFew) && long_unit_of(words[i]))
      return long_unit_of(words[i]);
  }
  return std::nullopt;
}

/// Of a text that may speak of other things; foreign units count directly behind "wavelength" alone.
Found unit_among_others(Words words) {
  constexpr std::size_t kFew = 3;
  const auto trigger = std::ranges::find_if(words, [](const UnitWord& w) { return is_wavelength(w.text); });
  if (trigger == words.end() && words.size() > kFew) return {};
  const UnitWord* next = trigger == words.end() ? nullptr : next_word({trigger, words.end()}, 0);
  if (next && next->is_foreign) return {std::nullopt, next->text};
  std::vector<UnitWord> ours;
  std::ranges::copy_if(words, std::back_inserter(ours), [](const UnitWord& w) { return !w.is_foreign; });
  const auto place = std::ranges::find_if(ours, [](const UnitWord& w) { return is_wavelength(w.text); });
  const Found after = first_unit({place, ours.end()});
  return after.unit ? after : first_unit(ours);
}

std::optional<WavelengthUnit> unit_or_error(const std::string& where, const Found& found) {
  if (!found.foreign.empty())
    throw InputError(where + ": a first column in " + quote_text(found.foreign) +
                     ": must be a wavelength in nm, um, mm, cm, m or angstrom, or a wavenumber in cm-1");
  return found.unit;
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
  const std::vector<UnitWord> words = unit_words(text);
  const Found found = first_unit(words);
  return found.unit || !found.foreign.empty() ? found.unit : first_long_unit(words);
}

bool begins_with_unit(std::string_view text) {
  const std::vector<UnitWord> words = unit_words(text);
  return !words.empty() && unit_of(words.front().text);
}

std::optional<WavelengthUnit> unit_of_column(const std::string& where, std::string_view text) {
  const std::vector<UnitWord> words = unit_words(text);
  if (const auto unit = unit_or_error(where, unit_among_others(words))) return unit;
  if (const auto unit = unit_or_error(where, first_unit(words))) return unit;
  return first_long_unit(words);
}

std::optional<WavelengthUnit> unit_in_comment(const std::string& where, std::string_view comment) {
  return unit_or_error(where, unit_among_others(unit_words(comment)));
}

}  // namespace kiloband
