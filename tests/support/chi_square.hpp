// Pearson's chi-square test, of counts and of sampled directions against a density.
//
// p-values are compared with kTestLevel: a correct implementation fails for one seed in 1e5 (seeds are fixed, so that a
// passing test stays passing). What a test can see: with n samples in c cells a relative RMS error e of the cells'
// probabilities gives the statistic a non-centrality of n e^2; it is found with probability 0.95 from
// e = sqrt((4.3 + 1.7) sqrt(2 c) / n) on, e.g. 2.9 % for n = 200 000 and c = 400.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <random>
#include <span>
#include <vector>

namespace kiloband::test {

inline constexpr double kTestLevel = 1e-5;
/// The same for a two-sided z test: |z| below this (4.42 standard errors).
inline constexpr double kMaxZ = 4.42;

/// Uniform numbers in [0, 1) with 24 bits.
class Uniform {
 public:
  explicit Uniform(uint64_t seed) : engine_(static_cast<uint32_t>(seed)) {}
  float operator()() { return static_cast<float>(engine_() >> 8) * 0x1p-24f; }
  glm::vec2 pair() {
    const float x = (*this)();
    return {x, (*this)()};
  }

 private:
  std::mt19937 engine_;
};

struct ChiSquare {
  double p_value = 0;
  int cells = 0;        // after pooling
  double integral = 0;  // of directions: of the density over the sphere, by quadrature
};

/// Counts against expected counts of the same sum (the sum is not fitted: it costs one degree). Cells are pooled
/// in order of expectation until each pool expects 10. Where nearly nothing is expected (1 in all), more than 20
/// counts give p = 0; so do less than two cells, of which nothing can be said.
ChiSquare chi_square(std::span<const double> observed, std::span<const double> expected);

/// Counts of points on n x n equal cells of the unit square, on which they should be uniform.
class SquareCounts {
 public:
  explicit SquareCounts(int n) : n_(n), counts_(static_cast<std::size_t>(n) * n) {}
  /// a, b  in [0, 1]
  void add(double a, double b);
  double p_value() const;

 private:
  int n_;
  std::vector<double> counts_;
};

/// One draw: a direction; nothing if no direction came out; or the delta lobe.
struct Draw {
  std::optional<glm::vec3> wo;
  bool delta = false;
};

/// Directions against a density. Cells are a quadtree in (z, phi), refined where a pilot run is dense. Draws
/// without a direction are a cell of their own with what is missing from 1; delta draws have probability `delta`.
/// parts: quadrature looks at least at so many parts of the sphere; many where a density has corners and edges
ChiSquare chi_square(const std::function<Draw()>& draw, const std::function<double(glm::vec3)>& density,
                     double delta, int count, int parts = 1);

/// Integral of f over the sphere, by adaptive quadrature on such cells.
double integral_over_sphere(const std::function<Draw()>& draw, const std::function<double(glm::vec3)>& f);

/// z = (mean of values - expected) / (s / sqrt(n)), of independent values.
double z_score(std::span<const double> values, double expected);

}  // namespace kiloband::test
