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
  const std::size_t lanes = hn::Lanes(kWide), whole = count / lanes * lanes;
  auto red = hn::Zero(kWide), green = red, blue = red;
  const auto add = [&](std::size_t k, auto value, auto load) HWY_ATTR {
    red = hn::MulAdd(load(weights[0] + k), value, red);
    green = hn::MulAdd(load(weights[1] + k), value, green);
    blue = hn::MulAdd(load(weights[2] + k), value, blue);
  };
  for (std::size_t k = 0; k < whole; k += lanes)
    add(k, hn::LoadU(kWide, values + k), [&](const float* from) HWY_ATTR { return hn::LoadU(kWide, from); });
  if (whole < count) {
    const auto rest = hn::FirstN(kWide, count - whole);
    const auto some = [&](const float* from) HWY_ATTR { return hn::MaskedLoad(rest, kWide, from); };
    add(whole, some(values + whole), some);
  }
  out[0] = hn::GetLane(hn::SumOfLanes(kWide, red));
  out[1] = hn::GetLane(hn::SumOfLanes(kWide, green));
  out[2] = hn::GetLane(hn::SumOfLanes(kWide, blue));
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
