// Fresnel reflectances of one vector of channels; compiled once per instruction set.
//
// No include guard of the usual kind: evaluator_kernels.cpp includes itself, and this file, once per target.
#if defined(KILOBAND_EVALUATOR_OPTICS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_EVALUATOR_OPTICS_INL
#undef KILOBAND_EVALUATOR_OPTICS_INL
#else
#define KILOBAND_EVALUATOR_OPTICS_INL
#endif

#include <hwy/highway.h>

#include <utility>

#include "src_cpu/evaluate/evaluator_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace kiloband::cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::ScalableTag<float>;
using DoubleTag = hn::ScalableTag<double>;
using HalfTag = hn::Rebind<float, DoubleTag>;
using Floats = hn::Vec<Tag>;
using Doubles = hn::Vec<DoubleTag>;
inline constexpr Tag kTag;
inline constexpr DoubleTag kDoubleTag;

HWY_INLINE Floats square(Floats x) {
  return hn::Mul(x, x);
}
HWY_INLINE Floats constant(float x) {
  return hn::Set(kTag, x);
}

/// Calls f with the constants 0 .. N-1: array elements stay in registers.
template <class F, std::size_t... I>
HWY_INLINE void unrolled(F&& f, std::index_sequence<I...>) {
  (f(std::integral_constant<std::size_t, I>{}), ...);
}

/// Smallest divisor that is used: 0 / 0 at grazing incidence on a matched boundary comes to 0.
inline constexpr float kTiny = 1e-18f;

/// |a + ib|^2, and of a and b the larger, where (a + ib)^2 = t + 2i nk.
struct ConductorRoot {
  Floats modulus, larger;
};

HWY_INLINE ConductorRoot conductor_root(Floats t, Floats nk) {
  const Floats modulus = hn::Sqrt(hn::MulAdd(t, t, hn::Mul(constant(4), square(nk))));
  return {modulus, hn::Sqrt(hn::Mul(constant(0.5f), hn::Add(modulus, hn::Abs(t))))};
}

/// Unpolarised reflectance of a conductor with index n + ik for the cosine c.
/// With (a + ib)^2 = (n + ik)^2 - s^2, s^2 = 1 - c^2 and T = n^2 - 1 - k^2
/// (so a^2 - b^2 = T + c^2 =: t, ab = nk):
///   R_s = ((a - c)^2 + b^2) / ((a + c)^2 + b^2),
///   R_p = R_s ((ac - s^2)^2 + b^2 c^2) / ((ac + s^2)^2 + b^2 c^2).
/// Without cancellation: of a and b the larger comes from sqrt((|a+ib|^2 + |t|) / 2), the other from ab = nk.
/// Where a >= b, a - c = (T + b^2) / (a + c), which is accurate for n near 1; elsewhere b^2 outweighs the
/// rounding of a - c.
HWY_INLINE Floats any_conductor_fresnel(const FresnelTerms& f, std::size_t k, Floats nk) {
  const Floats c = constant(f.cosine), s2 = constant(f.sine2);
  const Floats big_t = hn::LoadU(kTag, f.high + k);
  const Floats t = hn::Add(hn::Add(big_t, constant(f.cosine2_high)),
                           hn::Add(hn::LoadU(kTag, f.low + k), constant(f.cosine2_low)));
  const Floats larger = conductor_root(t, nk).larger;
  const Floats smaller = hn::Div(nk, hn::Max(larger, constant(kTiny)));
  const auto a_is_larger = hn::Ge(t, hn::Zero(kTag));
  const Floats a = hn::IfThenElse(a_is_larger, larger, smaller);
  const Floats b2 = square(hn::IfThenElse(a_is_larger, smaller, larger));
  const Floats sum = hn::Add(a, c);
  const Floats quotient = hn::Div(hn::Add(big_t, b2), hn::Max(sum, constant(kTiny)));
  const Floats difference = hn::IfThenElse(a_is_larger, quotient, hn::Sub(a, c));
  const Floats rs =
      hn::Div(hn::MulAdd(difference, difference, b2), hn::Max(hn::MulAdd(sum, sum, b2), constant(kTiny)));
  const Floats b2c2 = hn::Mul(b2, constant(f.cosine2_high));
  const Floats minus = hn::Sub(hn::Mul(a, c), s2), plus = hn::MulAdd(a, c, s2);
  const Floats ratio =
      hn::Div(hn::MulAdd(minus, minus, b2c2), hn::Max(hn::MulAdd(plus, plus, b2c2), constant(kTiny)));
  return hn::Mul(hn::Mul(constant(0.5f), rs), hn::Add(constant(1), ratio));
}

