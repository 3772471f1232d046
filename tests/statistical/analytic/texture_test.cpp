// Textures and colours: mean reflectances and the colours that they give back.
//
// A square [-1, 1]^2 is seen from above, filling the film, under a directional light of irradiance pi along
// its normal: every point shows rho L0 exactly, so the image mean is the mean of the texture over the square,
// which for bilinear and nearest lookups is the mean of the texels (each texel's tent integrates to 1;
// mirrored and clamped borders add to the border texels what their own tents lose).
//
// Colours: under D65 the reflectance of a linear sRGB colour must give back the colour. The responses are
// r(lambda) = sum_i M_ij (x, y, z)_i / 106.75 with M the matrix from XYZ to linear sRGB; they are accumulated
// with the render over 360-830 nm. The solver's own residual is below 1e-4 per component, of textures 1e-3.
//
// Error rate: 1e-4 for the whole program. Detectable bias: 0.5 %.
#include <array>
#include <cmath>
#include <numbers>

#include "spectral/colour/colour.hpp"
#include "tests/statistical/analytic/analytic_test.hpp"

namespace kiloband::test::texture_test {
namespace {

constexpr double kPi = std::numbers::pi;
const char* const kBands = "400-420, 500-510, 690-700";

std::string sun(const std::string& spectrum) {
  return emitter("directional", number("vector", "direction", "0, 0, -1") + spectrum);
}

std::string square_scene(const std::string& reflectance, const std::string& light) {
  return scene(2, plane_sensor(32) + shape("rectangle", bsdf("diffuse", reflectance)) + light);
}

std::string bitmap(const std::string& options) {
  return "<texture name=\"reflectance\" type=\"bitmap\"><string name=\"filename\" value=\"image.pfm\"/>" +
         options + "</texture>";
}

class BitmapTest : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, BitmapTest, ::testing::ValuesIn(all_modes()), mode_name);

TEST_P(BitmapTest, MeanOfAGreyImageIsTheMeanOfItsTexels) {
  const TemporaryFolder folder;
  std::vector<float> texels;
  double mean = 0;
  for (uint32_t i = 0; i < 5 * 3; ++i) {
    texels.push_back(0.05f + 0.9f * static_cast<float>((i * 7) % 15) / 14);
    mean += texels.back() / 15.0;
  }
  folder.write("image.pfm", pfm_image(5, 3, 1, texels));
  for (const char* filter : {"bilinear", "nearest"}) {
    for (const char* wrap : {"repeat", "mirror", "clamp"}) {
      SCOPED_TRACE(filter + std::string(" ") + wrap);
      const std::string options = std::string("<string name=\"filter_type\" value=\"") + filter +
                                  "\"/><string name=\"wrap_mode\" value=\"" + wrap + "\"/>";
      const RenderResult result =
          render_valid(square_scene(bitmap(options), sun(spectrum("irradiance", kPi))), kBands, GetParam(),
                       {4, 81}, folder.path());
      expect_image_mean(result, channel_integrals([=](double) { return mean; }, result), 0.005);
    }
  }
}

/// Two texels, the upper one bright: v = 0 is the top row, at +y of the rectangle's uv...
/// seen as rows of the image.
TEST(Textures, RowsOfABitmapLieAlongV) {
  const TemporaryFolder folder;
  folder.write("image.pfm", pfm_image(2, 2, 1, {0.9f, 0.7f, 0.3f, 0.1f}));
  const RenderResult result =
      render_valid(square_scene(bitmap(text("filter_type", "nearest")), sun(spectrum("irradiance", kPi))),
                   kBands, {}, {4, 82}, folder.path());
  // The camera looks down with +y up and +x to the right. The rectangle has v = (y + 1) / 2, so the film's
  // top row, y = +1, shows the image's bottom row.
  const auto expect_at = [&](uint32_t x, uint32_t y, double value) {
    EXPECT_NEAR(result.at(x, y, 0), 20 * value, 1e-3);
  };
  expect_at(2, 29, 0.9);
  expect_at(29, 29, 0.7);
  expect_at(2, 2, 0.3);
  expect_at(29, 2, 0.1);
}

/// Half of the fields each, for any whole number of repetitions; fields differ in each channel.
TEST(Textures, CheckerboardMean) {
  const Knots first{{{400, 0.1}, {700, 0.9}}}, second{{{400, 0.8}, {700, 0.3}}};
  for (const int repeat : {1, 3}) {
    SCOPED_TRACE(repeat);
    const std::string board = "<texture name=\"reflectance\" type=\"checkerboard\">" + first.text("color0") +
                              second.text("color1") + "<transform name=\"to_uv\"><scale x=\"" +
                              std::to_string(repeat) + "\" y=\"" + std::to_string(repeat) +
                              "\"/></transform></texture>";
    const RenderResult result =
        render_valid(square_scene(board, sun(spectrum("irradiance", kPi))), kBands, {}, {16, 83});
    const auto expected = channel_integrals([&](double nm) { return (first(nm) + second(nm)) / 2; }, result);
    expect_image_mean(result, expected, 0.005);
  }
}

// ---- colours ----

using Rgb = std::array<double, 3>;

/// Linear sRGB under D65, as three responses.
std::vector<std::pair<std::string, Spectrum>> colour_responses() {
  std::vector<double> nm;
  std::array<std::vector<double>, 3> rgb;
  for (double lambda = kCieMinNm; lambda <= kCieMaxNm; lambda += 1) {
    nm.push_back(lambda);
    const auto colour = xyz_to_linear_srgb({cie_x()(lambda), cie_y()(lambda), cie_z()(lambda)});
    for (int i = 0; i < 3; ++i) rgb[i].push_back(colour[i] / kCieYIntegral);
  }
  return {{"R", Spectrum::tabulated(nm, rgb[0])},
          {"G", Spectrum::tabulated(nm, rgb[1])},
          {"B", Spectrum::tabulated(nm, rgb[2])}};
}

/// Image means of the responses against a colour; `residual`: what the upsampling may miss, per component.
void expect_colour(const std::string& reflectance, const Rgb& colour, double residual,
                   const std::filesystem::path& folder = ".") {
  RenderSpec spec;
  spec.xml = square_scene(
      reflectance, sun("<spectrum name=\"irradiance\" type=\"d65\">" + real("scale", kPi) + "</spectrum>"));
  spec.bands = "360:830:94";
  spec.directory = folder;
  spec.threads = 1;
  spec.sampling = {WavelengthMode::kShared, SamplerType::kSobol, 84, kReplicates};
  spec.spp = 4 * kReplicates;
  spec.responses = colour_responses();
  const RenderResult result = render(spec);
  EXPECT_EQ(result.invalid_samples, 0u);
  const double t = critical_t(kFamilyErrorRate, kComparisons, result.replicates);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t channel = result.channels - 3 + i;
    const double error = std::sqrt(result.image_variance[channel]);
    EXPECT_NEAR(result.image_mean[channel], colour[i], t * error + residual)
        << "component " << i << ", standard error " << error;
    EXPECT_LE((t + 1.3) * error, 0.005) << "component " << i;
  }
}

