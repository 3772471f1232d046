#include "src_cpu/light/environment.hpp"

#include <algorithm>
#include <cmath>

#include "src_cpu/geometry/shape_geometry_affine.hpp"
#include "src_cpu/light/area.hpp"

namespace kiloband::cpu {
namespace {

/// A value drawn from a piecewise constant distribution: the cell and where u fell in it, in [0, 1).
struct CellSample {
  uint32_t cell;
  float fraction;
};

CellSample sample_cell(const float* cdf, uint32_t count, float u) {
  const uint32_t cell = find_interval(cdf, count, u);
  const float fraction = (u - cdf[cell]) / (cdf[cell + 1] - cdf[cell]);
  return {cell, std::min(fraction, KB_ONE_MINUS_EPSILON)};
}

float sin_squared(float x) {
  const float s = std::sin(x);
  return s * s;
}

}  // namespace

glm::vec2 envmap_coordinates(const KbEmitter& emitter, glm::vec3 direction) {
  const glm::vec3 d = transform_vector(emitter.to_object, direction);
  const float turn = std::atan2(d.x, -d.z) * (0.5f * KB_INV_PI);
  const float u = turn < 0 ? turn + 1 : turn;
  // atan2 instead of acos: exact near the poles.
  const float v = std::atan2(std::sqrt(d.x * d.x + d.z * d.z), d.y) * KB_INV_PI;
  return {u < 1 ? u : 0, std::min(v, 1.0f)};
}

glm::vec3 sample_envmap_direction(const EnvmapSampling& sampling, const KbEmitter& emitter, glm::vec2 u) {
  const CellSample row = sample_cell(sampling.marginal_cdf.data(), sampling.height, u.y);
  const float* row_cdf = &sampling.row_cdf[static_cast<std::size_t>(row.cell) * (sampling.width + 1)];
  const CellSample column = sample_cell(row_cdf, sampling.width, u.x);

  // Uniform in solid angle within the row: h = sin^2(theta / 2) = (1 - cos theta) / 2 is uniform. Rows of the
  // lower half are mirrored, so that h stays small near either pole
  // and sin theta = 2 sqrt(h (1 - h)) keeps its digits.
  const bool lower = 2 * row.cell >= sampling.height;
  const uint32_t from_pole = lower ? sampling.height - 1 - row.cell : row.cell;
  const float step = 0.5f * KB_PI / static_cast<float>(sampling.height);
  const float h0 = sin_squared(step * static_cast<float>(from_pole));
  const float h1 = sin_squared(step * static_cast<float>(from_pole + 1));
  const float h = h0 + (h1 - h0) * row.fraction;
  const float sin_theta = 2 * std::sqrt(h * (1 - h)), cos_theta = lower ? 2 * h - 1 : 1 - 2 * h;

  const float map_u =
      (static_cast<float>(column.cell) + 0.5f + column.fraction) / static_cast<float>(sampling.width);
  const float phi = 2 * KB_PI * map_u;
  const glm::vec3 local(std::sin(phi) * sin_theta, cos_theta, -std::cos(phi) * sin_theta);
  return glm::normalize(transform_vector(emitter.to_world, local));
}

float envmap_density(const EnvmapSampling& sampling, glm::vec2 uv) {
  const auto rows = static_cast<float>(sampling.height);
  const auto columns = static_cast<float>(sampling.width);
  const uint32_t row = std::min(static_cast<uint32_t>(uv.y * rows), sampling.height - 1);
  const float shifted = uv.x * columns - 0.5f;
  const uint32_t column =
      shifted < 0 ? sampling.width - 1 : std::min(static_cast<uint32_t>(shifted), sampling.width - 1);
  const float* row_cdf = &sampling.row_cdf[static_cast<std::size_t>(row) * (sampling.width + 1)];
  const float probability =
      (sampling.marginal_cdf[row + 1] - sampling.marginal_cdf[row]) * (row_cdf[column + 1] - row_cdf[column]);
  // Solid angle of the cell: 2 pi / columns * (cos theta0 - cos theta1),
  // the difference as a product of sines.
  const float half_step = 0.5f * KB_PI / rows;
  const float middle = (2 * static_cast<float>(row) + 1) * half_step;
  return probability * columns / (4 * KB_PI * std::sin(middle) * std::sin(half_step));
}

}  // namespace kiloband::cpu
