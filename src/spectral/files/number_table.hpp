// A text file of numbers in columns, the first of which is a wavelength: parsing, and sorting by wavelength.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.hpp"
#include "spectral/files/spectrum_units.hpp"
#include "spectral/spectrum.hpp"

namespace kiloband {

struct NumberTable {
  std::filesystem::path file;
  std::vector<std::string> names;  // of the columns, from the last header line; empty without one
  std::vector<std::vector<std::string>> headers;  // the fields of every header line
  std::vector<std::string> comments;              // without '#', header lines included
  std::size_t columns = 0;
  std::size_t row_fields = 0;   // fields of the first row, those that are not read included
  std::size_t row_values = 0;   // of these, those that are not empty
  bool has_points = false;      // in a number of any row
  bool has_commas = false;      // between the fields of the first row
  std::vector<double> numbers;  // rows x columns
  std::vector<int> lines;       // where each row stands

  std::size_t rows() const { return lines.size(); }
  double at(std::size_t row, std::size_t column) const { return numbers[row * columns + column]; }
};

/// How many columns a file must and may have. With `ignore_more` what follows the last column is skipped
/// unread, otherwise all rows have as many as the first one.
struct ColumnRule {
  std::size_t min_columns = 2;
  std::size_t max_columns = 2;
  bool ignore_more = true;
};

/// Parses lines of numbers; '#' comments;
/// up to three header lines (no field of them is a number) before the first row.
/// first_line  number of the text's first line in the file
/// throws InputError  "file:line: ..." with the first thing that is wrong
NumberTable parse_number_table(const std::filesystem::path& file, std::string_view text,
                               const ColumnRule& rule, int first_line = 1);

/// What the header says about a column: its names, from the last line to the first, or the whole header where
/// its lines have other fields than the rows.
std::string column_text(const NumberTable& table, std::size_t column);

/// The place of the first column from the second on whose name in a header line has one of these words (lower
/// case), before a bracket or, if asked, anywhere.
std::optional<std::size_t> column_with_word(const NumberTable& table, std::span<const std::string_view> words,
                                            bool in_brackets = false);

/// throws InputError  "file:line: ...": numbers with decimal commas between commas, which would be further columns
void refuse_decimal_commas(const NumberTable& table);

/// throws InputError  a table of one row, which is no spectrum
void require_two_rows(const NumberTable& table);

/// The unit of the first column as the file states it: its name, RADIS's wavenumber range, comments. Nothing
/// stated: nm is meant.
/// throws InputError  a unit of frequency or energy; comments that contradict each other
std::optional<WavelengthUnit> stated_wavelength_unit(const NumberTable& table);

/// Whether RADIS wrote the file.
bool is_from_radis(const NumberTable& table);

/// Wavelengths of the rows in nm, ascending, and the rows' order for it.
struct WavelengthAxis {
  std::vector<double> lambda_nm;
  bool reversed = false;  // the file's last row comes first
};

/// throws InputError  for wavelengths that are not positive and finite, repeated, or change direction
WavelengthAxis wavelength_axis(const std::filesystem::path& file, const std::vector<double>& raw,
                               const std::vector<int>& lines, WavelengthUnit unit);

/// The axis of a table in the unit that its file states, or nm.
WavelengthAxis axis_in(const NumberTable& table, std::optional<WavelengthUnit> stated);

/// A column as it stands in the file.
/// throws InputError  "file:line: value nan: must be finite"
std::vector<double> finite_column(const NumberTable& table, std::size_t column);

/// The first column.
std::vector<double> first_column(const NumberTable& table);

}  // namespace kiloband
