#include "viewer/api/selections.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/viewer/array_source.hpp"
#include "viewer/api/kept_curves.hpp"

namespace kiloband::test::selections_test {
namespace {

using namespace viewer;

const std::vector<Band> kBands{{{400, 401, ""}}, {{401, 402, ""}}};

/// Whichever band it is: the first stands for no pixel.
TEST(Curves, AreMeansOfTheValuesThatThereAre) {
  const ArraySource source(4, 1, kBands, {NAN, 1, 2, 3, 4, NAN, NAN, NAN});
  const Curve one = read_curves(source, parse_selections("0,0", 4, 1), 4, 1, 2).front();
  EXPECT_EQ(one.pixels, 1u);
  EXPECT_TRUE(std::isnan(one.mean[0]));
  EXPECT_EQ(one.mean[1], 1);
  const Curve all = read_curves(source, parse_selections("0,0,3,0", 4, 1), 4, 1, 2).front();
  EXPECT_EQ(all.pixels, 3u) << "with a value";
  EXPECT_EQ(all.mean[0], 3);
  EXPECT_EQ(all.mean[1], 2);
  const Curve none = read_curves(source, parse_selections("3,0", 4, 1), 4, 1, 2).front();
  EXPECT_EQ(none.pixels, 0u);
  EXPECT_TRUE(std::isnan(none.mean[1]));
}

/// Rectangles that lie in each other, apart and across the rows that are read together: sums by hand, the same bits for all threads, alone or
/// with others, and when they are asked for again.
TEST(Curves, AreTheSameForAnyNumberOfThreads) {
  constexpr uint32_t kWidth = 5, kHeight = 77;
  std::vector<float> values, variances;
  for (uint32_t i = 0; i < kWidth * kHeight * 2; ++i) {
    values.push_back(i % 11 == 3 ? NAN : std::sin(static_cast<float>(i)) * 1e6f);
    variances.push_back(static_cast<float>(i % 7) * 0.1f);
  }
  ArraySource source(kWidth, kHeight, kBands, values);
  source.set_variances(variances);
  const auto places = parse_selections("0,0,4,76;1,15,3,48;2,16,2,16;0,70,4,76;0,0,0,0", kWidth, kHeight);
  const auto curves = read_curves(source, places, kWidth, kHeight, 1);
  KeptCurves kept;
  for (const unsigned threads : {2u, 3u, 16u})
    for (std::size_t i = 0; i < places.size(); ++i) {
      double sum = 0, count = 0;
      for (uint32_t y = places[i].y0; y <= places[i].y1; ++y)
        for (uint32_t x = places[i].x0; x <= places[i].x1; ++x)
          if (const float value = values[(y * kWidth + x) * 2 + 1]; !std::isnan(value)) sum += value, ++count;
      EXPECT_NEAR(curves[i].mean[1], sum / count, 1e-7 * 1e6) << i;
      const ImageView image{source, {}, false, kWidth, kHeight, {}};
      for (const auto& again :
           {read_curves(source, {places[i]}, kWidth, kHeight, threads).front(),
            read_curves(source, places, kWidth, kHeight, threads)[i],
            kept.read(image, {places[i]}, threads).front(), kept.read(image, places, threads)[i]}) {
        EXPECT_EQ(again.pixels, curves[i].pixels);
        EXPECT_EQ(again.mean, curves[i].mean) << i << " on " << threads;
      }
    }
}

TEST(Curves, HaveTheErrorsThatAreKnown) {
  ArraySource source(2, 1, kBands, {1, 2, 3, 4});
  source.set_variances({4, NAN, 4, 9});
  const Curve one = read_curves(source, parse_selections("0,0", 2, 1), 2, 1, 2).front();
  EXPECT_EQ(one.standard_error[0], 2);
  EXPECT_TRUE(std::isnan(one.standard_error[1]));
  const Curve both = read_curves(source, parse_selections("0,0,1,0", 2, 1), 2, 1, 2).front();
  EXPECT_TRUE(std::isnan(both.standard_error[0])) << "nobody knows what the pixels share";
}

}  // namespace
}  // namespace kiloband::test::selections_test
