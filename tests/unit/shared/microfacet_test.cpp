// Microfacet distributions: normalisations, masking against its definition, sampling against densities.
#include "shared/microfacet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/unit/shared/chi_square.hpp"

namespace {

using kiloband::testing_tools::DirectionGrid;
using kiloband::testing_tools::DirectionTest;
using kiloband::testing_tools::integrate_cell;
using kiloband::testing_tools::kTestLevel;
using kiloband::testing_tools::test_directions;
using kiloband::testing_tools::uniform_pair;

constexpr double kPi = 3.14159265358979324;

struct Roughness {
  float u, v;
};

constexpr Roughness kRoughnesses[] = {{0.5f, 0.5f}, {0.1f, 0.1f}, {0.2f, 0.6f}, {1.0f, 0.7f}};
constexpr kb_u32 kDistributions[] = {KB_MICROFACET_BECKMANN, KB_MICROFACET_GGX};

KbFloat3 direction(double theta, double phi) {
  return kb_float3(static_cast<float>(std::sin(theta) * std::cos(phi)),
                   static_cast<float>(std::sin(theta) * std::sin(phi)), static_cast<float>(std::cos(theta)));
}

DirectionGrid hemisphere(int cells, int sub_cells) {
  DirectionGrid grid;
  grid.theta_cells = grid.phi_cells = cells;
  grid.theta_max = kPi / 2;
  grid.sub_cells = sub_cells;
  return grid;
}

double integrate(const DirectionGrid& grid, const auto& density) {
  double sum = 0;
  for (int i = 0; i < grid.theta_cells; ++i)
    for (int j = 0; j < grid.phi_cells; ++j) sum += integrate_cell(grid, i, j, density);
  return sum;
}

TEST(Microfacet, DistributionTimesCosineIntegratesToOne) {
  for (const kb_u32 distribution : kDistributions)
    for (const auto [au, av] : {Roughness{0.5f, 0.5f}, {0.02f, 0.02f}, {0.1f, 0.5f}, {1.5f, 0.7f}}) {
      const auto density = [=](const KbFloat3& m) { return kb_microfacet_all_pdf(distribution, au, av, m); };
      EXPECT_NEAR(integrate(hemisphere(30, 1), density), 1, 2e-5) << distribution << ' ' << au << ' ' << av;
    }
}

// Smith's G1 by its meaning: the projected area of the visible facets is that of the surface,
//   integral G1(v, m) max(0, v.m) D(m) dm = v.z.
// This is what normalises the density of visible normals, with G1 as closed form against the integral without
// it: 1 + Lambda = (1 / v.z) integral max(0, v.m) D(m) dm.
TEST(Microfacet, MaskingNormalisesVisibleNormals) {
  for (const kb_u32 distribution : kDistributions)
    for (const auto [au, av] : kRoughnesses)
      for (const double theta : {0.0, 0.5, 1.2, 1.5}) {
        const KbFloat3 v = direction(theta, 0.4);
        const auto area = [=, au = au, av = av](const KbFloat3& m) {
          return kb_microfacet_d(distribution, au, av, m) * kb_fmax(0.0f, kb_dot3(v, m));
        };
        const double integral = integrate(hemisphere(40, 1), area) / v.z;
        const double g1 = kb_microfacet_g1(distribution, au, av, v, v);
        EXPECT_NEAR(integral * g1, 1, 4e-4) << distribution << ' ' << au << ' ' << av << ' ' << theta;
      }
}

TEST(Microfacet, MaskingIsZeroOnTheWrongSide) {
  const KbFloat3 up = direction(0.3, 0);
  const KbFloat3 down = kb_float3(-up.x, -up.y, -up.z);
  const KbFloat3 tilted = direction(1.5, kPi);
  for (const kb_u32 distribution : kDistributions) {
    EXPECT_EQ(kb_microfacet_g1(distribution, 0.5f, 0.5f, direction(1.2, 0), tilted), 0.0f);
    // From below, facets (their normals point up) are seen from their backs: by symmetry as from above.
    EXPECT_EQ(kb_microfacet_g1(distribution, 0.5f, 0.5f, direction(2.5, 0), direction(1.2, 0)), 0.0f);
    EXPECT_EQ(kb_microfacet_g1(distribution, 0.5f, 0.5f, down, up),
              kb_microfacet_g1(distribution, 0.5f, 0.5f, up, up));
    EXPECT_EQ(kb_microfacet_g1(distribution, 0.5f, 0.5f, direction(0, 0), direction(0.1, 0)), 1.0f);
    EXPECT_EQ(kb_microfacet_d(distribution, 0.5f, 0.5f, direction(2, 0)), 0.0f);
  }
}

TEST(Microfacet, PeaksAndTailsAreFinite) {
  for (const kb_u32 distribution : kDistributions)
    for (const float alpha : {1e-3f, 1e-2f, 1.0f, 3.0f})
      for (int i = 0; i <= 1000; ++i) {
        const double theta = kPi / 2 * std::pow(i / 1000.0, 3);
        const float d = kb_microfacet_d(distribution, alpha, alpha, direction(theta, 1));
        ASSERT_TRUE(std::isfinite(d) && d >= 0) << alpha << ' ' << theta;
      }
  EXPECT_FLOAT_EQ(kb_microfacet_d(KB_MICROFACET_GGX, 0.1f, 0.2f, direction(0, 0)), 1 / (KB_PI * 0.02f));
  EXPECT_FLOAT_EQ(kb_microfacet_d(KB_MICROFACET_BECKMANN, 0.1f, 0.2f, direction(0, 0)), 1 / (KB_PI * 0.02f));
}

// 200 000 samples, 400 cells: RMS errors of the cells from 2.9 % on are found; error rate in chi_square.hpp.
TEST(Microfacet, SamplesOfAllNormalsMatchTheirDensity) {
  for (const kb_u32 distribution : kDistributions)
    for (const auto [au, av] : kRoughnesses) {
      const auto sample = [=, au = au, av = av](float u, float v) {
        return std::optional(kb_microfacet_sample_all(distribution, au, av, u, v));
      };
      const auto density = [=, au = au, av = av](const KbFloat3& m) {
        return kb_microfacet_all_pdf(distribution, au, av, m);
      };
      const DirectionTest test = test_directions(hemisphere(20, 2), 11, 200'000, sample, density);
      EXPECT_GT(test.chi_square.p_value, kTestLevel) << distribution << ' ' << au << ' ' << av;
      EXPECT_EQ(test.accepted, 1.0);
    }
}

TEST(Microfacet, SamplesOfVisibleNormalsMatchTheirDensity) {
  for (const kb_u32 distribution : kDistributions)
    for (const auto [au, av] : kRoughnesses)
      for (const double theta : {0.0, 0.7, 1.45}) {
        const KbFloat3 wi = direction(theta, 2.1);
        const auto sample = [=, au = au, av = av](float u, float v) {
          return std::optional(kb_microfacet_sample_visible(distribution, au, av, wi, u, v));
        };
        const auto density = [=, au = au, av = av](const KbFloat3& m) {
          return kb_microfacet_visible_pdf(distribution, au, av, wi, m);
        };
        const DirectionTest test = test_directions(hemisphere(20, 2), 12, 100'000, sample, density);
        EXPECT_NEAR(test.integral, 1, 1e-3) << distribution << ' ' << au << ' ' << av << ' ' << theta;
        EXPECT_GT(test.chi_square.p_value, kTestLevel)
            << distribution << ' ' << au << ' ' << av << ' ' << theta;
      }
}

// The numerical inversion for Beckmann against the distribution function in double.
TEST(Microfacet, BeckmannSlopeInvertsItsDistribution) {
  for (const double theta : {1e-4, 0.01, 0.3, 0.8, 1.2, 1.5, 1.57}) {
    const double tan_i = std::tan(theta), top = 1 / tan_i;
    const auto unscaled = [&](double x) {
      return 1 + std::erf(x) + tan_i / std::sqrt(kPi) * std::exp(-x * x);
    };
    for (int i = 1; i < 2000; ++i) {
      const float u = static_cast<float>(i) / 2000;
      const double x = kb_beckmann_visible_slope_x(static_cast<float>(std::sin(theta)),
                                                   static_cast<float>(std::cos(theta)), u);
      ASSERT_NEAR(unscaled(std::min(x, top)) / unscaled(top), u, 2e-6) << theta << ' ' << u;
    }
  }
}

// Extreme arguments: smallest and largest numbers, grazing and normal incidence, small and large roughness.
TEST(Microfacet, SamplesAreFiniteUnitNormals) {
  const float numbers[] = {0.0f, 1e-7f, 0.25f, 0.5f, 0.75f, KB_ONE_MINUS_EPSILON};
  for (const kb_u32 distribution : kDistributions)
    for (const float alpha : {1e-4f, 0.1f, 1.0f, 4.0f})
      for (const float z : {1e-7f, 1e-3f, 0.5f, 0.9999999f, 1.0f})
        for (const float u : numbers)
          for (const float v : numbers) {
            const KbFloat3 wi = kb_float3(std::sqrt(1 - z * z), 0, z);
            for (const KbFloat3& m : {kb_microfacet_sample_visible(distribution, alpha, alpha, wi, u, v),
                                      kb_microfacet_sample_all(distribution, alpha, alpha, u, v)}) {
              ASSERT_NEAR(kb_dot3(m, m), 1, 1e-6)
                  << distribution << ' ' << alpha << ' ' << z << ' ' << u << ' ' << v;
              ASSERT_GE(m.z, 0.0f);
            }
          }
}

}  // namespace