TEST(Colours, RgbReflectanceUnderD65GivesBackTheColour) {
  for (const Rgb& colour : {Rgb{0.8, 0.2, 0.1},
                            {0.1, 0.5, 0.15},
                            {0.05, 0.1, 0.6},
                            {0.9, 0.85, 0.2},
                            {0.5, 0.5, 0.5},
                            {1, 1, 1},
                            {0.3, 0.7, 0.9}}) {
    SCOPED_TRACE(point(colour[0], colour[1], colour[2]));
    expect_colour("<rgb name=\"reflectance\" value=\"" + point(colour[0], colour[1], colour[2]) + "\"/>",
                  colour, 3e-4);
  }
}

/// A linear RGB image: the mean colour is the mean of the texels.
TEST(Colours, BitmapUnderD65GivesBackItsMeanColour) {
  const TemporaryFolder folder;
  const std::vector<float> texels = {0.8f,  0.2f, 0.1f, 0.1f, 0.5f,  0.15f,
                                     0.05f, 0.1f, 0.6f, 0.9f, 0.85f, 0.2f};
  Rgb mean{};
  for (std::size_t i = 0; i < texels.size(); ++i) mean[i % 3] += texels[i] / 4.0;
  folder.write("image.pfm", pfm_image(2, 2, 3, texels));
  expect_colour(bitmap(""), mean, 1.2e-3, folder.path());
}

}  // namespace
}  // namespace kiloband::test::texture_test
