// From the numbers of a column to values in our units, as far as the file states what they are.
#pragma once

#include <string>

#include "base/diagnostics.hpp"
#include "spectral/files/number_table.hpp"

namespace kiloband {

/// What a column of numbers is.
enum class ValueKind {
  kPlain,       // fractions, indices: without a unit, or percent
  kAny,         // sensor responses, endmembers: percent and units of power count, others are the user's own
  kRadiance,    // W m^-2 sr^-1 nm^-1
  kIrradiance,  // W m^-2 nm^-1
  kIntensity,   // W sr^-1 nm^-1
  kAbsorption   // 1/m
};

/// The unit that values of this kind are held in; empty for kPlain and kAny.
std::string unit_of(ValueKind kind);

struct ValueScale {
  double factor = 1;
  bool per_wavenumber = false;  // times 1e7 / lambda^2: from an interval of 1 cm-1 to one of 1 nm
  bool is_stated = false;
  bool is_percent = false;
};

/// What the text of a column's name (or of an ECOSTRESS header) says.
/// throws InputError  "where: values in 'W/m2': ..." for units that the kind cannot have
/// A power per other area or solid angle than the kind's is a warning.
ValueScale scale_of_name(const std::string& where, std::string_view name, ValueKind kind,
                         const DiagnosticSink& sink);

/// The same for a column of a table, from its name, the other lines of the header, or comments.
/// throws InputError  as above; comments that contradict each other
ValueScale scale_of_column(const NumberTable& table, std::size_t column, ValueKind kind,
                           const DiagnosticSink& sink);

/// One note (a warning for wavelengths below 100) about what the file leaves open.
void report_assumed_units(const NumberTable& table, bool wavelength_is_stated, const ValueScale& scale,
                          ValueKind kind, const DiagnosticSink& sink);

/// A warning where the file states percent and has fractions: no value above 1.
void report_small_percents(const NumberTable& table, std::size_t column, const ValueScale& scale,
                           const DiagnosticSink& sink);

/// Column `column` of the table in our units over the axis.
/// throws InputError  "file:line: value nan: must be finite"
Spectrum column_spectrum(const NumberTable& table, const WavelengthAxis& axis, std::size_t column,
                         const ValueScale& scale);

}  // namespace kiloband
