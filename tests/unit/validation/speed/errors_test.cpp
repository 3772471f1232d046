// Errors against a reference that has one itself: images of known noise.
#include "validation/speed/errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kiloband::speed {
namespace {

constexpr uint32_t kWidth = 24, kHeight = 20;
constexpr std::size_t kChannels = 3;
const double kLevel[kChannels] = {2, 50, 0};

/// Level of each channel times 1 + sigma x normal, and what all pixels share.
std::vector<float> noisy_image(std::mt19937_64& random, double sigma, double shared) {
  std::normal_distribution<double> normal;
  const double common = shared * normal(random);
  std::vector<float> image;
  for (std::size_t i = 0; i < kWidth * kHeight * kChannels; ++i)
    image.push_back(static_cast<float>(kLevel[i % kChannels] * (1 + sigma * normal(random) + common)));
  return image;
}

Reference noisy_reference(std::mt19937_64& random, double sigma) {
  Reference reference;
  reference.image = {kWidth, kHeight, kChannels, 16, {}, {}};
  for (int r = 0; r < 16; ++r) {
    const auto image = noisy_image(random, 4 * sigma, 0);  // the mean of 16 has sigma
    reference.image.means.insert(reference.image.means.end(), image.begin(), image.end());
  }
  reference.image.samples.assign(16 * kWidth * kHeight, 1);
  reference.centres_nm = {450, 550, 650};
  return reference;
}

Repetitions noisy_repetitions(std::mt19937_64& random, double sigma, double shared, int count) {
  Repetitions all{kWidth, kHeight, kChannels, {}, {}};
  for (int i = 0; i < count; ++i) {
    all.images.push_back(noisy_image(random, sigma, shared));
    all.seconds.push_back(1);
  }
  return all;
}

/// sigma 0.1 of independent pixels: 0.1 of a pixel; of tiles the mean over the 9 of 1/size (6 of 64 pixels, 3 of 32); 0.1 / sqrt(480)
/// of the image. The reference has half of that noise, which must not be seen. Limits: five standard errors as stated.
TEST(SpeedErrors, AtThreeScales) {
  std::mt19937_64 random(1);
  const Reference reference = noisy_reference(random, 0.05);
  const auto errors = errors_of(noisy_repetitions(random, 0.1, 0, 60), reference);
  ASSERT_EQ(errors.size(), 3u);
  const double expected[] = {0.01, 0.01 * (6.0 / 64 + 3.0 / 32) / 9, 0.01 / 480};
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(errors[i].square.value, expected[i], 5 * errors[i].square.error) << errors[i].scale;
    EXPECT_GT(errors[i].square.error, 0);
    EXPECT_LT(errors[i].square.error, 0.4 * expected[i]) << errors[i].scale;
    ASSERT_EQ(errors[i].channels.size(), kChannels);
    for (std::size_t c = 0; c < 2; ++c)
      EXPECT_NEAR(errors[i].channels[c].value, expected[i], 5 * errors[i].channels[c].error) << c;
    EXPECT_TRUE(std::isnan(errors[i].channels[2].value)) << "a dark channel has no relative error";
  }
}

/// An error that all pixels share stays whole at every scale.
TEST(SpeedErrors, SharedErrorsDoNotAverageOut) {
  std::mt19937_64 random(2);
  const Reference reference = noisy_reference(random, 0.001);
  for (const ScaleErrors& errors : errors_of(noisy_repetitions(random, 0, 0.1, 200), reference))
    EXPECT_NEAR(errors.square.value, 0.01, 5 * errors.square.error) << errors.scale;
}

TEST(SpeedErrors, MeansAreCompared) {
  std::mt19937_64 random(3);
  const Reference reference = noisy_reference(random, 0.01);
  Repetitions same = noisy_repetitions(random, 0.1, 0, 8);
  EXPECT_FALSE(compare_means(same, reference).differ);
  for (std::vector<float>& image : same.images)
    for (std::size_t i = 1; i < image.size(); i += kChannels) image[i] *= 1.05f;
  const MeanDifference difference = compare_means(same, reference);
  EXPECT_TRUE(difference.differ);
  EXPECT_NEAR(difference.relative, 0.025, 0.01) << "5 % of one of the two channels that have light";
}

TEST(SpeedErrors, ShapesMustAgree) {
  std::mt19937_64 random(4);
  Repetitions other = noisy_repetitions(random, 0.1, 0, 2);
  other.width = 12, other.height = 40;
  EXPECT_THROW(errors_of(other, noisy_reference(random, 0.1)), std::logic_error);
}

}  // namespace
}  // namespace kiloband::speed
