// Panes and blends of BSDFs in uniform light and by their own heat.
//
// A pane of index n reflects R = 2 F / (1 + F) of light and lets 1 - R through, F Fresnel's reflectance of one face;
// with specular_reflectance a and specular_transmittance b it shows (a R + b (1 - R)) L in a furnace of radiance L, and at
// temperature T in the void (1 - a R - b (1 - R)) B(T). A blend shows the mean of its parts by weight.
#include <cmath>
#include <numbers>

#include "spectral/planck.hpp"
#include "tests/statistical/analytic/analytic_test.hpp"
#include "tests/statistical/analytic/fresnel_exact.hpp"

namespace kiloband::test::blend_test {
namespace {

const char* const kBands = "500-510, 600-620";
constexpr double kA = 0.5, kB = 0.8, kWeight = 0.3;

/// A large square seen at `degrees` from its normal; on: what is on it, around: what is about it.
std::string plane(const std::string& on, double degrees, const std::string& around) {
  const double theta = degrees * std::numbers::pi / 180;
  const std::string eye = point(5 * std::sin(theta), 0, 5 * std::cos(theta));
  return scene(-1, perspective(lookat(eye, "0, 0, 0"), 0.05, film(8)) +
                       shape("rectangle", to_world(scale("10, 10, 1")) + on) + around);
}

std::string pane(double index) {
  return bsdf("thindielectric", real("int_ior", index) + real("ext_ior", 1) +
                                    spectrum("specular_reflectance", kA) +
                                    spectrum("specular_transmittance", kB));
}

double pane_albedo(double index, double degrees) {
  const double f = fresnel_reflectance(std::abs(std::cos(degrees * std::numbers::pi / 180)), index);
  const double r = 2 * f / (1 + f);
  return kA * r + kB * (1 - r);
}

std::string blend(double weight, const std::string& parts) {
  return bsdf("blendbsdf", real("weight", weight) + parts);
}

std::vector<double> widths(const RenderResult& result, double radiance) {
  return channel_integrals([=](double) { return radiance; }, result);
}

/// From both sides (angles above 90 degrees: from behind). Detectable bias: 0.5 %.
TEST(PaneFurnace, ReflectsAndTransmits) {
  for (const double index : {1.5, 2.4}) {
    for (const double degrees : {0.0, 50.0, 80.0, 130.0}) {
      SCOPED_TRACE(degrees);
      const RenderResult result = render_valid(plane(pane(index), degrees, sky(1)), kBands, {}, {64, 51});
      expect_image_mean(result, widths(result, pane_albedo(index, degrees)), 0.005);
    }
  }
}

/// The index is 1.5 in the first channel and 1.8 in the second, in all modes. Detectable bias: 0.8 %.
class PaneTest : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, PaneTest, ::testing::ValuesIn(all_modes()), mode_name);

TEST_P(PaneTest, EveryChannelHasItsIndex) {
  const TemporaryFolder folder;
  folder.write("glass.txt", "400 1.5\n550 1.5\n551 1.8\n800 1.8\n");
  const std::string glass = bsdf("thindielectric", text("int_material", "glass.txt") + real("ext_ior", 1) +
                                                       spectrum("specular_reflectance", kA) +
                                                       spectrum("specular_transmittance", kB));
  for (const double degrees : {10.0, 70.0}) {
    SCOPED_TRACE(degrees);
    const RenderResult result =
        render_valid(plane(glass, degrees, sky(1)), kBands, GetParam(), {96, 52}, folder.path());
    const auto radiance = [&](double lambda) { return pane_albedo(lambda < 550.5 ? 1.5 : 1.8, degrees); };
    expect_image_mean(result, channel_integrals(radiance, result), 0.008);
  }
}

/// What is neither reflected nor transmitted is emitted, on both sides. Detectable bias: 0.5 %.
TEST(PaneEmission, IsWhatIsMissing) {
  const std::string hot = thermal(2000);
  for (const double degrees : {0.0, 70.0, 110.0}) {
    SCOPED_TRACE(degrees);
    const RenderResult result = render_valid(plane(pane(1.5) + hot, degrees, ""), kBands, {}, {160, 53});
    const double emissivity = 1 - pane_albedo(1.5, degrees);
    expect_image_mean(
        result, channel_integrals([=](double nm) { return emissivity * planck_radiance(nm, 2000); }, result),
        0.005);
  }
}

/// Opaque and transparent parts, blends in blends, on two sides from behind, in a mask. Detectable bias: 1 %.
TEST(BlendFurnace, IsTheMeanOfItsParts) {
  const double two = (1 - kWeight) * pane_albedo(1.5, 60) + kWeight * 0.3;
  const std::string glassy = blend(kWeight, pane(1.5) + diffuse(0.3));
  const double grey = (1 - kWeight) * 0.2 + kWeight * 0.9;
  const std::string painted = blend(kWeight, diffuse(0.2) + diffuse(0.9));
  const struct {
    std::string name, material;
    double degrees, expected;
  } cases[] = {
      {"diffuse", painted, 60, grey},
      {"pane and diffuse", glassy, 60, two},
      {"from behind only the pane is there", glassy, 120, (1 - kWeight) * pane_albedo(1.5, 60)},
      {"in a blend", blend(0.6, diffuse(0.5) + glassy), 60, 0.4 * 0.5 + 0.6 * two},
      {"two sides", bsdf("twosided", painted), 120, grey},
      {"two sides, two blends", bsdf("twosided", painted + blend(0.5, diffuse(0.1) + diffuse(0.6))), 120,
       0.35},
      {"in a mask", bsdf("mask", real("opacity", 0.6) + painted), 60, 0.6 * grey + 0.4},
      {"on two sides in a mask", bsdf("mask", real("opacity", 0.6) + bsdf("twosided", painted)), 120,
       0.6 * grey + 0.4},
      {"of a mask", blend(0.5, diffuse(0.4) + bsdf("mask", real("opacity", 0.6) + diffuse(0.2))), 60,
       0.5 * 0.4 + 0.5 * (0.6 * 0.2 + 0.4)},
      {"mirror and diffuse", blend(0.5, bsdf("conductor", "") + diffuse(0.2)), 60, 0.6},
      {"weight 0", blend(0, diffuse(0.2) + diffuse(0.9)), 60, 0.2},
      {"weight 1", blend(1, diffuse(0.2) + diffuse(0.9)), 60, 0.9},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    const RenderResult result = render_valid(plane(c.material, c.degrees, sky(1)), kBands, {}, {32, 54});
    expect_image_mean(result, widths(result, c.expected), 0.01);
  }
}

/// A bitmap's weight at its place: the left half of the square is the first, the right half the second part.
TEST(BlendFurnace, TheWeightIsThatOfThePlace) {
  const TemporaryFolder folder;
  folder.write("weight.pfm", pfm_image(2, 1, 1, {0, 1}));
  const std::string weight =
      "<texture type=\"bitmap\" name=\"weight\"><string name=\"filename\" value=\"weight.pfm\"/><boolean name=\"raw\" "
      "value=\"true\"/><string name=\"filter_type\" value=\"nearest\"/></texture>";
  const std::string two = bsdf("blendbsdf", weight + diffuse(0.2) + diffuse(0.9));
  const std::string xml = scene(-1, plane_sensor(8) + shape("rectangle", two) + sky(1));
  const RenderResult result = render_valid(xml, kBands, {}, {16, 55}, folder.path());
  expect_pixel(result, 1, 4, widths(result, 0.2));
  expect_pixel(result, 6, 4, widths(result, 0.9));
}

/// The light of a small lamp, sampled and hit, and thermal emission, sampled as a light. Detectable bias: 1.5 %.
TEST(BlendLight, EmissionAndLightSamplesAreMeans) {
  const std::string lamp =
      emitter("point", number("point", "position", "0, 0, 2") + spectrum("intensity", 8));
  const RenderResult lit =
      render_valid(plane(blend(kWeight, diffuse(0.2) + diffuse(0.9)), 45, lamp), kBands, {}, {128, 56});
  const double grey = (1 - kWeight) * 0.2 + kWeight * 0.9;
  expect_image_mean(lit, widths(lit, grey * 8 / 4 / std::numbers::pi), 0.015);

  const std::string hot = thermal(2000);
  const RenderResult glowing =
      render_valid(plane(blend(kWeight, diffuse(0.2) + diffuse(0.9)) + hot, 45, ""), kBands, {}, {128, 57});
  expect_image_mean(
      glowing, channel_integrals([=](double nm) { return (1 - grey) * planck_radiance(nm, 2000); }, glowing),
      0.015);
}

}  // namespace
}  // namespace kiloband::test::blend_test
