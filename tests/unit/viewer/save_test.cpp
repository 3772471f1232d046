// Tables of spectra.
#include "viewer/api/save.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace kiloband::test::save_test {
namespace {

using namespace viewer;

TEST(SpectraTable, HasNamesWhereThereAreSome) {
  const std::vector<Curve> curve{{1, {4, 2, 1}, {0.5f, 0.25f, 0.125f}}};
  EXPECT_EQ(curves_csv({{{500, 510, ""}}, {{600, 620, "a, \"b\""}}, {{0, 0, "Red"}, true}},
                       {{"1,2", 1, 2, 1, 2}}, curve),
            "name,min_nm,max_nm,mean_1_2,standard_error_1_2\n"
            ",500,510,4,0.5\n"
            "\"a, \"\"b\"\"\",600,620,2,0.25\n"
            "Red,,,1,0.125\n");
}

}  // namespace
}  // namespace kiloband::test::save_test
