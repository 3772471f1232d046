// What vertices multiply tau by as rows of channels; compiled once per instruction set.
//
// No include guard of the usual kind: see evaluator_optics-inl.hpp.
#if defined(KILOBAND_EVALUATOR_FACTORS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_EVALUATOR_FACTORS_INL
#undef KILOBAND_EVALUATOR_FACTORS_INL
#else
#define KILOBAND_EVALUATOR_FACTORS_INL
#endif

#include "src_cpu/evaluate/evaluator_optics-inl.hpp"
#include "src_cpu/evaluate/evaluator_tables-inl.hpp"
#include "src_cpu/evaluate/evaluator_transmission-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kiloband::cpu {
namespace HWY_NAMESPACE {

/// A whole row at a time: a vector waits for none before it, and the terms stay in registers.
/// at: (S_a, k) to the factor.
template <class At>
HWY_INLINE void fill_factor(const float* a, std::size_t begin, std::size_t end, float* out, const At& at) {
  for (std::size_t k = begin; k < end; k += kLanes) hn::StoreU(at(load(a, k), k), kTag, out + k);
}

inline void fresnel_row(const FresnelTerms& terms, const float* a, std::size_t begin, std::size_t end,
                        float* out) {
  const FresnelTerms f = terms;
  const auto fill = [&](const auto& reflectance) HWY_ATTR {
    fill_factor(a, begin, end, out,
                [&](Floats s, std::size_t k) HWY_ATTR { return hn::Mul(s, reflectance(k)); });
  };
  if (f.nk)
    fill([&](std::size_t k) HWY_ATTR { return conductor_fresnel(f, k); });
  else if (f.of == FresnelTerms::Of::kBoundary)
    fill([&](std::size_t k) HWY_ATTR { return dielectric_fresnel(f, k); });
  else
    fill([&](std::size_t k) HWY_ATTR { return pane(f, k); });
}

inline void transmission_row(const TransmissionTerms& terms, const float* a, std::size_t begin,
                             std::size_t end, float* out) {
  const TransmissionTerms p = terms;
  const auto fill = [&](const auto& factor) HWY_ATTR {
    fill_factor(a, begin, end, out, [&](Floats s, std::size_t k) HWY_ATTR { return hn::Mul(s, factor(k)); });
  };
  if (p.ggx)
    fill([&](std::size_t k) HWY_ATTR { return rough_transmission<true>(p, k); });
  else
    fill([&](std::size_t k) HWY_ATTR { return rough_transmission<false>(p, k); });
}

inline void internal_row(float fdr_int, const float* a, std::size_t begin, std::size_t end, float* out) {
  fill_factor(a, begin, end, out, [&](Floats s, std::size_t) HWY_ATTR {
    return hn::Div(s, hn::NegMulAdd(s, constant(fdr_int), constant(1)));
  });
}

inline void tinted_row(float w0, float w1, const float* a, std::size_t begin, std::size_t end, float* out) {
  const auto fill = [&](const auto& second) HWY_ATTR {
    fill_factor(a, begin, end, out,
                [&](Floats s, std::size_t) HWY_ATTR { return hn::MulAdd(constant(w0), s, second(s)); });
  };
  if (w1 >= 0)
    fill([&](Floats) HWY_ATTR { return constant(w1); });
  else
    fill([&](Floats s) HWY_ATTR { return hn::Mul(constant(-w1), hn::Sqrt(s)); });
}

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::cpu
HWY_AFTER_NAMESPACE();

#endif
