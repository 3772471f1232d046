#include "scene/compile/light/envmap_sampling.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "scene/compile/light/lattice_cdf.hpp"

namespace kiloband {
namespace {

/// A map of which a smaller part lies above its mean is even: that is rounding.
constexpr double kEvenMap = 1e-6;

void check(uint32_t width, uint32_t height, std::span<const float> texel_weights) {
  if (width == 0 || height == 0 || width > 65536 || height > 65536) {
    throw std::logic_error("build_envmap_sampling: width and height must be in [1, 65536]");
  }
  if (texel_weights.size() != static_cast<std::size_t>(width) * height) {
    throw std::logic_error("build_envmap_sampling: as many weights as texels are needed");
  }
  const auto valid = [](float w) { return std::isfinite(w) && w >= 0; };
  if (!std::all_of(texel_weights.begin(), texel_weights.end(), valid)) {
    throw std::logic_error("build_envmap_sampling: weights must be finite and not negative");
  }
}

/// Integrals of sin theta over a row of cells, weighted with 1 - f (its upper texels) and f (its lower ones),
/// where f goes linearly from 0 to 1. By parts: integral of f sin = ((sin b - sin a) / (b - a)) - cos b.
struct RowIntegrals {
  double upper, lower;

  RowIntegrals(uint32_t row, uint32_t rows) {
    const double a = std::numbers::pi * row / rows, b = std::numbers::pi * (row + 1) / rows;
    const double both = 2 * std::sin(0.5 * (a + b)) * std::sin(0.5 * (b - a));
    const double mean_cos = 2 * std::cos(0.5 * (a + b)) * std::sin(0.5 * (b - a)) / (b - a);
    lower = std::clamp(mean_cos - std::cos(b), 0.0, both);
    upper = both - lower;
  }
  double sum() const { return upper + lower; }
};

/// Integrals of the interpolated map over the cells of one row, [sr * weight], without the column width.
void integrate_row(uint32_t width, uint32_t height, std::span<const float> texels, uint32_t row,
                   const RowIntegrals& integrals, std::span<double> out) {
  const float* upper = &texels[static_cast<std::size_t>(row) * width];
  const float* lower = &texels[static_cast<std::size_t>(std::min(row + 1, height - 1)) * width];
  for (uint32_t j = 0; j < width; ++j) {
    const uint32_t next = j + 1 < width ? j + 1 : 0;
    out[j] = 0.5 * (integrals.upper * (static_cast<double>(upper[j]) + upper[next]) +
                    integrals.lower * (static_cast<double>(lower[j]) + lower[next]));
  }
}

/// The map's mean over the sphere.
double mean_weight(uint32_t width, uint32_t height, std::span<const float> texels) {
  const uint32_t rows = std::max(height - 1, 1u);
  std::vector<double> row(width);
  double total = 0;
  for (uint32_t i = 0; i < rows; ++i) {
    integrate_row(width, height, texels, i, RowIntegrals(i, rows), row);
    double sum = 0;
    for (const double w : row) sum += w;
    total += sum;
  }
  return total / (2.0 * width);
}

/// What the cells of a row have above `mean`, else 0: [sr * weight], without the column width.
void excess_of_row(uint32_t width, uint32_t height, std::span<const float> texels, uint32_t row, double mean,
                   std::span<double> out) {
  const RowIntegrals integrals(row, std::max(height - 1, 1u));
  integrate_row(width, height, texels, row, integrals, out);
  for (double& w : out) w = std::max(w - mean * integrals.sum(), 0.0);
}

}  // namespace

std::vector<double> row_solid_angles(uint32_t height) {
  const uint32_t cells = std::max(height - 1, 1u);
  std::vector<double> angles(height, 0.0);
  for (uint32_t i = 0; i < cells; ++i) {
    const RowIntegrals integrals(i, cells);
    angles[i] += integrals.upper * height / 2;  // of 2, the sum over all cells
    angles[std::min(i + 1, height - 1)] += integrals.lower * height / 2;
  }
  return angles;
}

EnvmapSampling build_envmap_sampling(uint32_t width, uint32_t height, std::span<const float> texel_weights) {
  check(width, height, texel_weights);
  const uint32_t rows = std::max(height - 1, 1u);
  EnvmapSampling sampling{width, rows, std::vector<float>(rows + 1),
                          std::vector<float>(static_cast<std::size_t>(rows) * (width + 1))};
  std::vector<double> row(width), row_sums(rows);
  const double mean = mean_weight(width, height, texel_weights);
  double total = 0;
  for (uint32_t i = 0; i < rows; ++i) {
    excess_of_row(width, height, texel_weights, i, mean, row);
    for (const double w : row) row_sums[i] += w;
    total += row_sums[i];
  }
  // Mixed density: (1 - share) excess / total + share * solid angle / 4 pi, cell by cell;
  // 2 width sums all solid angles.
  const bool even = !(total > kEvenMap * mean * 2 * width);
  const double keep = even ? 0 : (1 - kEnvmapUniformShare) / total;
  const double uniform = (even ? 1 : kEnvmapUniformShare) / (2.0 * width);
  for (uint32_t i = 0; i < rows; ++i) {
    const double solid_angle = RowIntegrals(i, rows).sum();
    excess_of_row(width, height, texel_weights, i, mean, row);
    for (double& w : row) w = keep * w + uniform * solid_angle;
    std::ranges::copy(lattice_cdf(row), &sampling.row_cdf[static_cast<std::size_t>(i) * (width + 1)]);
    row_sums[i] = keep * row_sums[i] + uniform * width * solid_angle;
  }
  sampling.marginal_cdf = lattice_cdf(row_sums);
  return sampling;
}

}  // namespace kiloband