/// The same where is_metallic(): with A = |a + ib|^2 and a = u / w, of which u = nk, w = b where b is the larger, else u = a, w = 1,
///   R = (R_s + R_p) / 2 = (A + c^2 - 2ac) (A c^2 + s^4) / ((A + c^2 + 2ac) (A c^2 + 2ac s^2 + s^4)),
/// of whose terms only the first cancels, by no more than 1 / R. One division instead of four.
HWY_INLINE Floats metal_fresnel(const FresnelTerms& f, std::size_t k, Floats nk) {
  const Floats c2 = constant(f.cosine2_high), s2 = constant(f.sine2);
  const Floats t = hn::Add(hn::LoadU(kTag, f.high + k), c2);
  const auto [modulus, larger] = conductor_root(t, nk);
  const auto a_is_larger = hn::Ge(t, hn::Zero(kTag));
  const Floats u = hn::IfThenElse(a_is_larger, larger, nk),
               w = hn::IfThenElse(a_is_larger, constant(1), larger);
  const Floats middle = hn::Mul(w, hn::Add(modulus, c2)), cross = hn::Mul(constant(2 * f.cosine), u);
  const Floats parallel = hn::Mul(w, hn::MulAdd(modulus, c2, square(s2)));
  const Floats above = hn::Mul(hn::Sub(middle, cross), parallel);
  const Floats below = hn::Mul(hn::Add(middle, cross), hn::MulAdd(s2, cross, parallel));
  return hn::Div(above, hn::Max(below, constant(kTiny)));  // 0 where the padding of rows is 0 and c, too
}

HWY_INLINE Floats conductor_fresnel(const FresnelTerms& f, std::size_t k) {
  const Floats nk = hn::LoadU(kTag, f.nk + k);
  const hn::RebindToSigned<Tag> signed_tag;
  const auto other = hn::RebindMask(kTag, hn::Lt(hn::BitCast(signed_tag, nk), hn::Zero(signed_tag)));
  if (HWY_LIKELY(hn::AllFalse(kTag, other))) return metal_fresnel(f, k, nk);
  const Floats careful = any_conductor_fresnel(f, k, hn::Abs(nk));
  return hn::AllTrue(kTag, other) ? careful : hn::IfThenElse(other, careful, metal_fresnel(f, k, nk));
}

/// A dielectric boundary of relative index e (transmitted over incident) for the cosine c, s^2 = 1 - c^2, in one channel each: E = e^2 - 1,
/// g = e cos_t = sqrt(E + c^2), 0 at total reflection, p = c g + s^2 and e^2 c + g = (c + g) p.
struct Boundary {
  Floats big_e, g2, g, cg, sum, p;
};

HWY_INLINE Boundary boundary(const FresnelTerms& f, std::size_t k) {
  const Floats c = constant(f.cosine), big_e = hn::LoadU(kTag, f.high + k);
  const Floats g2 = hn::Add(hn::Add(big_e, constant(f.cosine2_high)),
                            hn::Add(hn::LoadU(kTag, f.low + k), constant(f.cosine2_low)));
  const Floats g = hn::Sqrt(hn::Max(g2, hn::Zero(kTag)));
  const Floats cg = hn::Mul(c, g);
  return {big_e, g2, g, cg, hn::Add(c, g), hn::Add(cg, constant(f.sine2))};
}

/// Unpolarised reflectance, numerators expanded so that E stands in front:
///   r_s = -E / (c + g)^2,   r_p = r_s (s^2 - c g) / p,   F = (r_s^2 + r_p^2) / 2 = (c^2 g^2 + s^4) (E / ((c + g)^2 p))^2.
/// 1 where g^2 <= 0: total reflection.
HWY_INLINE Floats dielectric_fresnel(const FresnelTerms& f, std::size_t k) {
  const Boundary b = boundary(f, k);
  const Floats below = hn::Max(hn::Mul(square(b.sum), b.p), constant(kTiny));
  const Floats above = hn::MulAdd(b.cg, b.cg, constant(f.sine2 * f.sine2));
  const Floats value = hn::Mul(above, square(hn::Div(b.big_e, below)));
  return hn::IfThenElse(hn::Le(b.g2, hn::Zero(kTag)), constant(1), value);
}

/// T = 1 - F without cancellation:
///   T = 2 c g (1 / (c + g)^2 + e^2 / (e^2 c + g)^2) = 2 c g (p^2 + e^2) / ((c + g) p)^2.
HWY_INLINE Floats dielectric_transmittance(const FresnelTerms& f, std::size_t k) {
  const Boundary b = boundary(f, k);
  const Floats inverse = hn::Div(constant(1), hn::Max(hn::Mul(b.sum, b.p), constant(kTiny)));
  const Floats above = hn::Add(square(b.p), hn::Add(b.big_e, constant(1)));
  return hn::Mul(hn::Mul(hn::Add(b.cg, b.cg), inverse), hn::Mul(above, inverse));
}

/// What a pane of two boundaries reflects, 2 F / (1 + F), or lets through, (1 - F) / (1 + F) = T / (2 - T).
HWY_INLINE Floats pane(const FresnelTerms& terms, std::size_t k) {
  if (terms.of == FresnelTerms::Of::kPaneTransmittance) {
    const Floats t = dielectric_transmittance(terms, k);
    return hn::Div(t, hn::Sub(constant(2), t));
  }
  const Floats f = dielectric_fresnel(terms, k);
  return hn::Div(hn::Add(f, f), hn::Add(constant(1), f));
}

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::cpu
HWY_AFTER_NAMESPACE();

#endif
