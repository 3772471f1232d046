// Regular tables of spectra.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "spectral/files/text_table.hpp"
#include "spectral/spectrum_node.hpp"

namespace kiloband {
namespace {

struct Request {
  const Spectrum& spectrum;
  double min_nm, max_nm;  // of the table
  Spectrum::Range asked;
  bool extrapolate;
  double tolerance;  // absolute
  std::size_t max_entries;
};

RegularTable flat_table(double value, double min_nm, double max_nm) {
  return {min_nm, max_nm - min_nm, {value, value}, true, 0};
}

/// The ends for a request that cuts the data: a little outside it, because a wavelength that single precision
/// rounds to just beyond the request must not read 0. Data keep to their own knots there (so that a common
/// lattice is found) unless they are far away.
Spectrum::Range widened(std::span<const double> knots_nm, double min_nm, double max_nm) {
  const double margin_nm = 1e-6 * max_nm, far_nm = 0.1 * (max_nm - min_nm);
  Spectrum::Range range{min_nm - margin_nm, max_nm + margin_nm};
  const auto above_min = std::upper_bound(knots_nm.begin(), knots_nm.end(), range.min_nm);
  if (above_min != knots_nm.begin() && *(above_min - 1) > min_nm - far_nm) range.min_nm = *(above_min - 1);
  const auto above_max = std::lower_bound(knots_nm.begin(), knots_nm.end(), range.max_nm);
  if (above_max != knots_nm.end() && *above_max < max_nm + far_nm) range.max_nm = *above_max;
  return range;
}

/// The table's range: the widened request, ending earlier where the spectrum is 0 or flat from there on.
Spectrum::Range table_range(const Spectrum& spectrum, double min_nm, double max_nm) {
  Spectrum::Range range = widened(spectrum.knots_nm(), min_nm, max_nm);
  if (const std::optional<Spectrum::Range> varying = spectrum.node().varying_range())
    range = {std::max(range.min_nm, varying->min_nm), std::min(range.max_nm, varying->max_nm)};
  return range;
}

/// Points of the table's own lattice.
std::vector<double> nodes_of(const RegularTable& table) {
  std::vector<double> nodes_nm;
  for (std::size_t i = 0; i < table.values.size(); ++i)
    nodes_nm.push_back(table.min_nm + table.step_nm * static_cast<double>(i));
  return nodes_nm;
}

/// Largest |table - spectrum| at the points that lie in the range that was asked for.
double error_at(std::vector<double> points, const RegularTable& table, const Request& request) {
  std::erase_if(points, [&](double x) { return x < request.asked.min_nm || x > request.asked.max_nm; });
  std::sort(points.begin(), points.end());
  std::vector<double> exact(points.size());
  request.spectrum.evaluate(points, exact);
  double error = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    error = std::max(error, std::abs(table(points[i]) - exact[i]));
  return error;
}

/// Largest |table - spectrum| over what of the range that was asked for the table covers, for a table whose
/// entries are the spectrum's values. A table's error is largest at the knots of the data, for others at the
/// breaks or inside a cell: there it is measured at the quarters and stated 5 % larger.
double measure_error(const RegularTable& table, const Request& request) {
  std::vector<double> points;
  for (const double end_nm : {request.asked.min_nm, request.asked.max_nm})
    if (end_nm > request.min_nm && end_nm < request.max_nm) points.push_back(end_nm);
  request.spectrum.node().append_breaks(request.min_nm, request.max_nm, points);
  const bool piecewise_linear = !request.spectrum.knots_nm().empty();
  if (!piecewise_linear)
    for (std::size_t i = 0; i + 1 < table.values.size(); ++i)
      for (const double t : {0.25, 0.5, 0.75})
        points.push_back(table.min_nm + table.step_nm * (static_cast<double>(i) + t));
  const double error = error_at(std::move(points), table, request);
  return piecewise_linear ? error : 1.05 * error;
}

RegularTable sampled(const Request& request, std::size_t cells) {
  RegularTable table;
  table.min_nm = request.min_nm;
  table.step_nm = (request.max_nm - request.min_nm) / static_cast<double>(cells);
  table.extrapolate = request.extrapolate;
  std::vector<double> lambda_nm(cells + 1);
  for (std::size_t i = 0; i < cells; ++i)
    lambda_nm[i] = table.min_nm + table.step_nm * static_cast<double>(i);
  lambda_nm[cells] = request.max_nm;
  table.values.resize(cells + 1);
  request.spectrum.evaluate(lambda_nm, table.values);
  table.max_error = measure_error(table, request);
  return table;
}

/// Whether all knots are on the lattice of `count` - 1 equal steps, within 1e-3 of a step
/// (as Mitsuba 3 decides): equal steps that a file gives rounded.
bool is_regular(std::span<const double> knots_nm) {
  if (knots_nm.size() < 2) return false;
  const double step_nm = (knots_nm.back() - knots_nm.front()) / static_cast<double>(knots_nm.size() - 1);
  for (std::size_t i = 0; i < knots_nm.size(); ++i)
    if (std::abs(knots_nm[i] - knots_nm.front() - step_nm * static_cast<double>(i)) > 1e-3 * step_nm)
      return false;
  return true;
}

/// Regular data as they are, from the last knot at or before the request to the first at or after it.
RegularTable clipped(const Request& request) {
  const std::span<const double> knots = request.spectrum.knots_nm();
  const std::span<const double> values = request.spectrum.knot_values();
  const double step_nm = (knots.back() - knots.front()) / static_cast<double>(knots.size() - 1);
  auto first =
      static_cast<std::size_t>(std::upper_bound(knots.begin(), knots.end(), request.min_nm) - knots.begin());
  auto last =
      static_cast<std::size_t>(std::lower_bound(knots.begin(), knots.end(), request.max_nm) - knots.begin());
  first = std::min(first > 0 ? first - 1 : 0, knots.size() - 2);
  last = std::clamp(last, first + 1, knots.size() - 1);
  RegularTable table{
      knots.front() + step_nm * static_cast<double>(first), step_nm, {}, request.extrapolate, 0};
  table.values.assign(values.begin() + static_cast<std::ptrdiff_t>(first),
                      values.begin() + static_cast<std::ptrdiff_t>(last) + 1);
  // Entries that were moved to the lattice are not the data's values there.
  std::vector<double> nodes_nm = nodes_of(table);
  std::erase_if(nodes_nm, [&](double x) { return x <= request.min_nm || x >= request.max_nm; });
  table.max_error = std::max(measure_error(table, request), error_at(std::move(nodes_nm), table, request));
  return table;
}

struct Lattice {
  double min_nm, max_nm;
  std::size_t cells;  // 0: there is none
};

/// The smallest denominator of a fraction within `tolerance` of x in [0, 1]: of a convergent of its continued fraction.
/// 0: above `most`.
double denominator(double x, double tolerance, double most) {
  double before = 0, last = 1, rest = x;
  while (std::abs(x * last - std::round(x * last)) > tolerance * last) {
    if (rest == 0) return 0;
    rest = 1 / rest;
    const double whole = std::floor(rest);
    rest -= whole;
    before = std::exchange(last, whole * last + before);
    if (!(last <= most)) return 0;
  }
  return last;
}

/// Into how many equal parts the points' span has to be divided so that all points are ends of parts, within `nothing_nm`; 0: more than
/// `most`. Parts of a whole and not a step, whose rounding many parts would multiply.
double common_parts(std::span<const double> points_nm, double nothing_nm, double most) {
  const double span_nm = points_nm.back() - points_nm.front();
  double parts = 1;
  for (const double point : points_nm) {
    const double at = (point - points_nm.front()) / span_nm * parts;
    const double more = denominator(at - std::floor(at), nothing_nm / span_nm * parts, most / parts);
    if (more == 0) return 0;
    parts *= more;
  }
  return parts;
}

/// The coarsest lattice through all knots of the request with at most `max_cells`, from the last of its points at or before the
/// request to the first at or after it. Less than `nothing` of the range is nothing.
Lattice lattice_of_knots(const Request& request, std::size_t max_cells, double nothing) {
  const double span_nm = request.max_nm - request.min_nm, nothing_nm = nothing * span_nm;
  const std::span<const double> knots = request.spectrum.knots_nm();
  const auto first = std::lower_bound(knots.begin(), knots.end(), request.min_nm - nothing_nm);
  const auto end = std::upper_bound(first, knots.end(), request.max_nm + nothing_nm);
  if (end - first < 2) return {};
  const double between = common_parts({first, end}, nothing_nm, static_cast<double>(max_cells));
  if (between == 0) return {};
  const double step_nm = (*(end - 1) - *first) / between;
  const auto steps = [&](double distance_nm) {
    return std::max(std::ceil(distance_nm / step_nm - 1e-6), 0.0);
  };
  const double before = steps(*first - request.min_nm), after = steps(request.max_nm - *(end - 1));
  const double cells = before + between + after;
  if (cells > static_cast<double>(max_cells)) return {};
  return {*first - before * step_nm, *(end - 1) + after * step_nm, static_cast<std::size_t>(cells)};
}

/// The data's own lattices, coarsest first: one that fits roughly, as their rounded wavelengths may, and one that fits as decimals do.
std::vector<Lattice> lattices_of(const Request& request, std::size_t max_cells) {
  std::vector<Lattice> lattices;
  for (const double nothing : {1e-7, 1e-11}) {
    const Lattice lattice = lattice_of_knots(request, max_cells, nothing);
    if (lattice.cells > 0 && (lattices.empty() || lattice.cells != lattices.back().cells))
      lattices.push_back(lattice);
  }
  return lattices;
}

/// Halves the step until the bound holds; a lattice of the data's own knots is taken where it is not finer.
RegularTable refined(const Request& request) {
  const std::size_t max_cells = request.max_entries - 1;
  const bool piecewise_linear = !request.spectrum.knots_nm().empty();
  const std::vector<Lattice> lattices =
      piecewise_linear ? lattices_of(request, max_cells) : std::vector<Lattice>{};
  auto next = lattices.begin();
  RegularTable table;
  const auto fits = [&](const Request& asked, std::size_t cells) {
    table = sampled(asked, cells);
    return table.max_error <= request.tolerance;
  };
  const auto fits_lattice = [&](const Lattice& lattice) {
    Request on_lattice = request;
    on_lattice.min_nm = lattice.min_nm, on_lattice.max_nm = lattice.max_nm;
    return fits(on_lattice, lattice.cells);
  };
  for (std::size_t cells = piecewise_linear ? 1 : 16; cells <= max_cells; cells *= 2) {
    while (next != lattices.end() && next->cells <= cells)
      if (fits_lattice(*next++)) return table;
    if (fits(request, cells)) return table;
  }
  while (next != lattices.end())
    if (fits_lattice(*next++)) return table;
  throw InputError("spectrum: " + std::to_string(request.max_entries) + " entries over " +
                   format_number(request.min_nm) + " to " + format_number(request.max_nm) +
                   " nm reach an error of " + format_number(table.max_error) + ": must be at most " +
                   format_number(request.tolerance));
}

}  // namespace

Spectrum::Range RegularTable::support() const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (extrapolate) return {-kInfinity, kInfinity};
  return {min_nm, min_nm + step_nm * static_cast<double>(values.size() - 1) * (1 + 1e-11)};
}

