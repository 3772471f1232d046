// Fresnel reflectances against closed forms (which check the oracle too) and, over a wide grid,
// against the oracle.
#include <cmath>

#include "random_scene.hpp"
#include "validation/oracle/evaluate_reference.hpp"

namespace kiloband::test::test_fresnel {
namespace {

/// A scene whose channel k sees index n_k + i k_k, one path per cosine that reflects there towards
/// a lamp of radiance 1.
struct FresnelCase {
  FresnelCase(std::vector<double> n, std::vector<double> k, uint32_t kind, std::vector<float> cosines) {
    const std::size_t count = n.size();
    for (std::size_t i = 0; i < count; ++i) scene.channels.push_back({500.0 + 2.0 * i, 501.0 + 2.0 * i, {}});
    scene.channel_scale.assign(count, 1.0);
    n.push_back(1);  // tables have at least 2 entries
    k.push_back(1);
    scene.spectra = {row(table(500, 2, n)), row(table(500, 2, k)), row(table(400, 1e6, {1, 1}, true)),
                     row(table(400, 1e6, {1, 1}, true), true)};
    KbMaterial material{};
    material.eta_row = 0;
    material.k_row = kind == KB_KIND_CONDUCTOR ? 1 : KB_NONE;
    material.ext_row = KB_NONE;
    material.eta_ext = 1;
    scene.materials = {material};
    for (float cosine : cosines) {
      KbPathVertex vertex{};
      vertex.head = kind | KB_VERTEX_NEE;
      vertex.row_a = 2;
      vertex.nee_row = 3;
      vertex.nee0 = 1;
      vertex.nee1 = cosine;
      paths.paths.push_back(
          {static_cast<uint32_t>(paths.entries.size()), 1, static_cast<uint32_t>(paths.entries.size())});
      paths.entries.push_back(vertex);
    }
  }

