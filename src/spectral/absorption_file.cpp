// Absorption coefficients of gases from files: two columns whose second is in 1/m, or in 1/cm if the file
// says so.
#include <algorithm>
#include <array>

#include "spectral/number_table.hpp"
#include "spectral/spectrum_files.hpp"
#include "spectral/text_table.hpp"

namespace kiloband {
namespace {

constexpr double kPerCentimetre = 100;

/// The place of the first of some texts, or npos.
template <std::size_t N>
std::size_t find_first(std::string_view text, const std::array<std::string_view, N>& wanted) {
  std::size_t first = std::string_view::npos;
  for (const std::string_view w : wanted) first = std::min(first, text.find(w));
  return first;
}

/// 100 or 1 for the first inverse length that the (lower-case) text names within its first characters.
std::optional<double> inverse_length(std::string_view text) {
  constexpr std::size_t kNear = 40;
  constexpr std::array<std::string_view, 4> kCm = {"cm-1", "cm^-1", "1/cm", "cm\xE2\x81\xBB\xC2\xB9"};
  constexpr std::array<std::string_view, 4> kM = {"m-1", "m^-1", "1/m", "m\xE2\x81\xBB\xC2\xB9"};
  text = text.substr(0, kNear);
  const std::size_t cm = find_first(text, kCm), m = find_first(text, kM);
  if (cm < m) return kPerCentimetre;
  if (m != std::string_view::npos) return 1;
  return std::nullopt;
}

/// What a comment says about the unit: behind the quantity's name.
std::optional<double> stated_in(const std::string& comment) {
  constexpr std::array<std::string_view, 2> kQuantities = {"abscoeff", "absorption"};
  const std::string text = lowered(comment);
  const std::size_t at = find_first(text, kQuantities);
  return at == std::string::npos ? std::nullopt : inverse_length(std::string_view(text).substr(at));
}

/// RADIS writes absorption coefficients in 1/cm, and does not always say so.
bool is_from_radis(const NumberTable& table) {
  const auto has = [&](std::string_view word) {
    return std::ranges::any_of(table.comments,
                               [&](const std::string& c) { return c.find(word) != std::string::npos; });
  };
  return has("wavenum_min") && has("abscoeff");
}

double value_factor(const NumberTable& table) {
  if (table.names.size() > 1)
    if (const auto factor = inverse_length(lowered(table.names[1]))) return *factor;
  for (const std::string& comment : table.comments)
    if (const auto factor = stated_in(comment)) return *factor;
  return is_from_radis(table) ? kPerCentimetre : 1;
}

}  // namespace

Spectrum read_absorption_file(const std::filesystem::path& file, const DiagnosticSink& sink) {
  const NumberTable table = parse_number_table(file, read_text_file(file), {2, 2, true});
  const WavelengthAxis axis =
      wavelength_axis(file, first_column(table), table.lines, wavelength_unit(table, sink));
  return column_spectrum(table, axis, 1, value_factor(table));
}

}  // namespace kiloband
