#include "spectral/files/value_scale.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "spectral/files/percent.hpp"
#include "spectral/files/text_table.hpp"
#include "spectral/files/value_units.hpp"

namespace kiloband {
namespace {

constexpr double kFromPercent = 0.01;

std::string quoted(const ValueUnit& unit) {
  return "values in " + quote_text(unit.text);
}

void refuse_factor(const std::string& where, const ValueUnit& unit) {
  if (unit.is_scaled)
    throw InputError(where + ": " + quoted(unit) +
                     ": write the values without the factor, in the unit alone");
}

/// "W/m2" and "W m-2", not the initials "J M".
bool is_quotient(const ValueUnit& unit) {
  return unit.factors >= 2 && unit.text.find_first_of("/^-0123456789") != std::string::npos;
}

bool is_power(ValueKind kind) {
  return kind == ValueKind::kRadiance || kind == ValueKind::kIrradiance || kind == ValueKind::kIntensity;
}

ValueScale percent_scale(bool percent) {
  return percent ? ValueScale{kFromPercent, false, true, true} : ValueScale{};
}

std::optional<ValueScale> absorption_scale(const std::string& where, std::string_view text) {
  const std::optional<ValueUnit> unit = find_inverse_length(text);
  if (!unit) return std::nullopt;
  refuse_factor(where, *unit);
  if (!unit->is_understood)
    throw InputError(where + ": " + quoted(*unit) +
                     ": an absorption coefficient must be in 1/m, 1/cm, 1/mm or 1/km");
  return ValueScale{unit->factor, false, true};
}

/// Other areas or solid angles than the kind's are a different quantity;
/// its factor is the best that can be done.
void check_quantity(const std::string& where, const ValueUnit& unit, ValueKind kind,
                    const DiagnosticSink& sink) {
  if (!is_power(kind)) return;
  const bool area = kind != ValueKind::kIntensity, angle = kind != ValueKind::kIrradiance;
  if (unit.per_area == area && unit.per_solid_angle == angle) return;
  warn(sink, {where, 0, 0}, quoted(unit) + " are read as " + unit_of(kind) + ": another quantity");
}

ValueScale power_scale(const std::string& where, const ValueUnit& unit, ValueKind kind,
                       const DiagnosticSink& sink) {
  refuse_factor(where, unit);
  if (!unit.is_understood)
    throw InputError(where + ": " + quoted(unit) +
                     ": must be power per interval of wavelength or wavenumber, such as W/m2/sr/nm");
  check_quantity(where, unit, kind, sink);
  return {unit.factor, unit.per_wavenumber, true};
}

bool comments_say_percent(const NumberTable& table) {
  return std::ranges::any_of(table.comments, comment_says_percent);
}

/// RADIS lists the units of all its quantities: "radiance": "mW/cm2/sr/nm".
std::optional<ValueUnit> listed_unit(const NumberTable& table, std::size_t column) {
  if (table.names.size() <= column) return std::nullopt;
  const std::string key = '"' + table.names[column] + "\": \"";
  for (const std::string& comment : table.comments) {
    const std::size_t at = comment.find(key);
    if (at == std::string::npos) continue;
    const std::string_view rest = std::string_view(comment).substr(at + key.size());
    return find_power_unit(rest.substr(0, rest.find('"')));
  }
  return std::nullopt;
}

/// The one unit of power that comments speak of;
/// units of two factors (a lamp of 1000 W/m2) only if they are one.
std::optional<ValueUnit> unit_in_comments(const NumberTable& table) {
  std::optional<ValueUnit> found;
  for (const std::string& comment : table.comments) {
    const std::optional<ValueUnit> unit = find_power_unit(comment);
    if (!unit || (!unit->is_understood && unit->factors < 3)) continue;
    const bool other =
        found && (unit->factor != found->factor || unit->per_wavenumber != found->per_wavenumber);
    if (other)
      throw InputError(table.file.string() + ": comments give values in " + quote_text(found->text) +
                       " and in " + quote_text(unit->text));
    if (!found) found = unit;
  }
  return found;
}

/// A comment states the unit of an absorption behind the quantity's name.
ValueScale absorption_in_comments(const NumberTable& table) {
  constexpr std::size_t kNear = 40;
  constexpr std::array<std::string_view, 2> kQuantities = {"abscoeff", "absorption"};
  for (const std::string& comment : table.comments) {
    const std::string text = lowered(comment);
    std::size_t at = std::string::npos;
    for (const std::string_view quantity : kQuantities) at = std::min(at, text.find(quantity));
    if (at == std::string::npos) continue;
    if (const auto scale = absorption_scale(table.file.string(), std::string_view(comment).substr(at, kNear)))
      return *scale;
  }
  return {};
}

}  // namespace

std::string unit_of(ValueKind kind) {
  switch (kind) {
    case ValueKind::kRadiance:
      return "W m^-2 sr^-1 nm^-1";
    case ValueKind::kIrradiance:
      return "W m^-2 nm^-1";
    case ValueKind::kIntensity:
      return "W sr^-1 nm^-1";
    case ValueKind::kAbsorption:
      return "1/m";
    default:
      return {};
  }
}

ValueScale scale_of_name(const std::string& where, std::string_view name, ValueKind kind,
                         const DiagnosticSink& sink) {
  if (kind == ValueKind::kAbsorption) return absorption_scale(where, name).value_or(ValueScale{});
  const std::optional<ValueUnit> unit = find_power_unit(name);
  const bool is_other = kind == ValueKind::kPlain && unit && is_quotient(*unit);
  const bool counts = unit && (is_power(kind) || unit->is_understood || is_other);
  if (!counts) return percent_scale(says_percent(name));
  if (kind == ValueKind::kPlain)
    throw InputError(where + ": " + quoted(*unit) + ": must be numbers without a unit, or percent");
  return power_scale(where, *unit, kind, sink);
}

ValueScale scale_of_column(const NumberTable& table, std::size_t column, ValueKind kind,
                           const DiagnosticSink& sink) {
  const std::string where = table.file.string();
  const ValueScale named = scale_of_name(where, column_text(table, column), kind, sink);
  if (named.is_stated) return named;
  if (kind == ValueKind::kAbsorption) {
    const ValueScale stated = absorption_in_comments(table);
    // RADIS writes absorption coefficients in 1/cm, and does not always say so.
    return stated.is_stated || !is_from_radis(table) ? stated : ValueScale{100, false, true};
  }
  if (kind != ValueKind::kPlain) {
    if (const auto listed = listed_unit(table, column)) return power_scale(where, *listed, kind, sink);
    const std::optional<ValueUnit> unit = unit_in_comments(table);
    if (unit && (is_power(kind) || unit->is_understood)) return power_scale(where, *unit, kind, sink);
  }
  return percent_scale(comments_say_percent(table));
}

void report_assumed_units(const NumberTable& table, bool wavelength_is_stated, const ValueScale& scale,
                          ValueKind kind, const DiagnosticSink& sink) {
  constexpr double kSuspicious = 100;
  const SourcePosition position{table.file.string(), 0, 0};
  const std::vector<double> wavelengths = first_column(table);
  const double largest = *std::ranges::max_element(wavelengths);
  const std::string unit = unit_of(kind);
  bool wavelength_is_open = !wavelength_is_stated;
  if (wavelength_is_open && largest < kSuspicious) {
    warn(sink, position,
         "wavelengths up to " + format_number(largest) + " are read as nm: the file states no unit");
    wavelength_is_open = false;
  }
  const bool value_is_open = !unit.empty() && !scale.is_stated;
  std::string message = wavelength_is_open ? "wavelengths are read as nm" : "";
  if (value_is_open) message += (wavelength_is_open ? ", values as " : "values are read as ") + unit;
  if (!message.empty())
    note(sink, position,
         message + ": the file states no unit" + (wavelength_is_open && value_is_open ? "s" : ""));
}

void report_small_percents(const NumberTable& table, std::size_t column, const ValueScale& scale,
                           const DiagnosticSink& sink) {
  if (!scale.is_percent) return;
  double largest = 0;
  for (const double value : finite_column(table, column)) largest = std::max(largest, value);
  if (largest <= 0 || largest > 1) return;
  warn(sink, {table.file.string(), 0, 0},
       "values up to " + format_number(largest) + " are read as percent, as the file states: up to " +
           format_number(largest * scale.factor));
}

Spectrum column_spectrum(const NumberTable& table, const WavelengthAxis& axis, std::size_t column,
                         const ValueScale& scale) {
  const std::vector<double> column_values = finite_column(table, column);
  std::vector<double> values(table.rows());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = column_values[axis.reversed ? values.size() - 1 - i : i] * scale.factor;
    const double lambda = axis.lambda_nm[i];
    values[i] = scale.per_wavenumber
                    ? value * to_nanometres(1, WavelengthUnit::kWavenumber) / (lambda * lambda)
                    : value;
  }
  return Spectrum::tabulated(axis.lambda_nm, std::move(values));
}

}  // namespace kiloband
