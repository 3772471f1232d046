#include "tests/support/chi_square.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numeric>

namespace kiloband::test {
namespace {

constexpr int kPilot = 20000, kPilotPerCell = 200, kMaxDepth = 16, kQuadratureDepth = 9;

struct Cell {
  double z0, z1, phi0, phi1;
  std::vector<glm::dvec2> points;  // (z, phi) of the pilot run, only while building
  long observed = 0;
  double expected = 0;

  double area() const { return (z1 - z0) * (phi1 - phi0); }
  bool contains(glm::dvec2 p) const { return p.x >= z0 && p.x < z1 && p.y >= phi0 && p.y < phi1; }
  std::vector<Cell> split() const {
    const double z = 0.5 * (z0 + z1), phi = 0.5 * (phi0 + phi1);
    return {{z0, z, phi0, phi, {}}, {z0, z, phi, phi1, {}}, {z, z1, phi0, phi, {}}, {z, z1, phi, phi1, {}}};
  }
};

glm::dvec2 to_square(glm::vec3 w) {
  const double phi = std::atan2(double(w.y), double(w.x));
  return {std::clamp(double(w.z), -1.0, 1.0 - 1e-12), phi < 0 ? phi + 2 * M_PI : phi};
}

double gauss(const Cell& c, const std::function<double(glm::vec3)>& density) {
  constexpr double x[] = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281, 0.9305681557970263};
  constexpr double w[] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731, 0.1739274225687269};
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    const double z = c.z0 + x[i] * (c.z1 - c.z0), r = std::sqrt((1 - z) * (1 + z));
    for (int j = 0; j < 4; ++j) {
      const double phi = c.phi0 + x[j] * (c.phi1 - c.phi0);
      sum += w[i] * w[j] * density(glm::vec3(glm::dvec3(r * std::cos(phi), r * std::sin(phi), z)));
    }
  }
  return sum * c.area();
}

/// Adaptive: after one split, and down to the area, a cell is done when its four parts agree with it.
double integrate(const Cell& c, const std::function<double(glm::vec3)>& density, double area, double whole,
                 int depth = kQuadratureDepth) {
  const std::vector<Cell> parts = c.split();
  double values[4], sum = 0;
  for (int i = 0; i < 4; ++i) sum += values[i] = gauss(parts[i], density);
  const bool forced = depth == kQuadratureDepth || c.area() > area;
  if (depth == 0 || (!forced && std::abs(sum - whole) < 1e-6 + 1e-5 * sum)) return sum;
  sum = 0;
  for (int i = 0; i < 4; ++i) sum += integrate(parts[i], density, area, values[i], depth - 1);
  return sum;
}

void refine(Cell cell, int depth, std::vector<Cell>& leaves) {
  if (depth == 0 || (depth < kMaxDepth - 2 && cell.points.size() <= kPilotPerCell)) {
    cell.points.clear();
    leaves.push_back(std::move(cell));
    return;
  }
  for (Cell& part : cell.split()) {
    for (glm::dvec2 p : cell.points)
      if (part.contains(p)) part.points.push_back(p);
    refine(std::move(part), depth - 1, leaves);
  }
}

std::vector<Cell> make_cells(const std::function<Draw()>& draw) {
  Cell root{-1, 1, 0, 2 * M_PI + 1e-12, {}};
  for (int i = 0; i < kPilot; ++i)
    if (const Draw d = draw(); d.wo && !d.delta) root.points.push_back(to_square(*d.wo));
  std::vector<Cell> leaves;
  refine(std::move(root), kMaxDepth, leaves);
  return leaves;
}

/// Leaves of a quadtree by a coarse grid of candidate lists, so that counting does not scan all of them.
class Lookup {
 public:
  explicit Lookup(std::vector<Cell>& cells) : candidates_(kGrid * kGrid) {
    for (Cell& c : cells)
      for (int i = index((c.z0 + 1) / 2); i <= index((c.z1 + 1) / 2 - 1e-9); ++i)
        for (int j = index(c.phi0 / (2 * M_PI)); j <= index(c.phi1 / (2 * M_PI) - 1e-9); ++j)
          candidates_[i * kGrid + j].push_back(&c);
  }
  void count(glm::dvec2 p) {
    for (Cell* c : candidates_[index((p.x + 1) / 2) * kGrid + index(p.y / (2 * M_PI))])
      if (c->contains(p)) {
        ++c->observed;
        return;
      }
  }

 private:
  static constexpr int kGrid = 256;
  static int index(double x) { return std::clamp(static_cast<int>(x * kGrid), 0, kGrid - 1); }
  std::vector<std::vector<Cell*>> candidates_;
};

}  // namespace

ChiSquare chi_square(std::span<const double> observed, std::span<const double> expected) {
  std::vector<std::size_t> order(expected.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return expected[i]; });
  ChiSquare result;
  double statistic = 0, counts = 0, mean = 0, least_counts = 0, least_mean = 0;
  for (const std::size_t i : order) {
    if ((least_mean += expected[i]) < 1 && (least_counts += observed[i]) > 20) return result;
    counts += observed[i];
    mean += expected[i];
    if (mean < 10 && i != order.back()) continue;
    if (mean < 1e-3 && counts == 0) continue;
    statistic += (counts - mean) * (counts - mean) / mean;
    counts = mean = 0;
    ++result.cells;
  }
  if (result.cells < 2 || !std::isfinite(statistic)) return result;
  result.p_value =
      boost::math::cdf(boost::math::complement(boost::math::chi_squared(result.cells - 1), statistic));
  return result;
}

void SquareCounts::add(double a, double b) {
  const auto cell = [&](double x) { return std::clamp(static_cast<int>(x * n_), 0, n_ - 1); };
  counts_[static_cast<std::size_t>(cell(a) * n_ + cell(b))] += 1;
}

double SquareCounts::p_value() const {
  const double sum = std::accumulate(counts_.begin(), counts_.end(), 0.0);
  const std::vector<double> expected(counts_.size(), sum / static_cast<double>(counts_.size()));
  return chi_square(counts_, expected).p_value;
}

ChiSquare chi_square(const std::function<Draw()>& draw, const std::function<double(glm::vec3)>& density,
                     double delta, int count, int parts) {
  std::vector<Cell> cells = make_cells(draw);
  Lookup lookup(cells);
  double none = 0, deltas = 0;
  for (int i = 0; i < count; ++i) {
    const Draw d = draw();
    if (d.delta)
      ++deltas;
    else if (d.wo)
      lookup.count(to_square(*d.wo));
    else
      ++none;
  }
  std::vector<double> observed, expected;
  double integral = 0;
  for (const Cell& c : cells) {
    const double probability = integrate(c, density, 4 * M_PI / parts, gauss(c, density));
    integral += probability;
    observed.push_back(static_cast<double>(c.observed));
    expected.push_back(count * probability);
  }
  observed.insert(observed.end(), {deltas, none});
  expected.insert(expected.end(), {count * delta, count * std::max(0.0, 1 - delta - integral)});
  ChiSquare result = chi_square(observed, expected);
  result.integral = integral;
  return result;
}

double integral_over_sphere(const std::function<Draw()>& draw, const std::function<double(glm::vec3)>& f) {
  double sum = 0;
  for (const Cell& c : make_cells(draw)) sum += integrate(c, f, 4 * M_PI, gauss(c, f));
  return sum;
}

double z_score(std::span<const double> values, double expected) {
  const double n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double square = 0;
  for (const double v : values) square += (v - mean) * (v - mean);
  return (mean - expected) / std::sqrt(square / (n - 1) / n);
}

}  // namespace kiloband::test
