// Refractive index and extinction coefficient: refractiveindex.info YAML and plain text.
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "spectral/dispersion_formula.hpp"
#include "spectral/files/number_table.hpp"
#include "spectral/files/spectrum_files.hpp"
#include "spectral/files/text_table.hpp"
#include "spectral/files/value_scale.hpp"

namespace kiloband {
namespace {

constexpr std::size_t kMaxYamlBytes = std::size_t{1} << 26;

/// What has been found so far; each of n and k at most once.
struct Found {
  std::optional<Spectrum> n, k;
};

void set_once(const std::filesystem::path& file, std::optional<Spectrum>& target, Spectrum spectrum,
              const char* what) {
  if (target) throw InputError(file.string() + ": " + what + " is given twice");
  target = std::move(spectrum);
}

void require_physical(const std::filesystem::path& file, const Spectrum& spectrum, const char* what) {
  const bool is_n = std::string_view(what) == "n";
  for (std::size_t i = 0; i < spectrum.knots_nm().size(); ++i) {
    const double value = spectrum.knot_values()[i];
    if (value < 0 || (is_n && value == 0))
      throw InputError(file.string() + ": " + what + " " + format_number(value) + " at " +
                       format_number(spectrum.knots_nm()[i]) + " nm: must be " +
                       (is_n ? "positive" : "at least 0"));
  }
}

/// A scalar entry of a DATA item; empty text if it is missing.
std::string entry(const std::filesystem::path& file, const YAML::Node& item, const char* key) {
  const YAML::Node node = item[key];
  if (!node) return {};
  if (!node.IsScalar())
    throw InputError(at_line(file, node.Mark().line + 1, std::string(key) + ": must be text"));
  return node.Scalar();
}

std::vector<double> numbers_of(const std::string& where, std::string_view text) {
  std::vector<double> result;
  for (const std::string_view field : split_fields(text)) {
    const std::optional<double> number = to_number(field);
    if (!number || !std::isfinite(*number))
      throw InputError(where + ": " + quote_text(field) + " is not a finite number");
    result.push_back(*number);
  }
  return result;
}

/// "wavelength_range: 0.3 2.5" (older files: "range"), micrometres.
std::pair<double, double> formula_range(const std::filesystem::path& file, const std::string& where,
                                        const YAML::Node& item) {
  std::string text = entry(file, item, "wavelength_range");
  if (text.empty()) text = entry(file, item, "range");
  const std::vector<double> range = numbers_of(where, text);
  if (range.size() != 2 || !(range[0] > 0) || !(range[0] < range[1]) || range[1] > 1e6)
    throw InputError(where + ": wavelength_range " + quote_text(text) +
                     ": must be two increasing wavelengths in um");
  return {range[0], range[1]};
}

void read_formula(const std::filesystem::path& file, const YAML::Node& item, const std::string& type,
                  Found& found) {
  const std::string where = file.string() + ":" + std::to_string(item.Mark().line + 1);
  const std::optional<double> number = to_number(std::string_view(type).substr(8));
  if (!number || *number != std::floor(*number) || *number < 1 || *number > 9)
    throw InputError(where + ": " + quote_text(type) + ": must be formula 1 to 9");
  const int formula = static_cast<int>(*number);
  const auto [min_um, max_um] = formula_range(file, where, item);
  const std::vector<double> coefficients = numbers_of(where, entry(file, item, "coefficients"));
  if (coefficients.empty() || coefficients.size() > max_coefficients(formula))
    throw InputError(where + ": " + std::to_string(coefficients.size()) + " coefficients: formula " +
                     std::to_string(formula) + " has 1 to " + std::to_string(max_coefficients(formula)));
  set_once(file, found.n, tabulate_formula(where, formula, coefficients, min_um, max_um), "n");
}

/// Averages consecutive rows of the same wavelength.
void merge_repeated(NumberTable& table, const DiagnosticSink& sink) {
  NumberTable merged = table;
  merged.numbers.clear();
  merged.lines.clear();
  for (std::size_t row = 0, end = 0; row < table.rows(); row = end) {
    for (end = row + 1; end < table.rows() && table.at(end, 0) == table.at(row, 0);) ++end;
    for (std::size_t column = 0; column < table.columns; ++column) {
      double sum = 0;
      for (std::size_t same = row; same < end; ++same) sum += table.at(same, column);
      merged.numbers.push_back(column == 0 ? table.at(row, 0) : sum / static_cast<double>(end - row));
    }
    merged.lines.push_back(table.lines[row]);
    if (end > row + 1)
      warn(sink, {table.file.string(), table.lines[row], 0},
           describe(table.at(row, 0), WavelengthUnit::kMicrometre) + ": " + std::to_string(end - row) +
               " rows are averaged");
  }
  table = std::move(merged);
}

void read_tabulated(const std::filesystem::path& file, const YAML::Node& item, const std::string& type,
                    Found& found, const DiagnosticSink& sink) {
  const bool has_n = type == "tabulated n" || type == "tabulated nk";
  const bool has_k = type == "tabulated k" || type == "tabulated nk";
  const std::size_t columns = has_n && has_k ? 3 : 2;
  const std::string text = entry(file, item, "data");
  // A block scalar's text starts in the line after its key.
  const int first_line = text.empty() ? 1 : item["data"].Mark().line + 2;
  NumberTable table = parse_number_table(file, text, {columns, columns, true}, first_line);
  merge_repeated(table, sink);
  const WavelengthAxis axis =
      wavelength_axis(file, first_column(table), table.lines, WavelengthUnit::kMicrometre);
  if (has_n) set_once(file, found.n, column_spectrum(table, axis, 1, {}), "n");
  if (has_k) set_once(file, found.k, column_spectrum(table, axis, columns - 1, {}), "k");
}

Found read_yaml(const std::filesystem::path& file, const std::string& text, const DiagnosticSink& sink) {
  const YAML::Node root = YAML::Load(text);
  const YAML::Node data = root.IsMap() ? root["DATA"] : YAML::Node();
  if (!data || !data.IsSequence()) throw InputError(file.string() + ": has no list DATA");
  Found found;
  for (const YAML::Node& item : data) {
    const std::string where = file.string() + ":" + std::to_string(item.Mark().line + 1);
    if (!item.IsMap()) throw InputError(where + ": an entry of DATA must have a type");
    const std::string type = entry(file, item, "type");
    if (type.starts_with("formula ")) {
      read_formula(file, item, type, found);
    } else if (type == "tabulated n" || type == "tabulated k" || type == "tabulated nk") {
      read_tabulated(file, item, type, found, sink);
    } else {
      throw InputError(where + ": type " + quote_text(type) +
                       ": must be tabulated n, k, nk or formula 1 to 9");
    }
  }
  return found;
}

/// Columns of n and k, 0 where a file has none: those that its header names, or the second and the third.
struct NkColumns {
  std::size_t n = 1, k = 0;
};

/// throws InputError  a header that names permittivities
NkColumns nk_columns(const NumberTable& table) {
  constexpr std::array<std::string_view, 8> kEps = {"eps", "eps1", "eps2",         "epsilon",
                                                    "e1",  "e2",   "permittivity", "dielectric"};
  constexpr std::array<std::string_view, 6> kN = {"n", "nr", "re", "ior", "index", "refractive"};
  constexpr std::array<std::string_view, 5> kK = {"k", "ki", "im", "kappa", "extinction"};
  if (column_with_word(table, kEps, true))
    throw InputError(table.file.string() + ": the header names a permittivity: n and k are needed");
  const auto n = column_with_word(table, kN), k = column_with_word(table, kK);
  if (!n && !k) return {1, table.row_values > 2 ? std::size_t{2} : 0};
  if (!n) throw InputError(table.file.string() + ": the header names k and no n");
  return {*n, k.value_or(0)};
}

Found read_text(const std::filesystem::path& file, const std::string& text, const DiagnosticSink& sink) {
  NumberTable table = parse_number_table(file, text, {2, 3, true});
  refuse_decimal_commas(table);
  const NkColumns columns = nk_columns(table);
  const std::size_t last = std::max(columns.n, columns.k);
  if (last >= table.columns) table = parse_number_table(file, text, {last + 1, last + 1, true});
  const auto unit = stated_wavelength_unit(table);
  report_assumed_units(table, unit.has_value(), {}, ValueKind::kPlain, sink);
  const WavelengthAxis axis = axis_in(table, unit);
  const bool is_named = table.names.size() == table.row_fields;
  // By its own name alone: comments and other columns speak of the reflectances that n and k come from, in percent.
  const auto in_column = [&](std::size_t column) {
    const ValueScale scale =
        is_named ? scale_of_name(file.string(), table.names[column], ValueKind::kPlain, sink) : ValueScale{};
    report_small_percents(table, column, scale, sink);
    return column_spectrum(table, axis, column, scale);
  };
  Found found;
  found.n = in_column(columns.n);
  if (columns.k > 0) found.k = in_column(columns.k);
  return found;
}

}  // namespace

OpticalConstants read_optical_constants(const std::filesystem::path& file, const DiagnosticSink& sink) {
  const std::string extension = lowered_extension(file);
  const bool yaml = extension == ".yml" || extension == ".yaml";
  const std::string text = read_text_file(file, yaml ? kMaxYamlBytes : kMaxTextBytes);
  Found found;
  try {
    found = yaml ? read_yaml(file, text, sink) : read_text(file, text, sink);
  } catch (const YAML::Exception& error) {
    throw InputError(at_line(file, std::max(error.mark.line, 0) + 1, "not valid YAML: " + error.msg));
  }
  if (!found.n) throw InputError(file.string() + ": gives no n");
  require_physical(file, *found.n, "n");
  if (found.k) require_physical(file, *found.k, "k");
  return {std::move(*found.n), std::move(found.k)};
}

}  // namespace kiloband
