#include "viewer/api/selections.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/viewer/array_source.hpp"

namespace kiloband::test::selections_test {
namespace {

using namespace viewer;

const std::vector<Band> kBands{{{400, 401, ""}}, {{401, 402, ""}}};

/// Whichever band it is: the first stands for no pixel.
TEST(Curves, AreMeansOfTheValuesThatThereAre) {
  const ArraySource source(4, 1, kBands, {NAN, 1, 2, 3, 4, NAN, NAN, NAN});
  const Curve one = read_curves(source, parse_selections("0,0", 4, 1), 4, 1).front();
  EXPECT_EQ(one.pixels, 1u);
  EXPECT_TRUE(std::isnan(one.mean[0]));
  EXPECT_EQ(one.mean[1], 1);
  const Curve all = read_curves(source, parse_selections("0,0,3,0", 4, 1), 4, 1).front();
  EXPECT_EQ(all.pixels, 3u) << "with a value";
  EXPECT_EQ(all.mean[0], 3);
  EXPECT_EQ(all.mean[1], 2);
  const Curve none = read_curves(source, parse_selections("3,0", 4, 1), 4, 1).front();
  EXPECT_EQ(none.pixels, 0u);
  EXPECT_TRUE(std::isnan(none.mean[1]));
}

TEST(Curves, HaveTheErrorsThatAreKnown) {
  ArraySource source(2, 1, kBands, {1, 2, 3, 4});
  source.set_variances({4, NAN, 4, 9});
  const Curve one = read_curves(source, parse_selections("0,0", 2, 1), 2, 1).front();
  EXPECT_EQ(one.standard_error[0], 2);
  EXPECT_TRUE(std::isnan(one.standard_error[1]));
  const Curve both = read_curves(source, parse_selections("0,0,1,0", 2, 1), 2, 1).front();
  EXPECT_TRUE(std::isnan(both.standard_error[0])) << "nobody knows what the pixels share";
}

}  // namespace
}  // namespace kiloband::test::selections_test
