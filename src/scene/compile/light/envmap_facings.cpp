#include "scene/compile/light/envmap_facings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/environment.h"

namespace kiloband {
namespace {

constexpr int kNormalsAcross = 4;     // of a facing
constexpr int kDirectionsAcross = 3;  // of a region

double sign_of(double x) {
  return std::signbit(x) ? -1 : 1;
}

/// Normals of a facing: the middles of kNormalsAcross^2 parts of its cell.
std::vector<glm::dvec3> normals_of(uint32_t facing) {
  std::vector<glm::dvec3> normals;
  for (int j = 0; j < kNormalsAcross; ++j)
    for (int i = 0; i < kNormalsAcross; ++i)
      normals.push_back(facing_normal(facing, (i + 0.5) / kNormalsAcross, (j + 0.5) / kNormalsAcross));
  return normals;
}

/// Direction at map coordinates, in the map's frame (src_cpu/light/environment-inl.hpp).
glm::dvec3 map_direction(double u, double v) {
  const double phi = 2 * std::numbers::pi * u, theta = std::numbers::pi * v;
  return {std::sin(phi) * std::sin(theta), std::cos(theta), -std::cos(phi) * std::sin(theta)};
}

/// The part of a region's directions in the middle of kDirectionsAcross^2 parts of it.
std::vector<glm::dvec3> directions_of(const EnvmapSampling& sampling, uint32_t row, uint32_t column) {
  const uint32_t top = row << sampling.row_shift, left = column << sampling.column_shift;
  const uint32_t bottom = std::min(top + (1u << sampling.row_shift), sampling.height);
  const uint32_t right = std::min(left + (1u << sampling.column_shift), sampling.width);
  std::vector<glm::dvec3> directions;
  for (int j = 0; j < kDirectionsAcross; ++j) {
    for (int i = 0; i < kDirectionsAcross; ++i) {
      const double y = top + (bottom - top) * (j + 0.5) / kDirectionsAcross;
      const double x = left + (right - left) * (i + 0.5) / kDirectionsAcross;
      directions.push_back(map_direction((x + 0.5) / sampling.width, y / sampling.height));
    }
  }
  return directions;
}

}  // namespace

glm::dvec3 facing_normal(uint32_t facing, double x, double y) {
  const double a = 2 * (facing % KB_FACINGS_ACROSS + x) / KB_FACINGS_ACROSS - 1;
  const double b = 2 * (facing / KB_FACINGS_ACROSS + y) / KB_FACINGS_ACROSS - 1;
  const double up = 1 - std::fabs(a) - std::fabs(b);
  if (up >= 0) return glm::normalize(glm::dvec3(a, up, b));
  return glm::normalize(glm::dvec3((1 - std::fabs(b)) * sign_of(a), up, (1 - std::fabs(a)) * sign_of(b)));
}

std::vector<double> envmap_facing_weights(const EnvmapSampling& sampling, uint32_t facing) {
  const uint32_t down = sampling.regions_down(), across = sampling.regions_across();
  if (facing == KB_ALL_FACINGS) return std::vector<double>(std::size_t{down} * across, 1.0);
  const std::vector<glm::dvec3> normals = normals_of(facing);
  std::vector<double> weights;
  for (uint32_t row = 0; row < down; ++row) {
    for (uint32_t column = 0; column < across; ++column) {
      const std::vector<glm::dvec3> directions = directions_of(sampling, row, column);
      double sum = 0;
      for (const glm::dvec3& d : directions)
        for (const glm::dvec3& n : normals) sum += std::max(glm::dot(d, n), 0.0);
      const double mean = sum / static_cast<double>(directions.size() * normals.size());
      weights.push_back(mean > 0 ? mean + kLeastFacingWeight : 0);
    }
  }
  return weights;
}

}  // namespace kiloband
