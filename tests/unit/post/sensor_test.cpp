// Responses applied to cubes after rendering, and pictures.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "cube/channel_cover.hpp"
#include "cube/cube_layout.hpp"
#include "post/effective_band.hpp"
#include "post/picture.hpp"
#include "post/sensor_cube.hpp"
#include "tests/unit/cube/cube_support.hpp"

namespace kiloband {
namespace {

using namespace test;

/// Three channels, the last two overlapping in 460-470 nm, and a band that the render has accumulated.
std::vector<Band> bands() {
  return {
      {{400, 440, ""}, false}, {{440, 470, ""}, false}, {{460, 500, ""}, false}, {{400, 500, "own"}, true}};
}

Cube cube_of(const std::vector<float>& pixel, Quantity quantity = Quantity::kIntegral) {
  Cube cube = make_cube(1, 1, bands(), true);
  cube.info.quantity = quantity;
  cube.mean = pixel;
  return cube;
}

class Sensor : public testing::Test {
 protected:
  std::unique_ptr<CubeReader> open(const Cube& cube, const char* name = "a.hdr") {
    write_cube_file(cube, folder / name, 1);
    return open_cube(folder / name);
  }
  std::vector<std::string> reports(const Cube& cube, const std::vector<NamedResponse>& responses) {
    Messages messages;
    report_responses(*open(cube), responses, messages.sink());
    return messages.texts;
  }
  TemporaryFolder folder;
};

const Spectrum kFlat = Spectrum::constant(2);
const Spectrum kRamp = Spectrum::tabulated({400, 500}, {0, 1});

SensorWeights weights_of(const Spectrum& response, const std::vector<Band>& of) {
  return sensor_weights(response, of, ChannelCover(channels_of(of)));
}

/// A radiance of 1 per nm makes the integrals 40, 30, 40; 10 nm are covered twice and count once.
TEST_F(Sensor, OverlappingChannelsCountOnce) {
  const Cube cube = cube_of({40, 30, 40, 7});
  auto sensor = apply_responses(open(cube), {{"flat", kFlat}, {"ramp", kRamp}});
  const Cube seen = read_cube(*sensor);
  ASSERT_EQ(seen.info.bands.size(), 2u);
  EXPECT_TRUE(seen.info.bands[0].derived);
  EXPECT_EQ(seen.info.bands[0].channel.min_nm, 400);
  EXPECT_NEAR(seen.info.bands[1].channel.centre_nm(), 400 + 200.0 / 3, 1e-6);
  EXPECT_FALSE(seen.info.variance);
  EXPECT_NEAR(seen.mean[0], 200, 1e-4);
  EXPECT_NEAR(seen.mean[1], 50, 1e-5);
  auto density =
      apply_responses(open(cube_of({40, 30, 40, 7}, Quantity::kDensity), "d.hdr"), {{"flat", kFlat}});
  EXPECT_NEAR(read_cube(*density).mean[0], 200, 1e-4);
}

/// A line that a narrow channel resolves, 2 over 1 nm on a ground of 1 per nm: its band is 3. Were the line's nanometre
/// shared equally with the wide channel, which spreads it over 300 nm, the band would be 2.
TEST_F(Sensor, NarrowChannelsHaveMoreOfWhatTheyResolve) {
  Cube cube = make_cube(1, 1, {{{400, 700, ""}, false}, {{470, 471, ""}, false}}, false);
  cube.mean = {302, 3};
  auto sensor =
      apply_responses(open(cube), {{"line", Spectrum::tabulated({470, 471}, {1, 1})}, {"flat", kFlat}});
  const Cube seen = read_cube(*sensor);
  EXPECT_NEAR(seen.mean[0], (302.0 / 300 + 300 * 3) / 301, 1e-5);
  EXPECT_NEAR(seen.mean[1], 2 * (302.0 / 300 * (299 + 1 / 301.0) + 3 * 300 / 301.0), 1e-3);
}

/// In any order, one in another, some that touch and one apart.
TEST(ChannelCover, CoveredIntervalsDoNotTouch) {
  using Intervals = std::vector<std::pair<double, double>>;
  const ChannelCover cover({{700, 701, ""}, {440, 470, ""}, {400, 440, ""}, {450, 455, ""}, {465, 500, ""}});
  EXPECT_EQ(cover.covered_nm(), (Intervals{{400, 500}, {700, 701}}));
  EXPECT_EQ(ChannelCover(ChannelList{}).covered_nm(), Intervals{});
}

void expect_band(const Spectrum& response, const ChannelList& channels, double min_nm, double max_nm) {
  const Channel band = effective_band(response, ChannelCover(channels));
  EXPECT_NEAR(band.min_nm, min_nm, 1e-6);
  EXPECT_NEAR(band.max_nm, max_nm, 1e-6);
}

/// What is negative counts as much as what is positive.
TEST(UncoveredPart, IsOfTheMagnitude) {
  const Spectrum response = Spectrum::tabulated({400, 500, 500.000001, 600}, {-1, -1, 2, 2});
  EXPECT_NEAR(uncovered_part(response, ChannelCover({{400, 500, ""}})), 2.0 / 3, 1e-6);
  EXPECT_NEAR(uncovered_part(response, ChannelCover({{500, 600, ""}})), 1.0 / 3, 1e-6);
  EXPECT_EQ(uncovered_part(response, ChannelCover({{300, 350, ""}})), 1);
  EXPECT_EQ(uncovered_part(Spectrum::tabulated({400, 500}, {-1, -1}), ChannelCover({{600, 700, ""}})), 1);
}

/// Centroid and equivalent width by hand.
TEST(EffectiveBand, IsCentroidAndEquivalentWidth) {
  const ChannelList all{{380, 2540, ""}};
  const Channel box = effective_band(Spectrum::tabulated({614, 682}, {0.3, 0.3}), ChannelCover(all));
  EXPECT_EQ(box.min_nm, 614) << "as it was given";
  EXPECT_EQ(box.max_nm, 682);
  expect_band(Spectrum::tabulated({500, 510, 530}, {0, 4, 0}), all, 540.0 / 3 + 1000.0 / 3 - 7.5,
              540.0 / 3 + 1000.0 / 3 + 7.5);
  expect_band(kRamp, all, 400 + 200.0 / 3 - 25, 400 + 200.0 / 3 + 25);
  // Two lobes; one of them negative; and only one where channels are.
  expect_band(Spectrum::tabulated({500, 510, 510.001, 589.999, 590, 600}, {1, 1, 0, 0, 1, 1}), all,
              550 - 10.0005, 550 + 10.0005);
  expect_band(Spectrum::tabulated({500, 510, 520, 530, 540}, {0, 1, 0, -1, 0}), all, 510, 530);
  expect_band(Spectrum::constant(2), {{500, 510, ""}, {505, 520, ""}, {700, 701, ""}}, 10900.5 / 21 - 10.5,
              10900.5 / 21 + 10.5);
  expect_band(Spectrum::constant(0), {{500, 510, ""}, {700, 701, ""}}, 500, 701);
}

TEST_F(Sensor, WeightsAndTheirDeviationByHand) {
  const SensorWeights ramp = weights_of(kRamp, bands());
  EXPECT_NEAR(ramp.weight[0], 0.2, 1e-12);  // 0 to 0.4
  EXPECT_NEAR(ramp.deviation[0], 0.2, 1e-12);
  EXPECT_NEAR(ramp.weight[1], (20 * 0.5 + 10 * 0.65 * 4 / 7) / 30, 1e-12);  // 0.4 to 0.6, 4/7 of 0.6 to 0.7
  EXPECT_NEAR(ramp.deviation[1], 0.6 - ramp.weight[1], 1e-12);
  EXPECT_EQ(ramp.weight[3], 0);
  const SensorWeights flat = weights_of(Spectrum::tabulated({400, 440}, {3, 3}), bands());
  EXPECT_NEAR(flat.weight[0], 3, 1e-12);
  EXPECT_NEAR(flat.deviation[0], 0, 1e-12);
  EXPECT_EQ(flat.weight[1], 0);
}

/// All light of the first channel at 440 nm: the ramp sees 40 * 0.4 and not 40 * 0.2. The bound is that.
TEST_F(Sensor, WarningsGiveTheLargestPossibleError) {
  const Cube cube = cube_of({40, 0, 0, 7});
  EXPECT_EQ(
      reports(cube, {{"ramp", kRamp}}),
      std::vector<std::string>{"response 'ramp': changes inside channels; the image's mean can be off by "
                               "100 % (give it before the render, or finer channels)"});
  EXPECT_EQ(reports(cube, {{"flat", Spectrum::tabulated({400, 440}, {2, 2})}}), std::vector<std::string>{});
  EXPECT_EQ(reports(cube, {{"wide", Spectrum::tabulated({400, 600}, {2, 2})}}).front(),
            "response 'wide': 50 % of its integral lies outside the channels");
  EXPECT_EQ(reports(cube, {{"own", kRamp}}),
            std::vector<std::string>{"response 'own': the band that the render accumulated is taken"});
}

/// A response that is constant inside every channel is exact, whatever it does at their edges.
TEST_F(Sensor, JumpsAtTheEdgesOfChannelsAreExact) {
  const Spectrum box = Spectrum::tabulated({440, 460}, {3, 3});
  const SensorWeights weights =
      weights_of(box, {{{400, 440, ""}, false}, {{440, 460, ""}, false}, {{460, 500, ""}, false}});
  EXPECT_EQ(weights.weight, (std::vector<double>{0, 3, 0}));
  EXPECT_EQ(weights.deviation, (std::vector<double>{0, 0, 0}));
  Cube cube = make_cube(1, 1, equal_bands(400, 700, 6));
  cube.mean = {50, 40, 30, 20, 10, 5};
  for (const auto& [from, to] : {std::pair{450.0, 550.0}, {450, 500}, {400, 450}, {650, 700}, {300, 450}})
    EXPECT_EQ(reports(cube, {{"box", Spectrum::tabulated({from, to}, {1, 1})}}).size(), from < 400 ? 1u : 0u);
}

TEST_F(Sensor, TheRendersOwnBandKeepsItsVariance) {
  Cube cube = cube_of({40, 30, 40, 7});
  cube.variance = {1, 1, 1, 0.25f};
  auto sensor = apply_responses(open(cube), {{"ramp", kRamp}, {"own", kFlat}});
  const Cube seen = read_cube(*sensor);
  EXPECT_EQ(seen.mean[1], 7);
  ASSERT_TRUE(seen.info.variance);
  EXPECT_TRUE(std::isnan(seen.variance[0]));
  EXPECT_EQ(seen.variance[1], 0.25f);
}

TEST_F(Sensor, WrongResponses) {
  const Cube cube = cube_of({40, 30, 40, 7});
  const auto error = [&](const std::vector<NamedResponse>& responses) {
    return error_of([&] { apply_responses(open(cube), responses); });
  };
  EXPECT_EQ(error({{"far", Spectrum::tabulated({800, 900}, {1, 1})}}),
            "response 'far': is 0 in all channels of the cube");
  EXPECT_EQ(error({{"a", kFlat}, {"a", kRamp}}), "response 'a' is given twice");
}

/// Equal energy of 1 W m^-2 sr^-1 nm^-1: Y = 683.002 * 106.857 cd/m^2, and X, Y, Z agree to 0.1 %.
TEST_F(Sensor, LuminanceOfEqualEnergy) {
  Cube cube = make_cube(1, 1, equal_bands(360, 830, 470));
  std::fill(cube.mean.begin(), cube.mean.end(), 1.0f);
  const Cube seen = read_cube(*apply_responses(open(cube), xyz_responses()));
  EXPECT_NEAR(seen.mean[1], 683.002 * 106.857, 2);
  EXPECT_NEAR(seen.mean[0] / seen.mean[1], 1, 1e-3);
  EXPECT_NEAR(seen.mean[2] / seen.mean[1], 1, 1e-3);
}

TEST_F(Sensor, Pictures) {
  const auto picture = [&](const Cube& cube, PictureColours colours) {
    return make_picture(*open(cube), colours);
  };
  Cube infrared = make_cube(1, 1, equal_bands(8000, 11000, 3));
  infrared.mean = {1, 2, 3};
  EXPECT_EQ(picture(infrared, PictureColours::kFalse), (std::vector<float>{3, 2, 1}));
  EXPECT_EQ(picture(infrared, PictureColours::kSensor), (std::vector<float>{1, 2, 3}));
  EXPECT_EQ(error_of([&] { picture(infrared, PictureColours::kNatural); }),
            "picture: no channel lies in 380-780 nm");
  infrared.info.quantity = Quantity::kDensity;
  EXPECT_EQ(picture(infrared, PictureColours::kFalse), (std::vector<float>{3, 2, 1}));
  Cube red = make_cube(1, 1, equal_bands(600, 660, 1));
  red.mean = {1};
  const auto rgb = picture(red, PictureColours::kNatural);
  EXPECT_GT(rgb[0], 5 * std::abs(rgb[1]));
}

}  // namespace
}  // namespace kiloband
