#include "spectral/materials/materials.hpp"

#include <algorithm>
#include <stdexcept>

#include "spectral/dispersion_formula.hpp"
#include "spectral/files/text_table.hpp"
#include "spectral/materials/dielectric_table.h"
#include "spectral/materials/metal_table.h"
#include "spectral/tabulate.hpp"

namespace kiloband {
namespace {

constexpr TabulationError kMetalError{.absolute = 1e-7, .relative = 1e-5};

[[noreturn]] void too_fast(double lambda_um) {
  throw std::logic_error("built-in material varies too fast at " + format_number(lambda_um) + " um");
}

template <class Entries>
auto find_entry(const Entries& entries, std::string_view name) {
  const std::string wanted = lowered(name);
  const auto found = std::ranges::find_if(entries, [&](const auto& e) { return lowered(e.name) == wanted; });
  return found == std::end(entries) ? nullptr : &*found;
}

double min_um(const MetalEntry& metal) {
  return kEvUm / metal.max_ev;
}
double model_max_um(const MetalEntry& metal) {
  return kEvUm / metal.min_ev;
}

/// One of n and k: the model, then the table behind it.
Spectrum metal_part(const MetalEntry& metal, double (*of_index)(const std::complex<double>&),
                    double TabulatedIndex::*of_table) {
  const Spectrum model =
      tabulate_function([&](double um) { return of_index(lorentz_drude_index(metal.model, um)); },
                        min_um(metal), model_max_um(metal), kMetalError, too_fast);
  std::vector<double> lambda_nm(model.knots_nm().begin(), model.knots_nm().end());
  std::vector<double> values(model.knot_values().begin(), model.knot_values().end());
  for (const TabulatedIndex& row : metal.far) {
    lambda_nm.push_back(row.lambda_um * 1000);
    values.push_back(row.*of_table);
  }
  return Spectrum::tabulated(std::move(lambda_nm), std::move(values));
}

void append(std::span<const IndexPoint> points, std::vector<double>& lambda_nm, std::vector<double>& values) {
  for (const IndexPoint& point : points) {
    lambda_nm.push_back(point.lambda_um * 1000);
    values.push_back(point.n);
  }
}

Spectrum dielectric_index(const DielectricEntry& entry) {
  const std::size_t count = max_coefficients(entry.formula);
  const std::vector<double> coefficients(entry.coefficients, entry.coefficients + count);
  const Spectrum formula =
      tabulate_formula(std::string(entry.name), entry.formula, coefficients, entry.min_um, entry.max_um);
  std::vector<double> lambda_nm, values;
  append(entry.near, lambda_nm, values);
  lambda_nm.insert(lambda_nm.end(), formula.knots_nm().begin(), formula.knots_nm().end());
  values.insert(values.end(), formula.knot_values().begin(), formula.knot_values().end());
  append(entry.far, lambda_nm, values);
  return Spectrum::tabulated(std::move(lambda_nm), std::move(values));
}

}  // namespace

std::vector<BuiltInMaterial> built_in_metals() {
  std::vector<BuiltInMaterial> result;
  for (const MetalEntry& m : kMetals) {
    const double max_um = m.far.empty() ? model_max_um(m) : m.far.back().lambda_um;
    result.push_back({m.name, m.substance, 1000 * min_um(m), 1000 * max_um, m.source});
  }
  return result;
}

std::vector<BuiltInMaterial> built_in_dielectrics() {
  std::vector<BuiltInMaterial> result;
  for (const DielectricEntry& d : kDielectrics) {
    const double min = d.near.empty() ? d.min_um : d.near.front().lambda_um;
    const double max = d.far.empty() ? d.max_um : d.far.back().lambda_um;
    result.push_back({d.name, d.substance, 1000 * min, 1000 * max, d.source});
  }
  return result;
}

std::optional<OpticalConstants> find_metal(std::string_view name) {
  const MetalEntry* metal = find_entry(kMetals, name);
  if (!metal) return std::nullopt;
  const auto real = [](const std::complex<double>& index) { return index.real(); };
  const auto imaginary = [](const std::complex<double>& index) { return index.imag(); };
  return OpticalConstants{metal_part(*metal, real, &TabulatedIndex::n),
                          metal_part(*metal, imaginary, &TabulatedIndex::k)};
}

std::optional<Spectrum> find_dielectric(std::string_view name) {
  const DielectricEntry* entry = find_entry(kDielectrics, name);
  if (!entry) return std::nullopt;
  return dielectric_index(*entry);
}

}  // namespace kiloband
