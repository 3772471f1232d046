// Transmission through rough boundaries against its definition in double, up to the errors that rounded directions leave.
#include "rough_pairs.hpp"

namespace kiloband::test::test_rough_transmission {
namespace {

class RoughTransmission : public EachIsa {};

/// Near total reflection, too: there 1 - F from a square root of a difference had 68 times this error.
TEST_P(RoughTransmission, HoldsTheDigitsThatDirectionsHave) {
  for (const float alpha : {1.0f, 0.3f, 0.1f, 0.01f, 1e-3f, 1e-4f}) {
    for (const bool ggx : {false, true}) {
      for (const bool inside : {false, true}) {
        const RoughPairs pairs(alpha, ggx, inside);
        const Evaluator layout(pairs.scene, {}, GetParam());
        const Errors errors =
            errors_of(pairs, evaluate(pairs.scene, {}, pairs.paths, GetParam(), 0), layout.stride());
        EXPECT_LE(errors.largest, 1) << "alpha " << alpha << " ggx " << ggx << " inside " << inside;
        EXPECT_GT(errors.counted, 1000u);  // of 4000: narrow lobes are lit near index 1.5 only
      }
    }
  }
}

TEST_P(RoughTransmission, HorizontalFacetsAreDark) {
  const RoughPairs pairs = horizontal_facet();
  const std::vector<float> values = evaluate(pairs.scene, {}, pairs.paths, GetParam(), 0);
  for (const std::size_t k : kHorizontal) EXPECT_EQ(values[k], 0) << pairs.index[k];
}

TEST_P(RoughTransmission, FacetsSeenEdgeOnStayFinite) {
  const RoughPairs pairs = edge_on_facets();
  for (const float value : evaluate(pairs.scene, {}, pairs.paths, GetParam(), 0)) {
    ASSERT_GE(value, 0);
    ASSERT_LT(value, 1e6);
  }
}

INSTANTIATE_TEST_SUITE_P(, RoughTransmission, testing::ValuesIn(available_isas()), isa_name);

}  // namespace
}  // namespace kiloband::test::test_rough_transmission
