#include "spectral/files/spectrum_files.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "spectral/files/number_table.hpp"
#include "spectral/files/text_table.hpp"
#include "spectral/files/value_scale.hpp"

namespace kiloband {
namespace {

constexpr std::size_t kMaxResponseColumns = 4097;  // the wavelength and 4096 responses

/// The part of an ECOSTRESS file above its data.
struct EcostressHeader {
  std::string x_units, y_units;  // empty where missing
  std::optional<double> count;
  std::size_t bytes = 0;  // length up to the first data line
  int lines = 0;
};

/// "Key: value" with the key given in lower case: the value.
std::optional<std::string_view> value_of(std::string_view line, std::string_view key) {
  if (!lowered(line.substr(0, key.size())).starts_with(key)) return std::nullopt;
  return trimmed(line.substr(key.size()));
}

/// An ECOSTRESS file begins with "Key: value" lines up to a line that starts with a number.
/// source  ECOSTRESS spectral library (Meerdink et al. 2019), header of its files
EcostressHeader parse_ecostress_header(std::string_view text) {
  constexpr int kMaxLines = 200;
  EcostressHeader header;
  LineReader lines(text);
  for (std::string_view line; header.lines < kMaxLines && lines.next(line);) {
    const std::vector<std::string_view> fields = split_fields(line, 2);
    if (!fields.empty() && to_number(fields.front())) break;
    if (const auto value = value_of(line, "x units:")) header.x_units = *value;
    if (const auto value = value_of(line, "y units:")) header.y_units = *value;
    if (const auto value = value_of(line, "number of x values:")) header.count = to_number(*value);
    header.lines = lines.line_number();
    header.bytes = std::min(text.size(), static_cast<std::size_t>(line.data() + line.size() - text.data()));
  }
  return header;
}

/// What an opaque surface does not reflect.
void warn_of_other_quantity(const NumberTable& table, std::string_view name, const DiagnosticSink& sink) {
  for (const char* quantity : {"emissivity", "emittance", "absorbance", "absorptance", "absorptivity"})
    if (lowered(name).find(quantity) != std::string::npos)
      return warn(sink, {table.file.string(), 0, 0},
                  std::string("values are read as a reflectance, the file states ") + quantity);
}

Spectrum read_ecostress(const std::filesystem::path& file, std::string_view text,
                        const EcostressHeader& header, ValueKind kind, const DiagnosticSink& sink) {
  const std::optional<WavelengthUnit> unit = find_unit(header.x_units);
  if (!unit)
    throw InputError(file.string() + ": X Units " + quote_text(header.x_units) +
                     ": must name nm, micrometers or cm-1");
  // What is left of the header's last line is its ending: an empty first line.
  const NumberTable table =
      parse_number_table(file, text.substr(header.bytes), {2, 2, true}, std::max(header.lines, 1));
  if (header.count && *header.count != static_cast<double>(table.rows()))
    throw InputError(file.string() + ": the header states " + format_number(*header.count) +
                     " values, the file has " + std::to_string(table.rows()));
  const WavelengthAxis axis = wavelength_axis(file, first_column(table), table.lines, *unit);
  const ValueScale scale = scale_of_name(file.string(), header.y_units, kind, sink);
  report_assumed_units(table, true, scale, kind, sink);
  report_small_percents(table, 1, scale, sink);
  if (kind == ValueKind::kPlain) warn_of_other_quantity(table, header.y_units, sink);
  return column_spectrum(table, axis, 1, scale);
}

/// The response of one detector in a MODIS table, in file order.
struct Detector {
  std::vector<double> wavelength, response;
  std::vector<int> lines;
};

bool is_modis(const NumberTable& table) {
  return std::any_of(table.comments.begin(), table.comments.end(), [](const std::string& comment) {
    return lowered(comment).find("band channel wavelength rsr") != std::string::npos;
  });
}

/// MODIS relative spectral responses: rows of band, detector, wavelength, response; -99 where nothing was
/// measured. The files give nm for the reflective bands and um for the thermal ones without saying so: the
/// two cannot be confused, since the instrument sees 0.4 to 14.4 um.
std::vector<std::pair<std::string, Spectrum>> modis_responses(const NumberTable& table) {
  constexpr double kMissing = -99, kLargestMicrometres = 100;
  std::map<std::pair<double, double>, Detector> detectors;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.at(row, 3) == kMissing) continue;
    for (std::size_t column = 0; column < 4; ++column)
      if (!std::isfinite(table.at(row, column)))
        throw InputError(at_line(table.file, table.lines[row],
                                 "value " + format_number(table.at(row, column)) + ": must be finite"));
    Detector& detector = detectors[{table.at(row, 0), table.at(row, 1)}];
    detector.wavelength.push_back(table.at(row, 2));
    detector.response.push_back(table.at(row, 3));
    detector.lines.push_back(table.lines[row]);
  }
  std::vector<std::pair<std::string, Spectrum>> result;
  for (auto& [key, detector] : detectors) {
    const bool micrometres = detector.wavelength.front() < kLargestMicrometres;
    const WavelengthAxis axis =
        wavelength_axis(table.file, detector.wavelength, detector.lines,
                        micrometres ? WavelengthUnit::kMicrometre : WavelengthUnit::kNanometre);
    if (axis.reversed) std::reverse(detector.response.begin(), detector.response.end());
    result.emplace_back("band" + format_number(key.first) + "_detector" + format_number(key.second),
                        Spectrum::tabulated(axis.lambda_nm, detector.response));
  }
  if (result.empty()) throw InputError(table.file.string() + ": no data");
  return result;
}

