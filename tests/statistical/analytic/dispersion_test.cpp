// Channels at boundaries whose index depends on wavelength.
//
// Where a smooth boundary refracts, one of K channels goes on, with weight 1 / probability (degradation);
// reflection keeps all of them. Rough boundaries keep all channels by spectral MIS, or degrade the path on
// arrival. The mean of every channel must be Fresnel's value where one is known, and otherwise what the
// channel rendered alone gives: two renders are compared, both with their error bars.
//
// Error rate: 1e-4 for the whole program. Detectable bias: stated with each test.
#include <cmath>
#include <numbers>

#include "tests/statistical/analytic/dispersive_glass.hpp"
#include "tests/statistical/analytic/fresnel_exact.hpp"
#include "tests/statistical/analytic/gas/gas_scenes.hpp"
#include "tests/support/effort.hpp"

namespace kiloband::test::dispersion_test {
namespace {

constexpr double kPi = std::numbers::pi;

/// A plane of dispersive glass: reflection keeps all channels, transmission one.
/// Detectable bias: 1.5 %.
TEST(Dispersion, PlaneBoundaryPerWavelength) {
  const TemporaryFolder folder;
  folder.write("glass.txt", index_columns());
  const double theta = 70 * kPi / 180;
  const std::string camera =
      perspective(lookat(point(-4 * std::sin(theta), 0, 4 * std::cos(theta)), "0, 0, 0"), 0.05, film(8));
  const std::string plane = shape("rectangle", to_world(scale("3, 3, 1")) + glass("dielectric"));
  for (const bool above : {true, false}) {
    SCOPED_TRACE(above ? "reflected" : "transmitted");
    const std::string way =
        above ? turn("x", "180") + step("translate", "z='5'") : step("translate", "z='-5'");
    const std::string light = shape("rectangle", to_world(scale("60, 60, 1") + way) + lamp(2));
    const RenderResult result =
        render_valid(scene(-1, camera + plane + light), kDispersionBands, {}, {512, 62}, folder.path());
    const Function expected = [=](double nm) {
      const double r = dielectric_reflectance(std::cos(theta), kGlassIndex(nm));
      return 2 * (above ? r : (1 - r) / (kGlassIndex(nm) * kGlassIndex(nm)));
    };
    expect_image_mean(result, channel_integrals(expected, result), 0.015);
  }
}

/// A ball of glass before a coloured square and a dim sky. `material`: the ball's; more: of the scene.
std::string ball_scene(const std::string& material, const std::string& more = "") {
  const Knots colour{{{380, 2}, {500, 4}, {600, 2}, {720, 3}}};
  const std::string square = shape("rectangle", to_world(scale("1, 1, 1") + lookat("0.5, 1, -4", "0, 0, 0")) +
                                                    emitter("area", colour.text("radiance")));
  return scene(-1, perspective(lookat("0, 0, 4", "0, 0, 0"), 30, film(16)) + shape("sphere", material) +
                       square + sky(1) + more);
}

using Ways = std::vector<RoughDispersion>;

/// Image means of all channels together, dispersed in each of the ways, against each channel alone (other seeds), which has
/// nothing to disperse and is rendered once. Detectable bias: 2 %, in as many samples as that takes: 1 / `share` of the most.
void expect_channels_as_alone(const std::string& xml, const Mode& mode, const std::filesystem::path& folder,
                              uint64_t share = 1, const Ways& ways = {RoughDispersion::kSpectralMis}) {
  const uint64_t samples = (mode.sampler == SamplerType::kSobol ? 64 : 96) / share;
  std::vector<RenderResult> together;
  for (const RoughDispersion way : ways) {
    Mode with = mode;
    with.rough_dispersion = way;
    together.push_back(render_valid(xml, kDispersionBands, with, {samples, 63}, folder));
  }
  for (const std::size_t c : {0, 2, 4}) {
    const Channel& channel = together[0].scene.channels[c];
    const std::string alone_band = std::to_string(channel.min_nm) + "-" + std::to_string(channel.max_nm);
    const RenderResult alone = render_valid(xml, alone_band, mode, {32 / share, 64 + c}, folder);
    for (std::size_t way = 0; way < ways.size(); ++way) {
      SCOPED_TRACE(ways[way] == RoughDispersion::kDegrade ? "degradation" : "spectral MIS");
      expect_mean("channel " + std::to_string(c), together[way].image_mean[c],
                  together[way].image_variance[c] + alone.image_variance[0], alone.image_mean[0],
                  together[way].replicates, 0.02);
    }
  }
}

class DegradationTest : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, DegradationTest,
                         ::testing::Values(Mode{WavelengthMode::kShared, SamplerType::kSobol},
                                           Mode{WavelengthMode::kPerPath, SamplerType::kIndependent}),
                         mode_name);

TEST_P(DegradationTest, SmoothBall) {
  const TemporaryFolder folder;
  folder.write("glass.txt", index_columns());
  expect_channels_as_alone(ball_scene(glass("dielectric")), GetParam(), folder.path());
}

TEST_P(DegradationTest, ColouredBall) {
  const TemporaryFolder folder;
  folder.write("glass.txt", index_columns());
  const Knots red{{{380, 0.05}, {520, 0.1}, {600, 0.8}, {720, 0.9}}};
  expect_channels_as_alone(ball_scene(glass("dielectric", red.text("specular_transmittance"))), GetParam(),
                           folder.path(), 2);
}

/// Both ways; without KILOBAND_THOROUGH each in one of the modes, while RoughBallOfGas has heroes in both.
TEST_P(DegradationTest, RoughBall) {
  const bool shared = GetParam().wavelengths == WavelengthMode::kShared;
  Ways ways{shared ? RoughDispersion::kSpectralMis : RoughDispersion::kDegrade};
  if (thorough()) ways.push_back(shared ? RoughDispersion::kDegrade : RoughDispersion::kSpectralMis);
  const TemporaryFolder folder;
  folder.write("glass.txt", index_columns());
  expect_channels_as_alone(ball_scene(glass("roughdielectric", real("alpha", 0.2))), GetParam(),
                           folder.path(), shared && !thorough() ? 2 : 1, ways);
}

/// A rough ball of glass with gas in it, in an atmosphere: what every hero's ray passes follows its light.
TEST_P(DegradationTest, RoughBallOfGas) {
  const TemporaryFolder folder;
  folder.write("glass.txt", index_columns());
  const Knots smoke{{{380, 0.2}, {500, 0.9}, {600, 0.3}, {720, 0.1}}}, haze{{{380, 0.1}, {720, 0.02}}};
  const std::string ball =
      glass("roughdielectric", real("alpha", 0.2)) + gas("interior", smoke.text("absorption"), 2500);
  expect_channels_as_alone(ball_scene(ball, gas("atmosphere", haze.text("absorption"))), GetParam(),
                           folder.path(), 2);
}

/// A channel among 32 of a narrow lobe, which the heroes of most paths do not hit, against the channel alone.
/// Detectable bias: 3 %.
TEST(Dispersion, NarrowLobeByHeroes) {
  const TemporaryFolder folder;
  folder.write("glass.txt", index_columns());
  const std::string xml = ball_scene(glass("roughdielectric", real("alpha", 0.01)));
  const RenderResult together = render_valid(xml, "400:700:32", {}, {48, 80}, folder.path());
  for (const std::size_t c : {0, 13, 31}) {
    const Channel& channel = together.scene.channels[c];
    const std::string alone_band = std::to_string(channel.min_nm) + "-" + std::to_string(channel.max_nm);
    const RenderResult alone = render_valid(xml, alone_band, {}, {32, 81 + c}, folder.path());
    expect_mean("channel " + std::to_string(c), together.image_mean[c],
                together.image_variance[c] + alone.image_variance[0], alone.image_mean[0],
                together.replicates, 0.03);
  }
}

/// What spectral MIS is for: the error bars of the same samples, degraded and not. The ratio of variances is
/// about 150 here; a twentieth of the gain would already be a defect.
TEST(Dispersion, HeroesHaveLessVariance) {
  const TemporaryFolder folder;
  folder.write("glass.txt", index_columns());
  const std::string xml = ball_scene(glass("roughdielectric", real("alpha", 0.1)));
  double variance[2] = {0, 0};
  for (const RoughDispersion how : {RoughDispersion::kDegrade, RoughDispersion::kSpectralMis}) {
    Mode mode;
    mode.rough_dispersion = how;
    const RenderResult result = render_valid(xml, "400:700:32", mode, {4, 90}, folder.path());
    for (const double v : result.variance) variance[how == RoughDispersion::kSpectralMis] += v;
  }
  std::printf("variance of pixels, degradation over spectral MIS: %.1f\n", variance[0] / variance[1]);
  EXPECT_GT(variance[0] / variance[1], 8);
}

/// A white sky alone: a smooth ball of glass vanishes in every channel, dispersive or not.
/// Detectable bias: 1 %.
TEST(Dispersion, GlassBallVanishesInTheFurnace) {
  const TemporaryFolder folder;
  folder.write("glass.txt", index_columns());
  const std::string xml = scene(-1, perspective(lookat("0, 0, 4", "0, 0, 0"), 30, film(16)) +
                                        shape("sphere", glass("dielectric")) + sky(1));
  const RenderResult result = render_valid(xml, kDispersionBands, {}, {128, 70}, folder.path());
  expect_image_mean(result, {10, 10, 10, 10, 10}, 0.01);
}

}  // namespace
}  // namespace kiloband::test::dispersion_test
