#include "spectral/tabulate.hpp"

#include <cmath>
#include <vector>

namespace kiloband {
namespace {

/// A cell of the table while it is refined.
struct Cell {
  double a, b, f_a, f_b;
};

/// Cells over [min_um, max_um]: a stack with the shortest wavelengths on top.
std::vector<Cell> first_cells(const std::function<double(double)>& value, double min_um, double max_um) {
  constexpr int kFirstCells = 64;
  std::vector<Cell> waiting;
  const double step_um = (max_um - min_um) / kFirstCells;
  for (int i = kFirstCells; i-- > 0;) {
    const double a = min_um + step_um * i;
    const double b = i == kFirstCells - 1 ? max_um : min_um + step_um * (i + 1);
    waiting.push_back({a, b, value(a), value(b)});
  }
  return waiting;
}

}  // namespace

// Cells are halved until linear interpolation misses the function by less than 0.4 of the bound in the middle
// and at both quarters; for a smooth function the largest error of a cell is within 5 % of the one in the
// middle, so that the bound holds with a margin.
Spectrum tabulate_function(const std::function<double(double)>& value, double min_um, double max_um,
                           const TabulationError& bound, const std::function<void(double)>& too_fast) {
  constexpr double kMargin = 0.4;
  constexpr std::size_t kMaxPoints = 1u << 18;
  std::vector<double> lambda_nm = {min_um * 1000}, values = {value(min_um)};
  std::vector<Cell> waiting = first_cells(value, min_um, max_um);
  while (!waiting.empty()) {
    const Cell cell = waiting.back();
    waiting.pop_back();
    const double middle = 0.5 * (cell.a + cell.b), f = value(middle);
    double error = std::abs(f - 0.5 * (cell.f_a + cell.f_b));
    error = std::max(error, std::abs(value(0.5 * (cell.a + middle)) - 0.75 * cell.f_a - 0.25 * cell.f_b));
    error = std::max(error, std::abs(value(0.5 * (middle + cell.b)) - 0.25 * cell.f_a - 0.75 * cell.f_b));
    if (error < kMargin * (bound.absolute + bound.relative * std::abs(f))) {
      lambda_nm.push_back(cell.b * 1000);
      values.push_back(cell.f_b);
    } else {
      waiting.push_back({middle, cell.b, f, cell.f_b});
      waiting.push_back({cell.a, middle, cell.f_a, f});
    }
    if (lambda_nm.size() + waiting.size() > kMaxPoints) too_fast(cell.a);
  }
  return Spectrum::tabulated(std::move(lambda_nm), std::move(values));
}

}  // namespace kiloband