  FlatScene scene;
  PathBuffer paths;
};

double reflectance(double n, double k, uint32_t kind, float cosine, Isa isa) {
  const FresnelCase one({n}, {k}, kind, {cosine});
  const double value = evaluate(one.scene, {}, one.paths, isa, 0)[0];
  EXPECT_NEAR(evaluate_path_reference(one.scene, {}, one.paths, 0, 0)[0], value, 1e-6 * value + 1e-12);
  return value;
}

/// Of channels with indices n + ik, at each cosine, against the oracle.
void expect_conductors(const std::vector<double>& n, const std::vector<double>& k,
                       const std::vector<float>& cosines, Isa isa, double tolerance) {
  const FresnelCase grid(n, k, KB_KIND_CONDUCTOR, cosines);
  const Evaluator layout(grid.scene, {}, isa);
  const std::vector<float> sums = evaluate(grid.scene, {}, grid.paths, isa, 0);
  for (std::size_t p = 0; p < cosines.size(); ++p) {
    const std::vector<double> expected = evaluate_path_reference(grid.scene, {}, grid.paths, p, 0);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      // Without a boundary the oracle returns its own rounding.
      const double floor = n[i] == 1 && k[i] == 0 ? 1e-14 : 1e-30;
      EXPECT_NEAR(sums[p * layout.stride() + i], expected[i], tolerance * expected[i] + floor)
          << "n " << n[i] << " k " << k[i] << " cos " << cosines[p];
    }
  }
}

class Fresnel : public EachIsa {};

TEST_P(Fresnel, ClosedForms) {
  const auto glass = [&](double n, double cosine) {
    return reflectance(n, 0, KB_KIND_DISPERSIVE, static_cast<float>(cosine), GetParam());
  };
  EXPECT_NEAR(glass(1.5, 1), 0.04, 1e-8);   // ((n-1)/(n+1))^2
  EXPECT_NEAR(glass(1.5, -1), 0.04, 1e-8);  // the same from inside
  EXPECT_EQ(glass(1.5, -0.5), 1);           // beyond the critical angle, cos 0.745
  EXPECT_NEAR(glass(1.5, 1e-5), 1, 1e-3);   // grazing
  const double brewster = 0.5 * std::pow((1.5 * 1.5 - 1) / (1.5 * 1.5 + 1), 2);
  EXPECT_NEAR(glass(1.5, 1 / std::sqrt(3.25)), brewster, 1e-7);  // only R_s is left
  EXPECT_EQ(glass(1, 0.7), 0);                                   // no boundary
  const auto metal = [&](double n, double k, double cosine) {
    return reflectance(n, k, KB_KIND_CONDUCTOR, static_cast<float>(cosine), GetParam());
  };
  EXPECT_NEAR(metal(0.2, 3.4, 1), (0.64 + 11.56) / (1.44 + 11.56), 1e-6);
  EXPECT_NEAR(metal(1.5, 0, 1), 0.04, 1e-8);
  EXPECT_NEAR(metal(0, 1, 0.3), 1, 1e-6);  // the perfect mirror
}

TEST_P(Fresnel, ConductorsOfAllKinds) {
  std::vector<double> n, k;
  for (double index :
       {1e-3, 0.02, 0.3, 0.9, 0.999, 0.999999, 1.0, 1.000001, 1.0003, 1.01, 1.5, 4.0, 30.0, 100.0}) {
    for (double absorption : {0.0, 1e-7, 1e-4, 1e-3, 0.03, 0.3, 1.0, 3.0, 10.0, 100.0}) {
      n.push_back(index);
      k.push_back(absorption);
    }
  }
  std::vector<float> cosines = {1, 0.9999f, 0.99f, 0.9f, 0.7f, 0.5f, 0.3f, 0.1f, 0.01f, 0.001f, 1e-5f};
  // Critical angles of 0.9 and 0.3: the square root of a difference.
  for (double index : {0.9, 0.3}) cosines.push_back(static_cast<float>(std::sqrt(1 - index * index)));
  expect_conductors(n, k, cosines, GetParam(), 1e-5);
}

/// Four units in the last place and the rounding of a cosine's square. Indices from alkali metals' to those of metals in the thermal infrared,
/// silicon's and silver's among them.
TEST_P(Fresnel, MetalsKeepTheirDigits) {
  std::vector<double> n, k;
  for (double index : {1e-3, 0.05, 0.15, 0.5, 0.8, 1.0, 1.4, 2.5, 4.0, 30.0, 300.0, 5000.0}) {
    for (double absorption : {1.5, 2.2, 3.4, 5.0, 7.0, 20.0, 100.0, 1000.0, 5000.0}) {
      n.push_back(index);
      k.push_back(absorption);
    }
  }
  n.push_back(4.1), k.push_back(0.04);
  const std::vector<float> cosines = {1,     0.9999f, 0.99f,  0.9f,   0.7f,  0.5f,  0.3f, 0.1f,
                                      0.03f, 0.01f,   0.003f, 0.001f, 1e-4f, 1e-5f, 0};
  expect_conductors(n, k, cosines, GetParam(), 5e-7);
}

/// What stands behind the last channel is no number at a cosine whose square is 0, if nothing sees to it, and 0 times that is none.
TEST_P(Fresnel, MetalsAtGrazingIncidenceLeaveThePaddingAlone) {
  for (const std::size_t count : {1u, 3u, 20u, 64u, 109u}) {
    const FresnelCase grazing(std::vector<double>(count, 0.5), std::vector<double>(count, 3),
                              KB_KIND_CONDUCTOR, {0, 1e-23f, 1e-10f});
    DerivedChannels derived;
    derived.names = {"all"};
    derived.responses = {table(400, 1000, {1, 1}, true)};
    const Evaluator layout(grazing.scene, derived, GetParam());
    const std::vector<float> sums = evaluate(grazing.scene, derived, grazing.paths, GetParam(), 0);
    for (std::size_t p = 0; p < 3; ++p) {
      const float* film = &sums[p * layout.stride()];
      for (std::size_t k = 0; k < count; ++k) EXPECT_NEAR(film[k], 1, 1e-6);
      EXPECT_NEAR(film[layout.derived_offset()], count, 1e-5 * count);
    }
  }
}

TEST_P(Fresnel, DielectricsNearTheCriticalAngle) {
  std::vector<double> n;
  for (int i = 0; i < 200; ++i) n.push_back(1.0001 + 0.01 * i);
  std::vector<float> cosines = {1, -1, 0.5f, -0.8f, 0.01f, -0.999f};
  for (double index : {1.0001, 1.1001, 1.5001, 2.0001})
    for (double offset : {-1e-3, -1e-5, -1e-7, 0.0, 1e-7, 1e-6, 1e-4})
      cosines.push_back(static_cast<float>(-std::sqrt(1 - 1 / (index * index)) + offset));
  const FresnelCase grid(n, std::vector<double>(n.size()), KB_KIND_DISPERSIVE, cosines);
  const Evaluator layout(grid.scene, {}, GetParam());
  const std::vector<float> sums = evaluate(grid.scene, {}, grid.paths, GetParam(), 0);
  for (std::size_t p = 0; p < cosines.size(); ++p) {
    const std::vector<double> expected = evaluate_path_reference(grid.scene, {}, grid.paths, p, 0);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(sums[p * layout.stride() + i], expected[i], 1e-5 * expected[i])
          << "n " << n[i] << " cos " << cosines[p];
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, Fresnel, testing::ValuesIn(available_isas()), isa_name);

}  // namespace
}  // namespace kiloband::test::test_fresnel
