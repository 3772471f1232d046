#include "stats/division_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stats/division_kernels.cpp"
#include "base/simd_targets.hpp"
// Before foreach_target.h.
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks for.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace kiloband::stats {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

inline constexpr hn::CappedTag<float, 16> kUnits;
using Units = hn::Vec<decltype(kUnits)>;
inline constexpr std::size_t kLanes = hn::MaxLanes(kUnits);
inline constexpr std::size_t kVectors = kBlockUnits / kLanes < 4 ? kBlockUnits / kLanes : 4;  // at a time

HWY_INLINE Units not_negative(Units x) {
  return hn::IfThenElseZero(hn::Gt(x, hn::Zero(kUnits)), x);
}

HWY_INLINE void store_cells(const DividedForms& forms, Units s, Units q, const float* slack, uint32_t cells,
                            uint32_t* cell) {
  const auto all_units = [](float x) { return hn::Set(kUnits, x); };
  const hn::RebindToSigned<decltype(kUnits)> whole;
  const hn::RebindToUnsigned<decltype(kUnits)> words;
  const Units a = hn::Mul(all_units(forms.half), s);
  const Units d =
      not_negative(hn::Sub(hn::Mul(all_units(forms.of_difference), hn::Abs(a)), hn::LoadU(kUnits, slack)));
  const Units v = not_negative(hn::Sub(hn::Add(all_units(forms.of_one), hn::Mul(all_units(forms.of_q), q)),
                                       hn::Mul(hn::Mul(all_units(forms.of_squares), a), a)));
  const Units d2 = hn::Mul(d, d), all = hn::Add(d2, hn::Mul(all_units(4), v));
  const Units place = hn::Mul(all_units(static_cast<float>(cells)), hn::Div(d2, all));
  const Units last = hn::Min(place, all_units(static_cast<float>(cells - 1)));
  const Units chosen = hn::IfThenElseZero(hn::Gt(all, hn::Zero(kUnits)), last);
  hn::StoreU(hn::BitCast(words, hn::ConvertTo(whole, chosen)), words, cell);
}

template <bool kNeedsQ>
HWY_INLINE void find_some(const DividedForms& forms, const float* values, const float* division,
                          const float* slack, uint32_t cells, uint32_t* cell) {
  Units s[kVectors], q[kVectors];
  for (std::size_t i = 0; i < kVectors; ++i) s[i] = q[i] = hn::Zero(kUnits);
  for (std::size_t r = 0; r < forms.replicates; ++r, values += kBlockUnits) {
    const Units w = hn::Set(kUnits, division[r]);
    for (std::size_t i = 0; i < kVectors; ++i) {
      const Units x = hn::LoadU(kUnits, values + i * kLanes), wx = hn::Mul(w, x);
      s[i] = hn::Add(s[i], wx);
      if (kNeedsQ) q[i] = hn::Add(q[i], hn::Mul(wx, x));
    }
  }
  for (std::size_t i = 0; i < kVectors; ++i)
    store_cells(forms, s[i], q[i], slack + i * kLanes, cells, cell + i * kLanes);
}

void find_cells(const DividedForms& forms, const float* values, const float* division, const float* slack,
                uint32_t cells, uint32_t* cell) {
  for (std::size_t i = 0; i < kBlockUnits; i += kVectors * kLanes) {
    if (forms.needs_q) {
      find_some<true>(forms, values + i, division, slack + i, cells, cell + i);
    } else {
      find_some<false>(forms, values + i, division, slack + i, cells, cell + i);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::stats
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kiloband::stats {

HWY_EXPORT(find_cells);

void find_cells(const DividedForms& forms, const float* values, const float* division, const float* slack,
                uint32_t cells, uint32_t (&cell)[kBlockUnits]) {
  HWY_DYNAMIC_DISPATCH(find_cells)(forms, values, division, slack, cells, cell);
}

}  // namespace kiloband::stats
#endif
