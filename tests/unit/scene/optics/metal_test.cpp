// Tables of the directional emissivity of metals: the bounds that metal_emissivity.hpp states.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "scene/optics/metal_emissivity.hpp"

namespace kiloband::test {
namespace {

RegularTable table(double from_nm, double to_nm, std::vector<double> values) {
  RegularTable t;
  t.min_nm = from_nm;
  t.step_nm = (to_nm - from_nm) / static_cast<double>(values.size() - 1);
  t.values = std::move(values);
  t.extrapolate = true;
  return t;
}

/// Aluminium-like from 0.4 to 20 um.
const RegularTable kIndex = table(400, 20000, {0.5, 8, 25, 40, 61});
const RegularTable kAbsorption = table(400, 20000, {4.8, 50, 90, 125, 150});
const RegularTable kUntinted = table(400, 20000, {1, 1});
const Channel kRange{400, 20000, ""};

/// The formula of the header, facet by facet.
double exact(const std::optional<Facets>& f, const glm::dvec3& v, double n, double k) {
  if (!f) return metal_absorptance(v.z, n, k);
  double albedo = 0, absorbed = 0;
  for (const VisibleFacet& facet : visible_facets(*f, v)) {
    const double c = std::min(glm::dot(v, facet.normal), 1.0);
    const double weight = facet.weight * f->masking(2 * c * facet.normal - v);
    albedo += weight;
    absorbed += weight * metal_absorptance(c, n, k);
  }
  const double reflectance =
      (albedo - absorbed) * (1 + (1 - metal_absorptance(1, n, k)) * (1 - albedo) / albedo);
  return 1 - reflectance;
}

double interpolated(const MetalEmissivity& metal, const std::vector<RegularTable>& rows, double cosine,
                    double s, double lambda_nm) {
  const std::vector<double>& c = metal.cosines();
  const auto i = std::min(static_cast<std::size_t>(std::upper_bound(c.begin(), c.end(), cosine) - c.begin()),
                          c.size() - 1) -
                 1;
  const double t = (cosine - c[i]) / (c[i + 1] - c[i]);
  const auto at = [&](std::size_t j) {
    return (1 - t) * rows[j * c.size() + i](lambda_nm) + t * rows[j * c.size() + i + 1](lambda_nm);
  };
  if (metal.nodes_s() == 1) return at(0);
  const double position = s * (metal.nodes_s() - 1);
  const auto j = std::min(static_cast<std::size_t>(position), std::size_t{metal.nodes_s()} - 2);
  return (1 - (position - static_cast<double>(j))) * at(j) + (position - static_cast<double>(j)) * at(j + 1);
}

TEST(MetalEmissivity, InterpolationKeepsItsBounds) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  const std::optional<Facets> cases[] = {std::nullopt, Facets(true, 0.1, 0.1), Facets(false, 0.5, 0.5),
                                         Facets(true, 0.4, 0.1)};
  for (const auto& f : cases) {
    const MetalEmissivity metal({kIndex, kAbsorption, kUntinted}, f, kRange);
    const std::vector<RegularTable> rows = metal.rows();
    ASSERT_EQ(rows.size(), metal.cosines().size() * metal.nodes_s());
    EXPECT_LE(metal.cosines().size(), 200u);
    for (int i = 0; i < 150; ++i) {
      const double cosine = std::max(1e-3, i % 2 ? uniform(random) : std::pow(uniform(random), 5));
      const double phi = M_PI / 2 * uniform(random),
                   lambda = kRange.min_nm + kRange.width_nm() * uniform(random);
      const double sine = std::sqrt(1 - cosine * cosine);
      const glm::dvec3 v(sine * std::cos(phi), sine * std::sin(phi), cosine);
      const double au = f ? f->alpha_u : 1, av = f ? f->alpha_v : 1;
      const double s = av * v.y * v.y / (au * v.x * v.x + av * v.y * v.y);
      const double expected = exact(f, v, kIndex(lambda), kAbsorption(lambda));
      // Cosine and s may each be off by the bound; wavelengths by a tenth of it.
      const double allowed =
          (metal.nodes_s() > 1 ? 2.1 : 1.1) * std::min(1e-4, std::max(1e-3 * expected, 1e-6));
      EXPECT_NEAR(interpolated(metal, rows, cosine, s, lambda), expected, allowed)
          << cosine << " " << phi << " " << lambda;
    }
  }
}

/// Perfect conductors of n = 0 absorb nothing at any angle.
TEST(MetalEmissivity, LosslessMetalsEmitNothing) {
  const RegularTable zero = table(400, 20000, {0, 0});
  for (const auto& f : {std::optional<Facets>(), std::optional(Facets(true, 0.3, 0.3))}) {
    const MetalEmissivity metal({zero, kAbsorption, kUntinted}, f, kRange);
    for (const RegularTable& row : metal.rows())
      for (const double value : row.values) EXPECT_NEAR(value, 0, 1e-12);
  }
}

TEST(MetalEmissivity, FactorsOnTheReflectanceAbsorb) {
  const RegularTable half = table(400, 20000, {0.5, 0.5});
  const MetalEmissivity metal({kIndex, kAbsorption, half}, std::nullopt, kRange);
  const double a = metal_absorptance(1, kIndex(10000), kAbsorption(10000));
  EXPECT_NEAR(metal.rows().back()(10000), 0.5 + 0.5 * a, 1e-5);
  EXPECT_NEAR(metal.normal_reflectance()(10000), 0.5 * (1 - a), 1e-5);
}

}  // namespace
}  // namespace kiloband::test
