// Statistical helpers of the tests: Pearson's chi-square test,
// and tests of direction sampling against a density.
//
// p-values are compared with kTestLevel: a correct implementation fails for one seed in 1e5 (seeds are fixed,
// so that a passing test stays passing). What a test can see: with n samples in c cells a relative RMS error
// e of the cells' probabilities gives the statistic a non-centrality of n e^2; it is found with probability
// 0.95 from e = sqrt((4.3 + 1.7) sqrt(2 c) / n) on, e.g. 2.9 % for n = 200 000 and c = 400.
#pragma once

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/philox.h"

namespace kiloband::testing_tools {

inline constexpr double kTestLevel = 1e-5;

struct ChiSquareResult {
  double statistic = 0;
  int degrees = 0;
  double p_value = 1;
};

/// Pearson's test of counts against expected counts of the same sum (the sum is not fitted: it costs one
/// degree). Cells that expect fewer than 5 are pooled; if the pool expects less than 5, it joins the last
/// cell. A count where (nearly) nothing is expected gives p = 0.
inline ChiSquareResult chi_square_test(std::span<const double> observed, std::span<const double> expected) {
  double pool_observed = 0, pool_expected = 0;
  std::vector<std::pair<double, double>> cells;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] >= 5) {
      cells.emplace_back(observed[i], expected[i]);
    } else {
      pool_observed += observed[i];
      pool_expected += expected[i];
    }
  }
  if (pool_expected >= 5 || cells.empty()) {
    cells.emplace_back(pool_observed, pool_expected);
  } else {
    cells.back().first += pool_observed;
    cells.back().second += pool_expected;
  }
  ChiSquareResult result;
  result.degrees = static_cast<int>(cells.size()) - 1;
  for (const auto& [count, mean] : cells) result.statistic += (count - mean) * (count - mean) / mean;
  if (!std::isfinite(result.statistic)) return {result.statistic, result.degrees, 0};
  if (result.degrees > 0)
    result.p_value = cdf(complement(boost::math::chi_squared(result.degrees), result.statistic));
  return result;
}

/// Two uniform numbers of a test's own stream.
inline std::pair<float, float> uniform_pair(uint64_t seed, uint32_t index) {
  const KbFloat4 u = kb_philox_floats(seed, index, 0, 0, 0x74657374u);
  return {u.x, u.y};
}

/// A grid over directions: theta in [0, theta_max] with cells that grow like i^2 (densities peak at the
/// pole), phi in [-pi, pi].
struct DirectionGrid {
  int theta_cells = 20, phi_cells = 20;
  double theta_max = 3.14159265358979324;
  int sub_cells = 2;  // quadrature: sub_cells^2 Gauss points blocks of 7 x 7 a cell

  double theta_edge(double i) const { return theta_max * (i / theta_cells) * (i / theta_cells); }
  double phi_edge(double j) const { return 3.14159265358979324 * (2 * j / phi_cells - 1); }
};

struct DirectionTest {
  double integral = 0;  // of the density over the grid
  double accepted = 0;  // fraction of samples that were valid and inside
  ChiSquareResult chi_square;
};

/// Integral of density(direction) over one cell, Gauss-Legendre in theta and phi.
template <class Density>
double integrate_cell(const DirectionGrid& grid, int i, int j, const Density& density) {
  using Gauss = boost::math::quadrature::gauss<double, 7>;
  double sum = 0;
  for (int s = 0; s < grid.sub_cells * grid.sub_cells; ++s) {
    const double di = s / grid.sub_cells / static_cast<double>(grid.sub_cells);
    const double dj = s % grid.sub_cells / static_cast<double>(grid.sub_cells);
    const double step = 1.0 / grid.sub_cells;
    const auto ring = [&](double theta) {
      const auto point = [&](double phi) {
        return static_cast<double>(density(KbFloat3{static_cast<float>(std::sin(theta) * std::cos(phi)),
                                                    static_cast<float>(std::sin(theta) * std::sin(phi)),
                                                    static_cast<float>(std::cos(theta))}));
      };
      return std::sin(theta) * Gauss::integrate(point, grid.phi_edge(j + dj), grid.phi_edge(j + dj + step));
    };
    sum += Gauss::integrate(ring, grid.theta_edge(i + di), grid.theta_edge(i + di + step));
  }
  return sum;
}

/// Histogram of n samples against the density. sample(u, v) returns optional<KbFloat3>; empty is "no sample".
/// The density may integrate to less than 1: the rest is expected as invalid samples or outside the grid.
template <class Sample, class Density>
DirectionTest test_directions(const DirectionGrid& grid, uint64_t seed, uint32_t n, const Sample& sample,
                              const Density& density) {
  const std::size_t cells = static_cast<std::size_t>(grid.theta_cells * grid.phi_cells);
  std::vector<double> observed(cells + 1), expected(cells + 1);
  for (uint32_t s = 0; s < n; ++s) {
    const auto [u, v] = uniform_pair(seed, s);
    const std::optional<KbFloat3> w = sample(u, v);
    std::size_t cell = cells;
    if (w) {
      const double theta = std::atan2(std::hypot(w->x, w->y), static_cast<double>(w->z));
      const int i = static_cast<int>(std::sqrt(theta / grid.theta_max) * grid.theta_cells);
      const double turn = std::atan2(w->y, w->x) / (2 * 3.14159265358979324) + 0.5;
      const int j = std::min(static_cast<int>(turn * grid.phi_cells), grid.phi_cells - 1);
      if (theta == grid.theta_max)
        cell = cells - grid.phi_cells + j;
      else if (i < grid.theta_cells)
        cell = static_cast<std::size_t>(i * grid.phi_cells + j);
    }
    observed[cell] += 1;
  }
  DirectionTest result;
  for (int i = 0; i < grid.theta_cells; ++i)
    for (int j = 0; j < grid.phi_cells; ++j)
      expected[static_cast<std::size_t>(i * grid.phi_cells + j)] = integrate_cell(grid, i, j, density);
  result.integral = std::accumulate(expected.begin(), expected.end(), 0.0);
  expected[cells] = std::max(0.0, 1 - result.integral);
  for (double& e : expected) e *= n;
  result.accepted = 1 - observed[cells] / n;
  result.chi_square = chi_square_test(observed, expected);
  return result;
}

/// z = (mean of values - expected) / (s / sqrt(n)), of independent values.
inline double z_score(std::span<const double> values, double expected) {
  const double n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double square = 0;
  for (const double v : values) square += (v - mean) * (v - mean);
  return (mean - expected) / std::sqrt(square / (n - 1) / n);
}

/// |z| above this happens for a correct implementation for one seed in 1e6.
inline constexpr double kMaxZ = 4.9;

}  // namespace kiloband::testing_tools