double RegularTable::operator()(double lambda_nm) const {
  const double position = (lambda_nm - min_nm) / step_nm;
  const double last = static_cast<double>(values.size() - 1);
  if (!(position >= 0)) return extrapolate ? values.front() : 0;
  // The last entry's wavelength may round to a hair beyond it.
  if (position >= last) return extrapolate || position <= last * (1 + 1e-12) ? values.back() : 0;
  const auto i = static_cast<std::size_t>(position);
  const double t = position - static_cast<double>(i);
  return (1 - t) * values[i] + t * values[i + 1];
}

RegularTable resample(const Spectrum& spectrum, double min_nm, double max_nm,
                      const ResampleOptions& options) {
  if (!std::isfinite(min_nm) || !std::isfinite(max_nm) || !(min_nm < max_nm) || options.max_entries < 2)
    throw std::logic_error("resample: interval must be ascending and finite, at least 2 entries");
  if (spectrum.is_constant()) return flat_table(spectrum(min_nm), min_nm, max_nm);
  const auto [lowest, highest] = spectrum.node().bounds(min_nm, max_nm);
  const double magnitude = std::max(std::abs(lowest), std::abs(highest));
  if (magnitude == 0) return flat_table(0, min_nm, max_nm);
  const std::optional<Spectrum::Range> varying = spectrum.node().varying_range();
  const auto [table_min_nm, table_max_nm] = table_range(spectrum, min_nm, max_nm);
  // The request has no or only one point in common with where the spectrum varies: 0 or the end value.
  if (!(table_min_nm < table_max_nm) || (varying && (varying->max_nm <= min_nm || varying->min_nm >= max_nm)))
    return flat_table(spectrum.extrapolates() ? spectrum(0.5 * (min_nm + max_nm)) : 0, min_nm, max_nm);
  // The table ends where the data do only if they end inside the request;
  // both flags are one, so one sharp end suffices.
  const bool sharp =
      varying && !spectrum.extrapolates() && (varying->min_nm > min_nm || varying->max_nm < max_nm);
  const Request request{spectrum,           table_min_nm, table_max_nm,
                        {min_nm, max_nm},   !sharp,       options.relative_error * magnitude,
                        options.max_entries};
  if (is_regular(spectrum.knots_nm())) {
    // Where neighbours differ much, a wavelength that is off by 1e-3 of a step matters.
    RegularTable table = clipped(request);
    if (table.values.size() <= options.max_entries && table.max_error <= request.tolerance) return table;
  }
  return refined(request);
}

}  // namespace kiloband
