// A channel does not depend on the channels that are rendered with it.
//
// With fixed guide bands and without dispersion the paths, and a channel's arithmetic, are the same whatever
// else is rendered: values must be the same bits on one instruction set. Otherwise (decisions follow the
// channels, or a dispersive surface leaves one of K channels) only the expectation is the same: tested with
// other seeds for both renders, by the difference over its standard error.
//
// The statistical tests make kComparisons comparisons each of image means of 16 replicates; the two-sided
// critical value is t's at a family-wise error rate of 1e-4 with 15 degrees of freedom, conservative for a
// difference (15 to 30). A difference of 9 standard errors is then detected with probability 0.99; each test
// states what that is.
#include <gtest/gtest.h>

#include <cmath>

#include "box_scene.hpp"
#include "tests/support/render_harness.hpp"
#include "tests/support/temporary_folder.hpp"

namespace kiloband::test::test_channels {
namespace {

constexpr const char* kSpikes = "400:1, 450:4, 470:0.5, 552:3, 560:8, 568:3, 640:1, 700:5";

/// Spectra of every kind, coupled with direction (conductor) or not, and lights of two colours.
std::string spectral_parts() {
  const std::string ball =
      shape("sphere",
            number("point", "center", "0.45, -0.6, 0.2") + real("radius", "0.38") +
                bsdf("roughconductor", real("alpha", "0.2") + spectrum("eta", "400:1.5, 500:0.9, 700:0.15") +
                                           spectrum("k", "400:1.9, 500:2.1, 700:3.8")));
  const std::string glass = shape(
      "sphere", number("point", "center", "-0.45, 0.35, 0.1") + real("radius", "0.3") + bsdf("dielectric"));
  const std::string coat =
      rectangle(scale("0.4") + step("translate", "x='0.3' y='0.3' z='-0.98'"),
                bsdf("plastic", number("rgb", "diffuse_reflectance", "0.7, 0.2, 0.1") + yes("nonlinear")));
  const std::string light = emitter("point", number("point", "position", "0, 0.2, 0.9") +
                                                 "<spectrum type='blackbody' name='intensity'>" +
                                                 real("temperature", 3200) + "</spectrum>");
  return box_walls() + box_block() + box_light(kSpikes) + ball + glass + coat + light;
}

/// Squares in colours of pictures, which narrow channels interpolate: of four texels, which are spectra, and of 3072, which are not.
std::string painted(const TemporaryFolder& folder) {
  const std::string colours[] = {"220 40 30 ", "30 160 60 ", "40 60 200 ", "200 190 120 "};
  std::string squares;
  for (const int width : {2, 64}) {
    const int height = width == 2 ? 2 : 48;
    const std::filesystem::path file = folder.path() / ("colours" + std::to_string(width) + ".ppm");
    std::ofstream picture(file);
    picture << "P3 " << width << ' ' << height << " 255\n";
    for (int i = 0; i < width * height; ++i) picture << colours[i % 7 % 4];
    squares += rectangle(scale("0.2") + step("translate", width == 2 ? "x='0.05' y='0.05' z='0.1'"
                                                                     : "x='-0.1' y='-0.4' z='0.3'"),
                         bsdf("diffuse",
                              "<texture type='bitmap' name='reflectance'>"
                              "<string name='filename' value='" +
                                  file.string() + "'/></texture>"));
  }
  return squares;
}

RenderSpec base_spec(const std::string& parts, const std::string& bands) {
  RenderSpec spec;
  spec.xml = scene(5, box_sensor(size(64, 64) + crop(20, 20, 24, 24)) + parts);
  spec.bands = bands;
  spec.spp = 8;
  spec.sampling.replicates = 4;
  spec.sampling.seed = 11;
  spec.threads = 1;
  return spec;
}

/// The channel as a list of one, every digit kept.
std::string alone(const Channel& channel) {
  char text[80];
  std::snprintf(text, sizeof text, "%.17g-%.17g", channel.min_nm, channel.max_nm);
  return text;
}

struct ChannelCase {
  const char* bands;
  std::vector<std::size_t> compared;
};

const ChannelCase kCases[] = {
    {"400:700:1", {0}},
    {"400:700:7", {0, 1, 2, 3, 4, 5, 6}},
    {"400:700:100", {0, 1, 15, 50, 63, 64, 99}},
    {"400:700:1000", {0, 1, 63, 64, 531, 998, 999}},
    {"400-500, 450-550, 480-520, 450-550, 400-700", {0, 1, 2, 3, 4}},  // overlaps, one twice
    {"405-410, 500-520, 690-700", {0, 1, 2}},                          // gaps
    {"555:565:100", {0, 49, 50, 99}}};                                 // 0.1 nm

class ChannelsWithGuide : public ::testing::TestWithParam<WavelengthMode> {};

TEST_P(ChannelsWithGuide, EqualTheSameChannelAlone) {
  const TemporaryFolder folder;
  for (const ChannelCase& test : kCases) {
    SCOPED_TRACE(test.bands);
    RenderSpec spec = base_spec(spectral_parts() + painted(folder), test.bands);
    spec.guide = "400:700:30";
    spec.sampling.wavelengths = GetParam();
    const RenderResult together = render(spec);
    ASSERT_GT(together.image_mean[0], 0);
    const ChannelList channels = together.scene.channels;
    for (const std::size_t c : test.compared) {
      spec.bands = alone(channels[c]);
      const RenderResult single = render(spec);
      ASSERT_EQ(single.channels, 1u);
      std::size_t different = 0, different_errors = 0;
      for (std::size_t p = 0; p < single.mean.size(); ++p) {
        different += single.mean[p] != together.mean[p * together.channels + c];
        different_errors += single.variance[p] != together.variance[p * together.channels + c];
      }
      EXPECT_EQ(different, 0u) << "channel " << c;
      EXPECT_EQ(different_errors, 0u) << "channel " << c;
      EXPECT_EQ(single.image_mean[0], together.image_mean[c]);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Modes, ChannelsWithGuide,
                         ::testing::Values(WavelengthMode::kShared, WavelengthMode::kPerPath));

/// Image means of channels rendered together and alone (other seeds), by t-tests; `detectable` bounds 9
/// standard errors of each difference, relative to the mean.
void expect_same_means(RenderSpec spec, const std::vector<ChannelCase>& cases, double detectable) {
  std::size_t comparisons = 0;
  for (const ChannelCase& test : cases) comparisons += test.compared.size();
  const double critical = critical_t(1e-4, comparisons, 16);
  uint64_t seed = 100;
  double worst = 0;
  for (const ChannelCase& test : cases) {
    SCOPED_TRACE(test.bands);
    spec.bands = test.bands;
    spec.sampling.seed = ++seed;
    const RenderResult together = render(spec);
    RenderSpec single_spec = spec;
    for (const std::size_t c : test.compared) {
      single_spec.bands = alone(together.scene.channels[c]);
      single_spec.sampling.seed = ++seed;
      const RenderResult single = render(single_spec);
      const double variance = single.image_variance[0] + together.image_variance[c];
      worst = std::max(worst, 9 * std::sqrt(variance) / single.image_mean[0]);
      EXPECT_LT(z_score(together.image_mean[c], single.image_mean[0], variance), critical) << "channel " << c;
    }
  }
  EXPECT_LT(worst, detectable);
}

TEST(ChannelsWithoutGuide, AgreeInTheMean) {
  // Detectable: a bias of 7 % of any channel's image mean.
  RenderSpec spec = base_spec(spectral_parts(), "");
  spec.spp = 128;
  spec.sampling.replicates = 16;
  expect_same_means(spec,
                    {{"400:700:7", {0, 3, 6}},
                     {"400:700:1000", {0, 531, 999}},
                     {"400-500, 450-550, 450-550, 400-700", {0, 2, 3}},
                     {"405-410, 690-700", {0, 1}},
                     {"555:565:100", {0, 50}}},
                    0.07);
}

class DispersiveChannels : public ::testing::Test {
 protected:
  DispersiveChannels() { folder_.write("flint.txt", "400 1.85\n500 1.80\n600 1.78\n700 1.77\n"); }

  RenderSpec spec(const std::string& type) const {
    const std::string ball =
        shape("sphere", number("point", "center", "0, -0.4, 0.3") + real("radius", 0.55) +
                            bsdf(type, text("int_material", "flint.txt")));
    RenderSpec spec = base_spec(box_walls() + box_light(kSpikes) + ball, "");
    spec.directory = folder_.path();
    spec.guide = "400:700:30";
    spec.spp = 256;
    spec.sampling.replicates = 16;
    return spec;
  }

  TemporaryFolder folder_;
};

TEST_F(DispersiveChannels, SmoothGlassAgreesInTheMean) {
  // One of K channels goes on behind the glass: noisier with every channel.
  // Detectable: 11 % of a channel's image mean.
  expect_same_means(spec("dielectric"), {{"400:700:7", {0, 3, 6}}, {"400-500, 450-550, 600-601", {0, 1, 2}}},
                    0.11);
}

TEST_F(DispersiveChannels, RoughGlassAgreesInTheMean) {
  expect_same_means(spec("roughdielectric"),
                    {{"400:700:7", {0, 3, 6}}, {"400-500, 450-550, 600-601", {0, 1, 2}}}, 0.11);
}

}  // namespace
}  // namespace kiloband::test::test_channels
