// Many colours at once: a coarse table of solutions, then Newton's method per colour.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "spectral/colour/rgb.hpp"
#include "spectral/colour/sigmoid_solver.hpp"

namespace kiloband {
namespace {

constexpr int kResolution = 28;  // per axis
constexpr double kGoal = 3e-4;   // of a component of linear sRGB; the interface promises 1e-3
constexpr int kMaxNewton = 3;    // the rest is left to the damped search

const ColourQuadrature<float>& quadrature() {
  static const ColourQuadrature<float> instance(1);
  return instance;
}

/// Position of the largest component's grid points: dense towards 0 and 1, where the coefficients change
/// fastest (Jakob & Hanika 2019, section 4); slightly inside (0, 1), where they are finite.
float level(int i) {
  const auto smooth = [](double x) { return x * x * (3 - 2 * x); };
  const double x = smooth(smooth(static_cast<double>(i) / (kResolution - 1)));
  return static_cast<float>(std::clamp(x, 1e-4, 0.9999));
}

const std::array<float, kResolution>& levels() {
  static const std::array<float, kResolution> instance = [] {
    std::array<float, kResolution> result{};
    for (int i = 0; i < kResolution; ++i) result[i] = level(i);
    return result;
  }();
  return instance;
}

/// Index of the entry for largest component `axis`, ratios of the next two components to it, and its level.
std::size_t entry(int axis, int level_index, int y, int x) {
  return 3 *
         static_cast<std::size_t>(((axis * kResolution + level_index) * kResolution + y) * kResolution + x);
}

Rgb grid_colour(int axis, int level_index, int y, int x) {
  const double largest = levels()[level_index];
  // Ratio 0 would need infinite coefficients.
  const auto ratio = [](int i) { return std::clamp(static_cast<double>(i) / (kResolution - 1), 1e-3, 1.0); };
  Rgb rgb;
  rgb[axis] = largest;
  rgb[(axis + 1) % 3] = largest * ratio(x);
  rgb[(axis + 2) % 3] = largest * ratio(y);
  return rgb;
}

/// One axis and level: starts at grey (both ratios 1) and goes on from the neighbour's solution.
void solve_level(int axis, int level_index, std::vector<float>& table) {
  for (int y = kResolution - 1; y >= 0; --y)
    for (int x = kResolution - 1; x >= 0; --x) {
      Vec3 q = {0, 0, flat_sigmoid(levels()[level_index])};
      const int from_y = x < kResolution - 1 ? y : y + 1;
      const int from_x = x < kResolution - 1 ? x + 1 : x;
      if (from_y < kResolution) {
        const float* neighbour = &table[entry(axis, level_index, from_y, from_x)];
        q = {neighbour[0], neighbour[1], neighbour[2]};
      }
      fit_sigmoid(quadrature(), grid_colour(axis, level_index, y, x), q, 1e-5, 60);
      for (int j = 0; j < 3; ++j) table[entry(axis, level_index, y, x) + j] = static_cast<float>(q[j]);
    }
}

const std::vector<float>& shared_table() {
  static const std::vector<float> instance = [] {
    std::vector<float> table(entry(3, 0, 0, 0));
    for (int axis = 0; axis < 3; ++axis)
      for (int level_index = 0; level_index < kResolution; ++level_index)
        solve_level(axis, level_index, table);
    return table;
  }();
  return instance;
}

/// A cell of a grid axis and the position in it.
struct Place {
  int cell;
  float t;
};

Place place_level(float largest) {
  const auto& grid = levels();
  const auto above = std::upper_bound(grid.begin() + 1, grid.end() - 1, largest);
  const int cell = static_cast<int>(above - grid.begin()) - 1;
  return {cell, std::clamp((largest - grid[cell]) / (grid[cell + 1] - grid[cell]), 0.0f, 1.0f)};
}

Place place_ratio(float ratio) {
  const float position = ratio * (kResolution - 1);
  const int cell = std::min(static_cast<int>(position), kResolution - 2);
  return {cell, position - static_cast<float>(cell)};
}

Vec3 interpolate(const std::vector<float>& table, const Rgb& rgb, int axis) {
  const auto largest = static_cast<float>(rgb[axis]);
  const Place z = place_level(largest);
  const Place x = place_ratio(static_cast<float>(rgb[(axis + 1) % 3]) / largest);
  const Place y = place_ratio(static_cast<float>(rgb[(axis + 2) % 3]) / largest);
  Vec3 q{};
  for (int corner = 0; corner < 8; ++corner) {
    const int dx = corner & 1, dy = (corner >> 1) & 1, dz = corner >> 2;
    const float weight = (dx ? x.t : 1 - x.t) * (dy ? y.t : 1 - y.t) * (dz ? z.t : 1 - z.t);
    const float* c = &table[entry(axis, z.cell + dz, y.cell + dy, x.cell + dx)];
    for (int j = 0; j < 3; ++j) q[j] += static_cast<double>(weight * c[j]);
  }
  return q;
}

bool is_close(const Rgb& a, const Vec3& b) {
  return std::abs(a[0] - b[0]) <= kGoal && std::abs(a[1] - b[1]) <= kGoal && std::abs(a[2] - b[2]) <= kGoal;
}

std::array<float, 3> to_float(const Vec3& c) {
  return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
}

}  // namespace

SigmoidTable::SigmoidTable() : coefficients_(shared_table()) {}

std::array<float, 3> SigmoidTable::operator()(const std::array<float, 3>& components) const {
  Rgb rgb;
  for (int k = 0; k < 3; ++k) {
    if (!(components[k] >= 0 && components[k] <= 1))
      throw std::logic_error("SigmoidTable: components must be in [0, 1]");
    rgb[k] = components[k];
  }
  if (rgb[0] == rgb[1] && rgb[1] == rgb[2]) return to_float({0, 0, flat_sigmoid(rgb[0])});
  const int axis = static_cast<int>(std::max_element(rgb.begin(), rgb.end()) - rgb.begin());
  Vec3 q = interpolate(coefficients_, rgb, axis);
  for (int i = 0; i <= kMaxNewton; ++i) {
    Vec3 have;
    Mat3 jacobian;
    quadrature().evaluate(q, have, jacobian);
    if (is_close(rgb, have)) return to_float(to_centred_nanometres(q));
    if (!newton_step(rgb, have, jacobian, q)) break;
  }
  q = interpolate(coefficients_, rgb, axis);
  fit_sigmoid(quadrature(), rgb, q, kGoal, 60);
  return to_float(to_centred_nanometres(q));
}

}  // namespace kiloband
