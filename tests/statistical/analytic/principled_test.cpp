// Principled materials against others that they come to, and numbers from images against numbers.
//
// A metal of base colour 1 is a perfect mirror of roughness alpha = roughness^2, since S + (1 - S) s = 1; with spec_trans 1 and base colour 1
// the material is rough glass of the same alpha. Both are sampled as those are, so that images agree but for rounding.
#include <cmath>
#include <numbers>

#include "tests/statistical/analytic/analytic_test.hpp"

namespace kiloband::test::principled_test {
namespace {

const char* const kBands = "400-420, 500-510, 690-700";

Text image(const Text& name, const Text& file, bool raw = true) {
  return "<texture name='" + name + "' type='bitmap'>" + text("filename", file) +
         text("filter_type", "nearest") + (raw ? yes("raw") : Text()) + "</texture>";
}

/// A square and a ball of the material under a sky and a lamp.
Text room(const Text& material, const Text& sensor) {
  const Text light = shape("disk", to_world(scale("1.5") + turn("y", "-120") + translate("3.2 0.5 2")) +
                                       bsdf("diffuse") + lamp("400:2, 700:3"));
  const Text ball = shape("sphere", to_world(scale("0.4") + translate("0 0 0.6")) + material);
  return scene(5, sensor + shape("rectangle", material) + ball + light + sky(0.3));
}

RenderResult render_room(const Text& material, const Mode& mode, const TemporaryFolder& folder) {
  return render_valid(room(material, plane_sensor(16)), kBands, mode, {4, 61}, folder.path());
}

class PrincipledTest : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Backends, PrincipledTest, ::testing::ValuesIn(all_modes()), mode_name);

/// Pixels whose paths part by rounding are few.
void expect_same_images(const RenderResult& a, const RenderResult& b) {
  ASSERT_EQ(a.mean.size(), b.mean.size());
  std::size_t apart = 0;
  for (std::size_t i = 0; i < a.mean.size(); ++i)
    apart += std::abs(a.mean[i] - b.mean[i]) > 1e-4 * std::abs(a.mean[i]) + 1e-7;
  EXPECT_LE(apart, a.mean.size() / 50);
  for (std::size_t k = 0; k < a.image_mean.size(); ++k)
    EXPECT_NEAR(a.image_mean[k] / b.image_mean[k], 1, 1e-3) << k;
}

TEST_P(PrincipledTest, AWhiteMetalIsAMirror) {
  const TemporaryFolder folder;
  const Text white = real("base_color", 1) + real("metallic", 1) + real("roughness", 0.5);
  const Text mirror = bsdf("roughconductor", text("distribution", "ggx") + real("alpha", 0.25));
  expect_same_images(render_room(bsdf("principled", white), GetParam(), folder),
                     render_room(mirror, GetParam(), folder));
}

TEST_P(PrincipledTest, AWhiteTransmitterIsGlass) {
  const TemporaryFolder folder;
  const Text white =
      real("base_color", 1) + real("spec_trans", 1) + real("roughness", 0.5) + real("eta", 1.5);
  const Text glass = bsdf("roughdielectric", text("distribution", "ggx") + real("alpha", 0.25) +
                                                 real("int_ior", 1.5) + real("ext_ior", 1));
  expect_same_images(render_room(bsdf("principled", white), GetParam(), folder),
                     render_room(glass, GetParam(), folder));
}

struct Number {
  const char* name;
  bool thin;
  float low, high;
};

std::ostream& operator<<(std::ostream& out, const Number& number) {
  return out << (number.thin ? "thin " : "") << number.name;
}

class PrincipledMapTest : public ::testing::TestWithParam<Number> {};
INSTANTIATE_TEST_SUITE_P(
    Numbers, PrincipledMapTest,
    ::testing::Values(Number{"roughness", false, 0.3f, 0.8f}, Number{"anisotropic", false, 0.1f, 0.8f},
                      Number{"metallic", false, 0.2f, 0.9f}, Number{"spec_trans", false, 0.2f, 0.7f},
                      Number{"spec_tint", false, 0.1f, 1.0f}, Number{"sheen", false, 0.2f, 1.0f},
                      Number{"sheen_tint", false, 0.2f, 1.0f}, Number{"flatness", false, 0.2f, 1.0f},
                      Number{"clearcoat", false, 0.2f, 1.0f}, Number{"clearcoat_gloss", false, 0.1f, 0.9f},
                      Number{"eta", true, 1.2f, 2.0f}, Number{"diff_trans", true, 0.4f, 1.8f},
                      Number{"spec_trans", true, 0.2f, 0.7f}),
    [](const auto& number) { return Text(number.param.thin ? "thin_" : "") + number.param.name; });

/// Where a map has a number, paths are those of the number, bit by bit: the halves of a square.
TEST_P(PrincipledMapTest, HalvesAreThoseOfTheirNumbers) {
  const Number& tried = GetParam();
  const char* const name = tried.name;
  const bool thin = tried.thin;
  const TemporaryFolder folder;
  folder.write("halves.pfm", pfm_image(2, 1, 1, {tried.low, tried.high}));
  Text others;
  for (const char* other :
       {"roughness", "anisotropic", "spec_trans", "spec_tint", "sheen", "sheen_tint", "flatness"})
    if (other != Text(name)) others += real(other, 0.5);
  if (!thin)
    for (const char* other : {"metallic", "clearcoat", "clearcoat_gloss"})
      if (other != Text(name)) others += real(other, 0.3);
  others += "<spectrum name='base_color' value='400:0.2, 700:0.8'/>";
  const auto square = [&](const Text& number) {
    const Text light = shape("disk", to_world(scale("1.5") + turn("y", "-120") + translate("3.2 0.5 2")) +
                                         bsdf("diffuse") + lamp("400:2, 700:3"));
    const Text material = bsdf(thin ? "principledthin" : "principled", others + number);
    return render_valid(scene(2, plane_sensor(16) + shape("rectangle", material) + light + sky(0.3)), kBands,
                        {}, {4, 61}, folder.path());
  };
  const RenderResult varied = square(image(name, "halves.pfm"));
  const RenderResult low = square(real(name, double{tried.low})),
                     high = square(real(name, double{tried.high}));
  const std::size_t channels = varied.image_mean.size();
  std::size_t different = 0;
  for (std::size_t i = 0; i < varied.mean.size(); ++i) {
    const bool left = i / channels % 16 < 8;
    EXPECT_EQ(varied.mean[i], (left ? low : high).mean[i]) << i;
    different += low.mean[i] != high.mean[i];
  }
  EXPECT_GT(different, varied.mean.size() / 2);
}

/// A tint goes by the luminance: of a spectrum its integral under D65, of an image that of its colour there. 2 %: spectra stand for
/// colours that closely.
TEST_P(PrincipledTest, TintsOfImagesAreThoseOfColours) {
  const TemporaryFolder folder;
  folder.write("colour.pfm", pfm_image(1, 1, 3, {0.7f, 0.4f, 0.2f}));
  const Text tints = real("spec_tint", 1) + real("sheen", 1) + real("sheen_tint", 1) + real("roughness", 0.4);
  const RenderResult number = render_room(
      bsdf("principled", tints + "<rgb name='base_color' value='0.7, 0.4, 0.2'/>"), GetParam(), folder);
  const RenderResult picture =
      render_room(bsdf("principled", tints + image("base_color", "colour.pfm", false)), GetParam(), folder);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(picture.image_mean[k] / number.image_mean[k], 1, 0.02) << k;
}

/// Facets by which light passes a sheet are rougher than those that reflect, whose alphas are both the least here: the square's
/// tangent is asked for all the same. Light that comes from below, 0.03 off the axis, by its azimuth from the tangent; values of Mitsuba 3.9.1's eval().
TEST(Principled, LightThatPassesASheetGoesByItsTangent) {
  const Text material =
      bsdf("principledthin", real("base_color", 1) + real("roughness", 0.017) + real("anisotropic", 1) +
                                 real("spec_trans", 1) + real("eta", 8));
  const Text sensor =
      object("sensor", "radiancemeter",
             number("point", "origin", "0, 0, 3") + number("vector", "direction", "0, 0, -1") + film(1));
  const auto passed = [&](double turned, double azimuth) {
    const double phi = azimuth * std::numbers::pi / 180;
    const Text along = point(std::sin(0.03) * std::cos(phi), std::sin(0.03) * std::sin(phi), std::cos(0.03));
    const Text sun = emitter("directional", number("vector", "direction", along) + spectrum("irradiance", 1));
    const Text square = shape("rectangle", to_world(turn("z", turned)) + material);
    return render_valid(scene(2, sensor + square + sun), "549.5-550.5", {}, {4, 61}).image_mean[0];
  };
  for (const double turned : {0.0, 45.0, 90.0}) {
    EXPECT_NEAR(passed(turned, turned) / 307.8, 1, 1e-3) << turned;
    EXPECT_NEAR(passed(turned, turned + 45) / 1.039, 1, 1e-3) << turned;
    EXPECT_NEAR(passed(turned, turned + 90) / 0.2756, 1, 1e-3) << turned;
  }
}

TEST(Principled, WhatHasNoMeaningIsRefused) {
  const TemporaryFolder folder;
  const auto refusal = [&](const Text& contents) {
    try {
      render_valid(scene(2, plane_sensor(4) + shape("rectangle", contents) + sky(1)), kBands, {}, {},
                   folder.path());
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_NE(
      refusal(bsdf("principled", "") + thermal(300)).find("a principled material cannot emit thermally"),
      std::string::npos);
  const Text board = "<texture name='base_color' type='checkerboard'/>";
  EXPECT_NE(refusal(bsdf("principled", board + real("sheen", 1) + real("sheen_tint", 1)))
                .find("base_color: tints need a spectrum or a bitmap here"),
            std::string::npos);
  EXPECT_EQ(refusal(bsdf("principled", board + real("sheen", 1))), "none");
}

}  // namespace
}  // namespace kiloband::test::principled_test
