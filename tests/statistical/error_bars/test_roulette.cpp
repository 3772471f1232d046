// Russian roulette where one narrow channel is bright and all others are dark.
//
// A closed box whose walls all emit Le and reflect diffusely with albedo rho contains the radiance
// L = Le + rho L, so L = Le / (1 - rho) in every direction: 50 Le at rho = 0.98 (550-551 nm), 1.11 Le at 0.1
// (elsewhere). A survival probability from the mean albedo (0.39 here) would be below rho^2 = 0.96 and make
// the variance at 550 nm infinite; a cap below 1 would read low. Depth is unlimited;
// the guide bands are the channels.
//
// Means: over kSeeds seeds x 8 pixels x 32 samples the bright channel's relative standard error is 0.2 %;
// three channels are tested at a family-wise error rate of 1e-4 (|t| < 4.2): a bias of 1.2 % is detected with
// probability 0.95.
// Error bars: as in test_replicate_errors.cpp. Standard errors of the ratio are 2.4 % for the image's mean
// and 0.9 % for pixels: a ratio of exactly 1 is refused with probability 3e-5 per image statistic (two are
// independent); 0.86 or 1.14 is detected with probability 0.95 there, 0.89 or 1.12 at the pixels.
// (3000 other seeds gave 1.007 +- 0.011 for the image.)
#include <gtest/gtest.h>

#include <cmath>

#include "box_scene.hpp"
#include "error_bar_study.hpp"
#include "tests/support/render_harness.hpp"

namespace kiloband::test::test_roulette {
namespace {

constexpr uint64_t kSeeds = 1000;
constexpr std::size_t kChannels = 3;
constexpr double kRadiance = 0.5;  // W m^-2 sr^-1 nm^-1

RenderSpec closed_box() {
  RenderSpec spec;
  spec.xml = scene(
      -1, object("sensor", "perspective",
                 real("fov", 60) + to_world(lookat("0.1, 0.2, 0.3", "1, 0.3, 0.4")) + film(size(4, 2))) +
              shape("cube", kInwards + diffuse("500:0.1, 549:0.1, 549.5:0.98, 551.5:0.98, 552:0.1, 600:0.1") +
                                lamp(kRadiance)));
  spec.bands = "510-540, 550-551, 560-565";
  spec.spp = 32;
  spec.threads = 1;
  return spec;
}

std::vector<double> every(const std::vector<double>& values, std::size_t channel) {
  std::vector<double> picked;
  for (std::size_t i = channel; i < values.size(); i += kChannels) picked.push_back(values[i]);
  return picked;
}

TEST(Roulette, BrightNarrowChannelIsUnbiasedAndItsErrorHonest) {
  const PreparedRender prepared(closed_box());
  SamplingSettings sampling;
  ErrorBarStudy pixels[kChannels], image[kChannels];
  for (sampling.seed = 1; sampling.seed <= kSeeds; ++sampling.seed) {
    const RenderResult result = prepared.render(sampling);
    ASSERT_EQ(result.invalid_samples, 0u);
    for (std::size_t c = 0; c < kChannels; ++c) {
      pixels[c].add(every(result.mean, c), every(result.variance, c));
      image[c].add(every(result.image_mean, c), every(result.image_variance, c));
    }
  }
  const double albedo[kChannels] = {0.1, 0.98, 0.1}, width_nm[kChannels] = {30, 1, 5};
  for (std::size_t c = 0; c < kChannels; ++c) {
    SCOPED_TRACE(c);
    const double expected = kRadiance * width_nm[c] / (1 - albedo[c]);
    const double error = image[c].grand_standard_error(0);
    EXPECT_LT(error, 0.004 * expected);
    EXPECT_LT(z_score(image[c].grand_mean(0), expected, error * error), critical_t(1e-4, kChannels, kSeeds));
    expect_honest("pixels_" + std::to_string(c), pixels[c], 0.012);
    expect_honest("image_" + std::to_string(c), image[c], 0.03);
  }
}

}  // namespace
}  // namespace kiloband::test::test_roulette