/// Sums over channels are single precision in the end.
void check_response(const std::filesystem::path& file, const std::string& name, const Spectrum& response) {
  constexpr double kLargest = 1e15;
  for (std::size_t i = 0; i < response.knots_nm().size(); ++i)
    if (std::abs(response.knot_values()[i]) > kLargest)
      throw InputError(file.string() + ": response " + quote_text(name) + " " +
                       format_number(response.knot_values()[i]) + " at " +
                       format_number(response.knots_nm()[i]) + " nm: must be from -1e+15 to 1e+15");
}

/// Names of the responses: the header's, or the file's stem (numbered if there are several).
std::vector<std::string> response_names(const NumberTable& table) {
  std::vector<std::string> names;
  const std::string stem = table.file.stem().string();
  const bool named = table.names.size() == table.columns;
  if (!named && !table.names.empty() && table.columns > 2)
    throw InputError(table.file.string() + ": the header names " + std::to_string(table.names.size()) +
                     " columns, the rows have " + std::to_string(table.columns));
  std::set<std::string> seen;
  for (std::size_t column = 1; column < table.columns; ++column) {
    std::string name = table.columns == 2 ? stem : stem + "_" + std::to_string(column);
    if (named) name = table.names[column];
    if (name.empty())
      throw InputError(table.file.string() + ": column " + std::to_string(column + 1) + " has no name");
    if (!seen.insert(name).second)
      throw InputError(table.file.string() + ": column name " + quote_text(name) + " is repeated");
    names.push_back(std::move(name));
  }
  return names;
}

/// Which of several columns is read.
void report_columns(const NumberTable& table, const DiagnosticSink& sink) {
  if (table.row_values < 3) return;
  const SourcePosition position{table.file.string(), 0, 0};
  const std::string count = std::to_string(table.row_values) + " columns";
  const bool is_named = table.names.size() == table.row_fields;
  const std::string name = is_named ? table.names[1] : std::string();
  if (find_unit(name) || lowered(name).find("wavelength") != std::string::npos)
    warn(sink, position, count + ": " + quote_text(name) + " is read, and the first as wavelengths");
  else if (is_named)
    note(sink, position, count + ": " + quote_text(name) + " is read");
  else
    warn(sink, position, count + " without names of their own: the second is read");
}

}  // namespace

Spectrum read_spectrum_file(const std::filesystem::path& file, ValueKind kind, const DiagnosticSink& sink) {
  const std::string text = read_text_file(file);
  const std::string extension = lowered_extension(file);
  if (extension == ".yml" || extension == ".yaml")
    throw InputError(file.string() +
                     ": a file of n and k, which a material reads ('metal', 'int_material'): " +
                     "a spectrum is a table of two columns");
  const EcostressHeader header = parse_ecostress_header(text);
  if (!header.x_units.empty() && !header.y_units.empty())
    return read_ecostress(file, text, header, kind, sink);
  const NumberTable table = parse_number_table(file, text, {2, 2, true});
  refuse_decimal_commas(table);
  const auto unit = stated_wavelength_unit(table);
  const ValueScale scale = scale_of_column(table, 1, kind, sink);
  report_assumed_units(table, unit.has_value(), scale, kind, sink);
  report_small_percents(table, 1, scale, sink);
  report_columns(table, sink);
  if (kind == ValueKind::kPlain && !table.names.empty())
    warn_of_other_quantity(table, column_text(table, 1), sink);
  Spectrum spectrum = column_spectrum(table, axis_in(table, unit), 1, scale);
  require_two_rows(table);
  return spectrum;
}

std::vector<std::pair<std::string, Spectrum>> read_response_file(const std::filesystem::path& file,
                                                                 const DiagnosticSink& sink) {
  const std::string text = read_text_file(file);
  const NumberTable table = parse_number_table(file, text, {2, kMaxResponseColumns, false});
  if (is_modis(table) && table.columns == 4) return modis_responses(table);
  const auto unit = stated_wavelength_unit(table);
  report_assumed_units(table, unit.has_value(), {}, ValueKind::kAny, sink);
  const WavelengthAxis axis = axis_in(table, unit);
  const std::vector<std::string> names = response_names(table);
  std::vector<std::pair<std::string, Spectrum>> result;
  for (std::size_t column = 1; column < table.columns; ++column) {
    const ValueScale scale = scale_of_column(table, column, ValueKind::kAny, sink);
    report_small_percents(table, column, scale, sink);
    result.emplace_back(names[column - 1], column_spectrum(table, axis, column, scale));
    check_response(file, result.back().first, result.back().second);
  }
  require_two_rows(table);
  return result;
}

}  // namespace kiloband
