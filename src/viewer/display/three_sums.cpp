#include "viewer/display/three_sums.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "viewer/display/three_sums.cpp"
#include "base/simd_targets.hpp"
// Before foreach_target.h.
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks for.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace kiloband::viewer {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void three_sums(const std::array<const float*, 3>& weights, const float* values, std::size_t count,
                float* out) {
  constexpr hn::ScalableTag<float> kWide;
  constexpr hn::FixedTag<float, 4> kFour;
  auto red = hn::Zero(kWide), green = red, blue = red;
  std::size_t k = 0;
  for (const std::size_t lanes = hn::Lanes(kWide); k + lanes <= count; k += lanes) {
    const auto value = hn::LoadU(kWide, values + k);
    red = hn::MulAdd(hn::LoadU(kWide, weights[0] + k), value, red);
    green = hn::MulAdd(hn::LoadU(kWide, weights[1] + k), value, green);
    blue = hn::MulAdd(hn::LoadU(kWide, weights[2] + k), value, blue);
  }
  // What is left of a vector, first four by four. No MaskedLoad: for SSE4.2 that is an aligned load of a whole vector.
  auto red4 = hn::Zero(kFour), green4 = red4, blue4 = red4;
  for (; k + 4 <= count; k += 4) {
    const auto value = hn::LoadU(kFour, values + k);
    red4 = hn::MulAdd(hn::LoadU(kFour, weights[0] + k), value, red4);
    green4 = hn::MulAdd(hn::LoadU(kFour, weights[1] + k), value, green4);
    blue4 = hn::MulAdd(hn::LoadU(kFour, weights[2] + k), value, blue4);
  }
  float red1 = 0, green1 = 0, blue1 = 0;  // in registers: `out` might be what is read
  for (; k < count; ++k) {
    red1 += weights[0][k] * values[k];
    green1 += weights[1][k] * values[k];
    blue1 += weights[2][k] * values[k];
  }
  const auto sum = [&](auto wide, auto four, float one) {
    return hn::GetLane(hn::SumOfLanes(kWide, wide)) + hn::GetLane(hn::SumOfLanes(kFour, four)) + one;
  };
  out[0] = sum(red, red4, red1);
  out[1] = sum(green, green4, green1);
  out[2] = sum(blue, blue4, blue1);
}

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::viewer
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kiloband::viewer {

HWY_EXPORT(three_sums);

void three_sums(const std::array<const float*, 3>& weights, const float* values, std::size_t count,
                float* out) {
  HWY_DYNAMIC_DISPATCH(three_sums)(weights, values, count, out);
}

}  // namespace kiloband::viewer
#endif
