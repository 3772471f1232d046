// Pearson's chi-square test of samples against a density, for the tests of lights and cameras.
#pragma once

#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <random>
#include <vector>

namespace kiloband::testing {

/// Every chi-square and z test of this program fails with at most this probability if the code is right.
/// Seeds are fixed, so a run either always passes or always fails.
inline constexpr double kErrorRate = 1e-5;
/// The same for a two-sided z test: |z| below this (4.42 standard errors).
inline constexpr double kZLimit = 4.42;

/// Uniform numbers in [0, 1) with 24 bits.
class Uniform {
 public:
  explicit Uniform(uint32_t seed) : engine_(seed) {}
  float operator()() { return static_cast<float>(engine_() >> 8) * 0x1p-24f; }
  glm::vec2 pair() {
    const float x = (*this)();
    return {x, (*this)()};
  }

 private:
  std::mt19937 engine_;
};

/// A uniformly distributed unit vector, by rejection.
inline glm::dvec3 random_direction(Uniform& uniform) {
  for (;;) {
    const glm::dvec3 v(2.0 * uniform() - 1, 2.0 * uniform() - 1, 2.0 * uniform() - 1);
    const double length = glm::length(v);
    if (length > 0.01 && length < 1) return v / length;
  }
}

/// Probability of a chi-square as large as this one. Bins that expect less than 5 are pooled; a bin that
/// expects 0 must be empty (otherwise 0 is returned).
inline double chi_square_p_value(const std::vector<double>& observed, const std::vector<double>& expected) {
  double statistic = 0, pooled_observed = 0, pooled_expected = 0;
  int bins = 0;
  const auto add = [&](double o, double e) {
    statistic += (o - e) * (o - e) / e;
    ++bins;
  };
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] >= 5) {
      add(observed[i], expected[i]);
    } else {
      pooled_observed += observed[i];
      pooled_expected += expected[i];
    }
  }
  if (pooled_expected >= 1) add(pooled_observed, pooled_expected);
  if (pooled_expected < 1 && pooled_observed > 20) return 0;
  if (bins < 2) return 0;  // nothing was tested
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(bins - 1), statistic));
}

/// Bins over the directions within a cone about an axis: rings of equal solid angle times sectors.
class DirectionBins {
 public:
  /// cos_min  the cone's edge; -1: the whole sphere
  DirectionBins(glm::dvec3 axis, double cos_min, int rings, int sectors)
      : z_(glm::normalize(axis)), cos_min_(cos_min), rings_(rings), sectors_(sectors) {
    const glm::dvec3 helper = std::fabs(z_.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    x_ = glm::normalize(glm::cross(helper, z_));
    y_ = glm::cross(z_, x_);
  }

  int count() const { return rings_ * sectors_; }

  /// -1 outside the cone.
  int index(glm::dvec3 d) const {
    const double height = (1 - glm::dot(d, z_)) / (1 - cos_min_);
    double turn = std::atan2(glm::dot(d, y_), glm::dot(d, x_)) / (2 * kPi);
    if (turn < 0) turn += 1;
    const int ring = static_cast<int>(height * rings_);
    if (ring < 0 || ring >= rings_) return -1;
    return ring * sectors_ + std::min(static_cast<int>(turn * sectors_), sectors_ - 1);
  }

  /// Integrals of density(direction) over the bins: n x n jittered points in each.
  template <typename Density>
  std::vector<double> integrate(const Density& density, int n) const {
    std::vector<double> integrals(count());
    Uniform jitter(12345);
    const double solid_angle = 2 * kPi * (1 - cos_min_) / count();
    for (int i = 0; i < count(); ++i) {
      double sum = 0;
      for (int a = 0; a < n; ++a) {
        for (int b = 0; b < n; ++b) {
          const double ring = i / sectors_ + (a + jitter()) / n;
          sum += density(direction(ring, i % sectors_ + (b + jitter()) / n));
        }
      }
      integrals[i] = sum / (n * n) * solid_angle;
    }
    return integrals;
  }

 private:
  glm::dvec3 direction(double ring, double sector) const {
    const double cos_theta = 1 - ring / rings_ * (1 - cos_min_);
    const double sin_theta = std::sqrt(std::max(0.0, 1 - cos_theta * cos_theta));
    const double phi = 2 * kPi * sector / sectors_;
    return sin_theta * (std::cos(phi) * x_ + std::sin(phi) * y_) + cos_theta * z_;
  }

  static constexpr double kPi = 3.141592653589793238463;
  glm::dvec3 x_, y_, z_;
  double cos_min_;
  int rings_, sectors_;
};

}  // namespace kiloband::testing
