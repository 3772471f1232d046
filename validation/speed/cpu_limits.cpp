#include "validation/speed/cpu_limits.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <stdexcept>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "validation/speed/cpu_limits.cpp"
#include "base/simd_targets.hpp"
// Before foreach_target.h.
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks for.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace kiloband::speed {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Returns the number of operations; `factor` below 1 keeps the values finite, `sum` keeps the compiler from dropping them.
double multiply_and_add(std::size_t repeats, float factor, float& sum) {
  const hn::ScalableTag<float> tag;
  const auto s = hn::Set(tag, factor);
  auto a = s, b = hn::Add(a, s), c = hn::Add(b, s), d = hn::Add(c, s), e = hn::Add(d, s), f = hn::Add(e, s),
       g = hn::Add(f, s), h = hn::Add(g, s);
  for (std::size_t r = 0; r < repeats; ++r) {
    a = hn::MulAdd(a, s, s), b = hn::MulAdd(b, s, s), c = hn::MulAdd(c, s, s), d = hn::MulAdd(d, s, s);
    e = hn::MulAdd(e, s, s), f = hn::MulAdd(f, s, s), g = hn::MulAdd(g, s, s), h = hn::MulAdd(h, s, s);
  }
  const auto all = hn::Add(hn::Add(hn::Add(a, b), hn::Add(c, d)), hn::Add(hn::Add(e, f), hn::Add(g, h)));
  sum += hn::GetLane(all);
  return 2.0 * 8 * static_cast<double>(hn::Lanes(tag)) * static_cast<double>(repeats);
}

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::speed
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kiloband::speed {
namespace {

using Work = double (*)(std::size_t repeats, float factor, float& sum);

Work work_of(cpu::Isa isa) {
  switch (isa) {
#if HWY_TARGETS & HWY_AVX3
    case cpu::Isa::kAvx512:
      return N_AVX3::multiply_and_add;
#endif
#if HWY_TARGETS & HWY_AVX2
    case cpu::Isa::kAvx2:
      return N_AVX2::multiply_and_add;
#endif
#if HWY_TARGETS & HWY_SSE4
    case cpu::Isa::kSse4:
      return N_SSE4::multiply_and_add;
#endif
    default:
      throw std::logic_error("peak_flops_of_thread: the instruction set is not resolved");
  }
}

}  // namespace

double peak_flops_of_thread(cpu::Isa isa) {
  using Clock = std::chrono::steady_clock;
  constexpr int kAttempts = 20;
  constexpr std::size_t kRepeats = 1 << 20;
  const Work work = work_of(isa);
  volatile float factor = 0.5f;
  float sum = 0;
  double best = 0;
  for (int i = 0; i < kAttempts; ++i) {
    const auto start = Clock::now();
    const double operations = work(kRepeats, factor, sum);
    best = std::max(best, operations / std::chrono::duration<double>(Clock::now() - start).count());
  }
  if (!(sum > 0)) throw std::logic_error("peak_flops_of_thread: nothing was computed");
  return best;
}

}  // namespace kiloband::speed
#endif
