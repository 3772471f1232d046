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
  for (std::size_t k = 0; k < whole; k += lanes) {
    const auto value = hn::LoadU(kWide, values + k);
    red = hn::MulAdd(hn::LoadU(kWide, weights[0] + k), value, red);
    green = hn::MulAdd(hn::LoadU(kWide, weights[1] + k), value, green);
    blue = hn::MulAdd(hn::LoadU(kWide, weights[2] + k), value, blue);
  }
  // No MaskedLoad: for SSE4.2 that is an aligned load of a whole vector. In registers: `out` might be what is read.
  float rest[3] = {};
  for (std::size_t k = whole; k < count; ++k)
    for (std::size_t c = 0; c < 3; ++c) rest[c] += weights[c][k] * values[k];
  out[0] = hn::GetLane(hn::SumOfLanes(kWide, red)) + rest[0];
  out[1] = hn::GetLane(hn::SumOfLanes(kWide, green)) + rest[1];
  out[2] = hn::GetLane(hn::SumOfLanes(kWide, blue)) + rest[2];
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
