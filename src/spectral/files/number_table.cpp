#include "spectral/files/number_table.hpp"

#include <algorithm>
#include <cmath>

#include "spectral/files/powers_of_ten.hpp"
#include "spectral/files/text_table.hpp"

namespace kiloband {
namespace {

constexpr std::size_t kMaxHeaderLines = 3;
constexpr const char* kHeaderRule =
    " (before the first row at most 3 lines without numbers are skipped; others must begin with '#')";

bool has_number(const std::vector<std::string_view>& fields) {
  return std::any_of(fields.begin(), fields.end(),
                     [](std::string_view f) { return to_number(f).has_value(); });
}

/// Whether it may belong to a header: numbers with commas, quotes or exponents of other languages do not.
bool begins_a_word(std::string_view field) {
  const std::string first = lowered(field.substr(0, 1));
  return !first.empty() && first[0] >= 'a' && first[0] <= 'z';
}

/// The first row says how many columns there are, within the rule.
void set_columns(NumberTable& table, std::size_t fields, const ColumnRule& rule, int line) {
  if (!rule.ignore_more && fields > rule.max_columns)
    throw InputError(at_line(table.file, line, "more than " + std::to_string(rule.max_columns) + " columns"));
  table.columns = std::max(rule.min_columns, std::min(fields, rule.max_columns));
}

void append_row(NumberTable& table, const std::vector<std::string_view>& fields, const ColumnRule& rule,
                int line) {
  if (table.columns == 0) set_columns(table, fields.size(), rule, line);
  if (fields.size() < table.columns || (!rule.ignore_more && fields.size() > table.columns))
    throw InputError(at_line(table.file, line,
                             std::to_string(fields.size()) + " columns: must be " +
                                 (rule.ignore_more ? "at least " : "") + std::to_string(table.columns)));
  for (std::size_t column = 0; column < table.columns; ++column) {
    const std::optional<double> number = to_number(fields[column]);
    if (!number)
      throw InputError(at_line(table.file, line,
                               quote_text(fields[column]) + " is not a number" +
                                   (table.rows() == 0 && begins_a_word(fields[column]) ? kHeaderRule : "")));
    table.numbers.push_back(*number);
  }
  table.lines.push_back(line);
}

/// The fields of a header line; commas between quotes separate nothing.
std::vector<std::string> header_fields(std::string_view line) {
  std::vector<std::string> fields;
  if (line.find('"') == std::string_view::npos) {
    for (const std::string_view field : split_fields(line)) fields.emplace_back(field);
    return fields;
  }
  std::string field;
  bool is_quoted = false;
  for (const char c : line) {
    if (c == '"') {
      is_quoted = !is_quoted;
    } else if ((c == ',' || c == ';' || c == '\t') && !is_quoted) {
      fields.emplace_back(trimmed(field));
      field.clear();
    } else {
      field += c;
    }
  }
  fields.emplace_back(trimmed(field));
  return fields;
}

/// "Wavelength, microns" over two columns: the second field begins with the unit of the first.
bool unit_has_a_field_of_its_own(const NumberTable& table) {
  return table.names.size() > 1 && !find_unit(table.names[0]) && begins_with_unit(table.names[1]);
}

/// A number that RADIS writes in its header: `"wavenum_min": 2082.76` or `wavenum_min 2082.76 cm-1`.
std::optional<double> radis_number(const std::vector<std::string>& comments, std::string_view key) {
  for (const std::string& comment : comments) {
    const std::size_t at = comment.find(key);
    if (at == std::string::npos) continue;
    const std::size_t begin = comment.find_first_not_of("\": \t", at + key.size());
    if (begin == std::string::npos) continue;
    const std::size_t end = comment.find_first_not_of("0123456789.eE+-", begin);
    if (const auto number = to_number(std::string_view(comment).substr(begin, end - begin))) return number;
  }
  return std::nullopt;
}

/// RADIS states the range of wavenumbers whatever the unit of the first column is:
/// the one that fits the range is meant.
std::optional<WavelengthUnit> radis_unit(const NumberTable& table) {
  const std::optional<double> min = radis_number(table.comments, "wavenum_min");
  const std::optional<double> max = radis_number(table.comments, "wavenum_max");
  if (!min || !max || table.rows() == 0) return std::nullopt;
  for (const WavelengthUnit unit : {WavelengthUnit::kWavenumber, WavelengthUnit::kNanometre}) {
    const double wavenumber = 1e7 / to_nanometres(table.at(0, 0), unit);
    if (wavenumber > 0.99 * *min && wavenumber < 1.01 * *max) return unit;
  }
  return std::nullopt;
}

std::optional<WavelengthUnit> unit_in_comments(const NumberTable& table) {
  std::optional<WavelengthUnit> found;
  for (const std::string& comment : table.comments) {
    const std::optional<WavelengthUnit> unit = unit_in_comment(table.file.string(), comment);
    if (found && unit && *unit != *found)
      throw InputError(table.file.string() + ": comments give wavelengths in " + unit_name(*found) +
                       " and in " + unit_name(*unit));
    if (!found) found = unit;
  }
  return found;
}

}  // namespace

NumberTable parse_number_table(const std::filesystem::path& file, std::string_view text,
                               const ColumnRule& rule, int first_line) {
  NumberTable table;
  table.file = file;
  std::size_t header_lines = 0;
  LineReader lines(text);
  for (std::string_view line; lines.next(line);) {
    const std::size_t hash = line.find('#');
    if (hash != std::string_view::npos) table.comments.emplace_back(trimmed(line.substr(hash + 1)));
    line = trimmed(line.substr(0, hash));
    if (line.empty()) continue;
    const std::vector<std::string_view> fields = split_fields(line, rule.max_columns + 1);
    if (table.rows() == 0 && header_lines < kMaxHeaderLines && !has_number(fields)) {
      ++header_lines;
      table.names = header_fields(line);
      table.headers.push_back(table.names);
      continue;
    }
    if (table.rows() == 0) {
      const std::vector<std::string_view> all = split_fields(line);
      table.row_fields = all.size();
      table.row_values = all.size() - static_cast<std::size_t>(std::ranges::count(all, std::string_view()));
      table.has_commas = line.find(',') != std::string_view::npos;
    }
    table.has_points = table.has_points || line.find('.') != std::string_view::npos;
    append_row(table, fields, rule, first_line - 1 + lines.line_number());
  }
  if (table.rows() == 0) throw InputError(file.string() + ": no data");
  return table;
}

std::string column_text(const NumberTable& table, std::size_t column) {
  std::string of_column, whole;
  for (auto line = table.headers.rbegin(); line != table.headers.rend(); ++line) {
    std::string joined;
    for (const std::string& field : *line) joined += (joined.empty() ? "" : " ") + field;
    whole = joined + " ; " + whole;
    const bool is_title = std::ranges::any_of(*line, [](const std::string& field) { return field.empty(); });
    const bool is_parted = std::ranges::any_of(*line, is_bare_power_of_ten);  // from its unit, at a blank
    if (line->size() == table.row_fields && !is_title && !is_parted) of_column += line->at(column) + " ; ";
  }
  return of_column.empty() || unit_has_a_field_of_its_own(table) ? whole : of_column;
}

std::optional<std::size_t> column_with_word(const NumberTable& table, std::span<const std::string_view> words,
                                            bool in_brackets) {
  for (std::size_t column = 1; column < table.row_fields; ++column)
    for (const std::vector<std::string>& line : table.headers) {
      if (line.size() != table.row_fields) continue;
      const std::string& whole = line[column];
      const std::string name =
          lowered(in_brackets ? whole : whole.substr(0, whole.find_first_of("([", 1))) + " ";
      std::string word;
      for (const char c : name) {
        const bool in_word = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
        if (in_word) word += c;
        if (!in_word && std::ranges::find(words, word) != words.end()) return column;
        if (!in_word) word.clear();
      }
    }
  return std::nullopt;
}

void refuse_decimal_commas(const NumberTable& table) {
  const bool is_named = !table.names.empty() && table.names.size() == table.row_fields;
  if (!table.has_commas || table.has_points || is_named || table.row_values < 3 || table.rows() < 2) return;
  const bool is_header_short = !table.names.empty() && table.names.size() < table.row_fields;
  bool is_fraction = true;
  for (std::size_t row = 0; row < table.rows(); ++row)
    is_fraction = is_fraction && (table.at(row, 1) == 0 || table.at(row, 1) == 1);
  if (is_header_short || is_fraction)
    throw InputError(
        at_line(table.file, table.lines.front(),
                "numbers with decimal commas between commas: write points, or ';' between columns"));
}

void require_two_rows(const NumberTable& table) {
  if (table.rows() < 2)
    throw InputError(at_line(table.file, table.lines.front(), "one row: a spectrum needs at least 2"));
}

std::optional<WavelengthUnit> stated_wavelength_unit(const NumberTable& table) {
  if (const auto unit = unit_of_column(table.file.string(), column_text(table, 0))) return *unit;
  if (const auto unit = radis_unit(table)) return *unit;
  return unit_in_comments(table);
}

bool is_from_radis(const NumberTable& table) {
  const auto has = [&](std::string_view word) {
    return std::ranges::any_of(table.comments,
                               [&](const std::string& c) { return c.find(word) != std::string::npos; });
  };
  return has("wavenum_min") && has("abscoeff");
}

WavelengthAxis wavelength_axis(const std::filesystem::path& file, const std::vector<double>& raw,
                               const std::vector<int>& lines, WavelengthUnit unit) {
  const bool falling = raw.size() > 1 && raw[1] < raw[0];
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const std::string what = describe(raw[i], unit);
    if (!std::isfinite(raw[i]) || raw[i] <= 0)
      throw InputError(at_line(file, lines[i], what + ": must be finite and positive"));
    if (i > 0 && raw[i] == raw[i - 1]) throw InputError(at_line(file, lines[i], what + " is repeated"));
    if (i > 0 && (raw[i] < raw[i - 1]) != falling)
      throw InputError(at_line(
          file, lines[i],
          what + " after " + format_number(raw[i - 1]) + " " + unit_name(unit) + ": the order changes"));
  }
  WavelengthAxis axis;
  axis.reversed = falling != (unit == WavelengthUnit::kWavenumber);
  for (const double value : raw) axis.lambda_nm.push_back(to_nanometres(value, unit));
  if (axis.reversed) std::reverse(axis.lambda_nm.begin(), axis.lambda_nm.end());
  // Conversion rounds: two neighbours may have become one, and a denormal wavenumber infinite.
  for (std::size_t i = 0; i < axis.lambda_nm.size(); ++i)
    if (!std::isfinite(axis.lambda_nm[i]) || (i > 0 && axis.lambda_nm[i - 1] >= axis.lambda_nm[i]))
      throw InputError(file.string() + ": wavelength " + format_number(axis.lambda_nm[i]) +
                       " nm: not finite or not distinct");
  return axis;
}

WavelengthAxis axis_in(const NumberTable& table, std::optional<WavelengthUnit> stated) {
  return wavelength_axis(table.file, first_column(table), table.lines,
                         stated.value_or(WavelengthUnit::kNanometre));
}

std::vector<double> finite_column(const NumberTable& table, std::size_t column) {
  std::vector<double> values(table.rows());
  for (std::size_t row = 0; row < table.rows(); ++row) {
    values[row] = table.at(row, column);
    if (!std::isfinite(values[row]))
      throw InputError(
          at_line(table.file, table.lines[row], "value " + format_number(values[row]) + ": must be finite"));
  }
  return values;
}

std::vector<double> first_column(const NumberTable& table) {
  std::vector<double> result(table.rows());
  for (std::size_t row = 0; row < table.rows(); ++row) result[row] = table.at(row, 0);
  return result;
}

}  // namespace kiloband
