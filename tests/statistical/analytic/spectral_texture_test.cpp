// Spectral textures and environments: images of bands and mixtures of spectra against closed forms.
//
// A square [-1, 1]^2 fills the film, seen from above. Under a directional light of irradiance pi along its
// normal every point shows its reflectance, and the image mean is the mean of the texels' spectra
// (texture_test.cpp). Under an environment of constant radiance L it shows rho L. Under a map of W x H texels
// that is black but for texel (x, y), a radiance L there is a tent L (1 - |a|)(1 - |b|), a in columns, b in
// rows; with the pole over the square and H = 5,
// y = 1 (theta = pi / 4, reaching from 0 to pi / 2) the irradiance is
//   E = L (2 pi / W) int_0^{pi/2} (1 - |theta - pi/4| / (pi/4)) cos theta sin theta dtheta
//     = L (2 pi / W) / pi.
// Between band centres spectra are linear, so channels that lie between two centres have
// the integrals of the knots.
//
// Error rate: 1e-4 for the whole program. Detectable bias: 0.5 %, of the single texel 1 %.
#include <cmath>
#include <numbers>

#include "tests/statistical/analytic/analytic_test.hpp"
#include "tests/support/cube_files.hpp"

namespace kiloband::test::spectral_texture_test {
namespace {

constexpr double kPi = std::numbers::pi;
const char* const kBands = "405-415, 500-510, 630-640";
/// Bands with these centres, unequal and with gaps.
const ChannelList kImageBands{{395, 405, ""}, {410, 490, ""}, {500, 600, ""}, {620, 720, ""}};

/// The spectrum of values at the bands' centres, as a closed form.
Knots knots(const std::vector<double>& values) {
  Knots k;
  for (std::size_t i = 0; i < values.size(); ++i)
    k.points.emplace_back(kImageBands[i].centre_nm(), values[i]);
  return k;
}

const std::vector<double> kFirst{0.1, 0.9, 0.3, 0.7};
const std::vector<double> kSecond{0.8, 0.2, 0.6, 0.1};

std::string spectral(const std::string& name, const std::string& content) {
  return "<texture name=\"" + name + "\" type=\"spectral_bitmap\">" + content + "</texture>";
}

std::string spectral_sky(const std::string& file, const std::string& more = "") {
  return emitter("spectral_envmap", text("filename", file) + more + to_world(turn("x", "90")));
}

std::string sun() {
  return emitter("directional", number("vector", "direction", "0, 0, -1") + spectrum("irradiance", kPi));
}

std::string square(const std::string& reflectance, const std::string& light, int depth = 2) {
  return scene(depth, plane_sensor(32) + shape("rectangle", bsdf("diffuse", reflectance)) + light);
}

class SpectralTextureTest : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, SpectralTextureTest, ::testing::ValuesIn(all_modes()), mode_name);

TEST_P(SpectralTextureTest, ConstantEnvironmentEqualsTheConstantEmitter) {
  const TemporaryFolder folder;
  const Knots radiance = knots({2, 5, 1, 3}), reflectance{{{400, 0.2}, {700, 0.9}}};
  write_cube(folder.path() / "sky.exr", 6, 5, kImageBands, [](uint32_t, uint32_t, std::size_t b) {
    return std::vector<double>{2, 5, 1, 3}[b];
  });
  const Effort effort{16, 91};
  const std::string light = emitter("constant", radiance.text("radiance"));
  const RenderResult map = render_valid(square(reflectance.text("reflectance"), spectral_sky("sky.exr")),
                                        kBands, GetParam(), effort, folder.path());
  const RenderResult constant =
      render_valid(square(reflectance.text("reflectance"), light), kBands, GetParam(), effort);
  const auto expected = channel_integrals([&](double nm) { return reflectance(nm) * radiance(nm); }, map);
  expect_image_mean(map, expected, 0.005);
  expect_image_mean(constant, expected, 0.005);
}

TEST_P(SpectralTextureTest, OneBrightTexelOfAnEnvironment) {
  const TemporaryFolder folder;
  const Knots radiance = knots(kFirst);
  for (const char* file : {"sky.exr", "sky.hdr"}) {
    SCOPED_TRACE(file);
    write_cube(
        folder.path() / file, 8, 5, kImageBands,
        [](uint32_t x, uint32_t y, std::size_t b) { return x == 2 && y == 1 ? 10 * kFirst[b] : 0; },
        Quantity::kIntegral);
    const RenderResult result =
        render_valid(square(spectrum("reflectance", 0.6), spectral_sky(file, real("scale", 3))), kBands,
                     GetParam(), {16, 92}, folder.path());
    expect_image_mean(
        result, channel_integrals([&](double nm) { return 0.6 / kPi * 30 * radiance(nm) * 2 / 8; }, result),
        0.01);
  }
}

TEST_P(SpectralTextureTest, MeanOfAnImageIsTheMeanOfItsSpectra) {
  const TemporaryFolder folder;
  write_cube(folder.path() / "image.exr", 2, 3, kImageBands,
             [](uint32_t x, uint32_t y, std::size_t b) { return (x + y) % 2 ? kFirst[b] : kSecond[b]; });
  const Knots first = knots(kFirst), second = knots(kSecond);
  for (const char* filter : {"bilinear", "nearest"}) {
    SCOPED_TRACE(filter);
    const std::string texture =
        spectral("reflectance",
                 text("filename", "image.exr") + text("filter_type", filter) + text("wrap_mode", "mirror"));
    const RenderResult result =
        render_valid(square(texture, sun()), kBands, GetParam(), {4, 93}, folder.path());
    expect_image_mean(
        result, channel_integrals([&](double nm) { return (first(nm) + second(nm)) / 2; }, result), 0.005);
  }
}

/// One texel is one spectrum: the same vertices, the same numbers.
TEST_P(SpectralTextureTest, OneTexelEqualsTheSameReflectanceInline) {
  const TemporaryFolder folder;
  write_cube(folder.path() / "one.exr", 1, 1, kImageBands,
             [](uint32_t, uint32_t, std::size_t b) { return kFirst[b]; });
  const auto room = [&](const std::string& reflectance) {
    return square(reflectance,
                  sky(2) + shape("sphere", to_world(scale("0.4") + step("translate", "z='0.5'")) +
                                               bsdf("diffuse", reflectance)),
                  6);
  };
  const Effort effort{2, 94, 8};
  const RenderResult texture = render_valid(room(spectral("reflectance", text("filename", "one.exr"))),
                                            "400:660:26", GetParam(), effort, folder.path());
  const RenderResult inline_spectrum =
      render_valid(room(knots(kFirst).text("reflectance")), "400:660:26", GetParam(), effort);
  ASSERT_EQ(texture.mean.size(), inline_spectrum.mean.size());
  for (std::size_t i = 0; i < texture.mean.size(); ++i)
    ASSERT_NEAR(texture.mean[i], inline_spectrum.mean[i], kRounding * inline_spectrum.mean[i]) << i;
}

TEST_P(SpectralTextureTest, EndmembersMixByTheirWeights) {
  const TemporaryFolder folder;
  const std::vector<float> weights{0.2f, 0.3f, 0.4f, 0.5f, 0.1f, 0.0f};
  folder.write("weights.pfm", pfm_image(2, 1, 3, weights));
  write_cube(folder.path() / "weights.hdr", 2, 1, {{1, 2, ""}, {3, 4, ""}, {5, 6, ""}},
             [&](uint32_t x, uint32_t, std::size_t b) { return weights[3 * x + b]; });
  const Knots first = knots(kFirst), second = knots(kSecond);
  for (const char* file : {"weights.pfm", "weights.hdr"}) {
    SCOPED_TRACE(file);
    const std::string texture =
        spectral("reflectance", text("weights", file) + first.text("endmember_0") +
                                    second.text("endmember_1") + spectrum("endmember_2", 0.5));
    const RenderResult result =
        render_valid(square(texture, sun()), kBands, GetParam(), {4, 95}, folder.path());
    expect_image_mean(
        result,
        channel_integrals([&](double nm) { return 0.35 * first(nm) + 0.2 * second(nm) + 0.2 * 0.5; }, result),
        0.005);
  }
}

/// Emission as it stands in the file, on both kinds of texels, looked at directly.
TEST_P(SpectralTextureTest, EmissionOfAnAreaLight) {
  const TemporaryFolder folder;
  const std::vector<double> glow{20, 0.5, 7, 3};
  write_cube(folder.path() / "one.exr", 1, 1, kImageBands,
             [&](uint32_t, uint32_t, std::size_t b) { return glow[b]; });
  folder.write("two.pfm", pfm_image(1, 1, 1, {2.0f}));
  const std::string textures[] = {
      spectral("radiance", text("filename", "one.exr")),
      spectral("radiance", text("weights", "two.pfm") + knots({10, 0.25, 3.5, 1.5}).text("endmember_0"))};
  for (const std::string& texture : textures) {
    const RenderResult result =
        render_valid(scene(1, plane_sensor(8) + shape("rectangle", emitter("area", texture))), kBands,
                     GetParam(), {4, 96}, folder.path());
    const Knots radiance = knots(glow);
    expect_image_mean(result, channel_integrals([&](double nm) { return radiance(nm); }, result), 0.01);
  }
}

/// Beyond the outermost edges: 0; `extrapolate` continues the end values of reflectances.
TEST(SpectralTextures, BeyondTheBands) {
  const TemporaryFolder folder;
  write_cube(folder.path() / "one.exr", 1, 1, kImageBands,
             [](uint32_t, uint32_t, std::size_t b) { return kFirst[b]; });
  const auto value = [&](const std::string& more) {
    const RenderResult result =
        render_valid(square(spectral("reflectance", text("filename", "one.exr") + more), sun()),
                     "380-390, 396-400, 700-715, 730-740", {}, {2, 97, 2}, folder.path());
    return result.image_mean;
  };
  const auto zero = value(""), continued = value(yes("extrapolate"));
  const double expected[] = {0, 4 * 0.1, 15 * 0.7, 0}, more[] = {10 * 0.1, 4 * 0.1, 15 * 0.7, 10 * 0.7};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(zero[k], expected[k], kRounding * expected[k]) << k;
    EXPECT_NEAR(continued[k], more[k], kRounding * more[k]) << k;
  }
}

}  // namespace
}  // namespace kiloband::test::spectral_texture_test
