// Closed enclosures whose walls all emit Le and reflect rho diffusely.
//
// With uniform Lambertian walls every point sees nothing but wall, so the radiance L is the same everywhere
// and in every direction: L = Le + rho L, L = Le / (1 - rho). Cut after n vertices (max_depth n) the Neumann
// series gives Le (1 + rho + ... + rho^(n-1)) = Le (1 - rho^n) / (1 - rho). Roulette must not change the
// unlimited value. Channel values are the integrals over wavelength of these functions; Le and rho are linear
// within each channel.
//
// Error rate: 1e-4 for the whole program. Detectable bias of every channel's image mean:
// stated with each test.
#include <cmath>

#include "spectral/planck.hpp"
#include "tests/statistical/analytic/analytic_test.hpp"

namespace kiloband::test::enclosure_test {
namespace {

const char* const kBands = "400-420, 500-520, 600-620, 780-800";
const Knots kRadiance{{{400, 1}, {500, 2}, {600, 3}, {640, 2.7}, {800, 10}}};
const Knots kReflectance{{{400, 0.1}, {500, 0.4}, {600, 0.6}, {640, 0.55}, {800, 0.3}}};

std::string wall() {
  return bsdf("diffuse", kReflectance.text("reflectance")) + emitter("area", kRadiance.text("radiance"));
}

/// Six rectangles that face the centre: x, y and z = +-1.
std::string six_rectangles() {
  std::string sides;
  for (const char* turn : {"x=\"1\" angle=\"0\"", "x=\"1\" angle=\"90\"", "x=\"1\" angle=\"180\"",
                           "x=\"1\" angle=\"270\"", "y=\"1\" angle=\"90\"", "y=\"1\" angle=\"270\""}) {
    sides +=
        shape("rectangle", to_world("<translate z=\"-1\"/><rotate " + std::string(turn) + "/>") + wall());
  }
  return sides;
}

struct Enclosure {
  const char* name;
  std::string shapes;
};

std::vector<Enclosure> enclosures() {
  return {{"cube", shape("cube", kInwards + wall())},
          {"rectangles", six_rectangles()},
          {"sphere", shape("sphere", kInwards + real("radius", 2) + wall())}};
}

std::string camera(uint32_t size) {
  return perspective(lookat("0.3, -0.2, 0.4", "-0.5, 0.1, -0.9"), 60, film(size));
}

Function series(int depth) {
  return [depth](double lambda_nm) {
    const double rho = kReflectance(lambda_nm);
    return kRadiance(lambda_nm) * (depth < 0 ? 1 : 1 - std::pow(rho, depth)) / (1 - rho);
  };
}

class EnclosureTest : public ::testing::TestWithParam<Mode> {};

/// Detectable bias: 0.5 % of each channel.
TEST_P(EnclosureTest, UnlimitedDepthGivesTheGeometricSeries) {
  for (const Enclosure& enclosure : enclosures()) {
    SCOPED_TRACE(enclosure.name);
    const RenderResult result =
        render_valid(scene(-1, camera(16) + enclosure.shapes), kBands, GetParam(), {16, 3});
    const std::vector<double> expected = channel_integrals(series(-1), result);
    expect_image_mean(result, expected, 0.005);
    for (const auto& [x, y] : {std::pair{0u, 0u}, {15u, 0u}, {7u, 9u}}) expect_pixel(result, x, y, expected);
  }
}

INSTANTIATE_TEST_SUITE_P(Modes, EnclosureTest, ::testing::ValuesIn(all_modes()), mode_name);

/// max_depth 1 shows the emission alone; 8 reaches into roulette. Detectable bias: 0.5 %.
TEST(Enclosure, LimitedDepthGivesPartialSums) {
  for (const Enclosure& enclosure : enclosures()) {
    for (const int depth : {1, 2, 4, 8}) {
      SCOPED_TRACE(enclosure.name + std::string(" depth ") + std::to_string(depth));
      const RenderResult result =
          render_valid(scene(depth, camera(16) + enclosure.shapes), kBands, {}, {8, 4});
      expect_image_mean(result, channel_integrals(series(depth), result), 0.005);
    }
  }
}

/// max_depth 0 shows nothing.
TEST(Enclosure, DepthZeroIsBlack) {
  const RenderResult result = render_valid(scene(0, camera(8) + enclosures()[0].shapes), kBands, {}, {2});
  expect_exactly(result, {0, 0, 0, 0});
}

/// Walls of 300 K that reflect nothing show Planck's law integrated over each channel; there is no variance
/// but that of the wavelength. With reflectance 0.5 the enclosure is twice as bright. Detectable bias: 0.2 %.
TEST(Enclosure, ThermalBoxShowsPlancksLaw) {
  const std::string light = emitter(
      "area", "<spectrum name=\"radiance\" type=\"planck\">" + real("temperature", 300) + "</spectrum>");
  for (const double reflectance : {0.0, 0.5}) {
    const std::string box = shape("cube", kInwards + diffuse(reflectance) + light);
    for (const Mode& mode : tried_modes()) {
      SCOPED_TRACE(name_of(mode));
      const RenderResult result = render_valid(scene(-1, camera(16) + box), "8000:12000:8", mode, {8, 5});
      std::vector<double> expected;
      for (const Channel& channel : result.scene.channels) {
        expected.push_back(planck_integral(channel.min_nm, channel.max_nm, 300) / (1 - reflectance));
      }
      expect_image_mean(result, expected, 0.005);
    }
  }
}

/// The extremes of the temperature and wavelength range, far outside what single precision holds: 0.3 um at
/// 200 K is about 1e-96, 20 um at 6000 K is next to 0.5 um at 6000 K. Expected without planck_integral():
/// Simpson's rule on B = 2 h c^2 / lambda^5 / (exp(h c / (lambda k T)) - 1) here, in double.
double planck_density(double lambda_nm, double temperature_k) {
  constexpr double kH = 6.62607015e-34, kC = 299792458.0, kK = 1.380649e-23;
  const double lambda = lambda_nm * 1e-9;
  return 2 * kH * kC * kC / std::pow(lambda, 5) / std::expm1(kH * kC / (lambda * kK * temperature_k)) * 1e-9;
}

TEST(Enclosure, ExtremesOfPlancksLawNeitherVanishNorOverflow) {
  for (const auto& [temperature, bands] : {std::pair{200.0, "299.5-300.5, 300-301, 10000-10010"},
                                           std::pair{6000.0, "300-301, 500-501, 19990-20000"}}) {
    SCOPED_TRACE(temperature);
    const std::string light = emitter("area", "<spectrum name=\"radiance\" type=\"planck\">" +
                                                  real("temperature", temperature) + "</spectrum>");
    const std::string box = shape("cube", kInwards + diffuse(0.5) + light);
    const RenderResult result = render_valid(scene(-1, camera(16) + box), bands, {}, {16, 6});
    const double t = temperature;
    const std::vector<double> expected =
        channel_integrals([t](double nm) { return planck_density(nm, t); }, result);
    std::vector<double> doubled;
    for (const double value : expected) doubled.push_back(2 * value);
    expect_image_mean(result, doubled, 0.005);
  }
}

TEST(Enclosure, ThirdOfAMicrometreAt200KelvinIsTheTextbookMagnitude) {
  EXPECT_GT(planck_density(300, 200), 1e-97);
  EXPECT_LT(planck_density(300, 200), 1e-95);
}

/// Expected values of this file that are 1 % wrong must be noticed: the comparison itself is put to the test.
TEST(Enclosure, ComparisonNoticesOnePercent) {
  const RenderResult result =
      render_valid(scene(-1, camera(16) + enclosures()[0].shapes), kBands, {}, {16, 3});
  std::vector<double> wrong = channel_integrals(series(-1), result);
  for (std::size_t c = 0; c < wrong.size(); ++c) {
    EXPECT_GT(std::abs(result.image_mean[c] / wrong[c] / 1.01 - 1),
              critical_t(kFamilyErrorRate, kComparisons, result.replicates) *
                  std::sqrt(result.image_variance[c]) / wrong[c]);
  }
}

}  // namespace
}  // namespace kiloband::test::enclosure_test
