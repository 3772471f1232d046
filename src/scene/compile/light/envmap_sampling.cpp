#include "scene/compile/light/envmap_sampling.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "scene/compile/light/envmap_facings.hpp"
#include "scene/compile/light/lattice_cdf.hpp"
#include "shared/environment.h"

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
  const std::vector<double> angles = row_solid_angles(height);
  double total = 0;
  for (uint32_t i = 0; i < height; ++i) {
    const std::span<const float> row = texels.subspan(static_cast<std::size_t>(i) * width, width);
    total += angles[i] * std::accumulate(row.begin(), row.end(), 0.0);
  }
  return total / (static_cast<double>(width) * height);
}

/// What the cells of a row have above `mean`, else 0: [sr * weight], without the column width.
void excess_of_row(uint32_t width, uint32_t height, std::span<const float> texels, uint32_t row, double mean,
                   std::span<double> out) {
  const RowIntegrals integrals(row, std::max(height - 1, 1u));
  integrate_row(width, height, texels, row, integrals, out);
  for (double& w : out) w = std::max(w - mean * integrals.sum(), 0.0);
}

/// Mixed weights of cells: (1 - share) excess / total + share * solid angle / 4 pi; 2 width sums all solid angles.
class CellWeights {
 public:
  CellWeights(uint32_t width, uint32_t height, std::span<const float> texels)
      : width_(width), height_(height), texels_(texels), mean_(mean_weight(width, height, texels)) {
    std::vector<double> row(width);
    double total = 0;
    for (uint32_t i = 0; i < std::max(height - 1, 1u); ++i) {
      excess_of_row(width, height, texels, i, mean_, row);
      for (const double w : row) total += w;
    }
    const bool even = !(total > kEvenMap * mean_ * 2 * width);
    keep_ = even ? 0 : (1 - kEnvmapUniformShare) / total;
    uniform_ = (even ? 1 : kEnvmapUniformShare) / (2.0 * width);
  }

  void row(uint32_t i, std::span<double> out) const {
    const double solid_angle = RowIntegrals(i, std::max(height_ - 1, 1u)).sum();
    excess_of_row(width_, height_, texels_, i, mean_, out);
    for (double& w : out) w = keep_ * w + uniform_ * solid_angle;
  }

 private:
  uint32_t width_, height_;
  std::span<const float> texels_;
  double mean_, keep_ = 0, uniform_ = 0;
};

/// The least shift with which `cells` lie in at most `most` regions.
uint32_t shift_for(uint32_t cells, uint32_t most) {
  uint32_t shift = 0;
  while (((cells - 1) >> shift) + 1 > most) ++shift;
  return shift;
}

void append(std::vector<float>& table, std::span<const double> weights) {
  const std::vector<float> cdf = lattice_cdf(weights);
  table.insert(table.end(), cdf.begin(), cdf.end());
}

/// Fills column_cdf. Returns the sums of weights, [row of cells][column of regions].
std::vector<double> add_columns(const CellWeights& weights, EnvmapSampling& sampling) {
  const std::size_t across = sampling.regions_across(), columns = std::size_t{1} << sampling.column_shift;
  const std::size_t entries = sampling.height * across * (columns + 1);
  if (entries > UINT32_MAX) throw std::logic_error("build_envmap_sampling: too many cells");
  sampling.column_cdf.reserve(entries);
  std::vector<double> row(across * columns, 0.0), sums;
  for (uint32_t i = 0; i < sampling.height; ++i) {
    weights.row(i, std::span(row).first(sampling.width));
    for (std::size_t c = 0; c < across; ++c) {
      const std::span<const double> part = std::span(row).subspan(c * columns, columns);
      append(sampling.column_cdf, part);
      sums.push_back(std::accumulate(part.begin(), part.end(), 0.0));
    }
  }
  return sums;
}

/// Fills row_cdf. Returns the sums of weights by region, [row][column].
std::vector<double> add_rows(const std::vector<double>& row_sums, EnvmapSampling& sampling) {
  const std::size_t across = sampling.regions_across();
  std::vector<double> sums, part(std::size_t{1} << sampling.row_shift);
  for (uint32_t region = 0; region < sampling.regions_down(); ++region) {
    for (std::size_t c = 0; c < across; ++c) {
      std::ranges::fill(part, 0.0);
      const uint32_t first = region << sampling.row_shift;
      for (uint32_t i = first; i < std::min<std::size_t>(first + part.size(), sampling.height); ++i)
        part[i - first] = row_sums[i * across + c];
      append(sampling.row_cdf, part);
      sums.push_back(std::accumulate(part.begin(), part.end(), 0.0));
    }
  }
  return sums;
}

void add_facings(const std::vector<double>& region_sums, EnvmapSampling& sampling) {
  const std::size_t across = sampling.regions_across();
  for (uint32_t facing = 0; facing <= KB_ALL_FACINGS; ++facing) {
    std::vector<double> weights = envmap_facing_weights(sampling, facing);
    std::vector<double> rows;
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] *= region_sums[i];
    for (std::size_t i = 0; i < weights.size(); i += across)
      rows.push_back(std::accumulate(&weights[i], &weights[i] + across, 0.0));
    append(sampling.facing_cdf, rows);
    for (std::size_t i = 0; i < weights.size(); i += across)
      append(sampling.facing_cdf, std::span(weights).subspan(i, across));
  }
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
  EnvmapSampling sampling{.width = width, .height = rows};
  sampling.column_shift = shift_for(width, kMostRegionsAcross);
  sampling.row_shift = shift_for(rows, kMostRegionsDown);
  const CellWeights weights(width, height, texel_weights);
  const std::vector<double> row_sums = add_columns(weights, sampling);
  add_facings(add_rows(row_sums, sampling), sampling);
  return sampling;
}

}  // namespace kiloband
