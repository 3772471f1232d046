// What vertices multiply tau by as rows of channels; compiled once per instruction set.
//
// No include guard of the usual kind: see evaluator_optics-inl.hpp.
#if defined(KILOBAND_EVALUATOR_FACTORS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_EVALUATOR_FACTORS_INL
#undef KILOBAND_EVALUATOR_FACTORS_INL
#else
#define KILOBAND_EVALUATOR_FACTORS_INL
#endif

#include <hwy/contrib/math/math-inl.h>

#include "src_cpu/evaluate/evaluator_optics-inl.hpp"
#include "src_cpu/evaluate/evaluator_tables-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kiloband::cpu {
namespace HWY_NAMESPACE {

/// A whole row at a time: a vector waits for none before it, and the terms stay in registers.
/// at: (S_a, k) to the factor.
template <class At>
HWY_INLINE void fill_factor(const float* a, std::size_t begin, std::size_t end, float* out, const At& at) {
  for (std::size_t k = begin; k < end; k += kVectorChannels) hn::StoreU(at(load(a, k), k), kTag, out + k);
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

/// T of shared/rough_transmission.h. With d = e - 1, s = wi + e wo = (wi + wo) + d wo turned upwards, m = s / |s| and c = wi.wo:
///   A = wi.s = (1 + c) + d c,   B = -wo.s = -((1 + c) + d),   both positive, else T = 0;
///   D(m) = shape(t) |s|^4 / (pi alpha_u alpha_v s_z^4),   t = q / s_z^2,   q = (s_x / alpha_u)^2 + (s_y / alpha_v)^2,
///   shape = exp(-t) or 1 / (1 + t)^2.
/// Snell's law holds at m, so that e cos_t |s| = e B, and with a = A + e B, b = e A + B
///   1 - F = 2 e A B (1 / a^2 + 1 / b^2)   without cancellation.
/// As directions have length 1, a = s.(wi - e wo) = -E and b = c E with E = e^2 - 1, whatever they are, and
///   T = 2 (1 + 1 / c^2) / (pi alpha_u alpha_v)  e / E^2  shape (A B / s_z^2)^2.
template <bool kGgx>
HWY_INLINE Floats rough_transmission(const TransmissionTerms& p, std::size_t k) {
  const Floats d = hn::LoadU(kTag, p.index_less_one + k);
  const Floats x = hn::MulAdd(d, constant(p.ox), constant(p.sx));
  const Floats y = hn::MulAdd(d, constant(p.oy), constant(p.sy));
  const Floats z = hn::MulAdd(d, constant(p.oz), constant(p.sz));
  const Floats in = hn::MulAdd(d, constant(p.cosine), constant(p.one_plus_cosine));
  const Floats product = hn::Mul(in, hn::Add(d, constant(p.one_plus_cosine)));  // -A B
  const Floats u = hn::Mul(x, constant(p.inverse_alpha_u)), v = hn::Mul(y, constant(p.inverse_alpha_v));
  const Floats q = hn::MulAdd(u, u, square(v)), z2 = hn::Max(square(z), constant(kTiny));
  const Floats height = kGgx ? hn::Add(z2, q) : z2;  // of GGX, shape is a part of the quotient
  const Floats inverse = hn::Div(constant(1), height);
  const Floats quotient = hn::Mul(product, inverse);
  Floats norm = hn::Mul(constant(p.norm), hn::LoadU(kTag, p.index_factor + k));
  if constexpr (!kGgx) norm = hn::Mul(norm, hn::Exp(kTag, hn::Mul(hn::Neg(q), inverse)));
  const auto sides = hn::And(hn::Lt(product, hn::Zero(kTag)), hn::Gt(hn::Mul(in, z), hn::Zero(kTag)));
  // Facets that are seen edge-on: exp is 0, and the square of the quotient may be infinite.
  const auto valid = hn::And(sides, hn::Gt(norm, hn::Zero(kTag)));
  return hn::IfThenElseZero(valid, hn::Mul(norm, square(quotient)));
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

inline void internal_row(float escape, const float* a, std::size_t begin, std::size_t end, float* out) {
  fill_factor(a, begin, end, out, [&](Floats s, std::size_t) HWY_ATTR {
    return hn::Div(s, hn::MulAdd(s, constant(escape), hn::Sub(constant(1), s)));
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
