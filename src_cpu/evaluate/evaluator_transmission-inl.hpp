// Transmission through a rough boundary for one vector of channels; compiled once per instruction set.
//
// No include guard of the usual kind: see evaluator_optics-inl.hpp.
#if defined(KILOBAND_EVALUATOR_TRANSMISSION_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_EVALUATOR_TRANSMISSION_INL
#undef KILOBAND_EVALUATOR_TRANSMISSION_INL
#else
#define KILOBAND_EVALUATOR_TRANSMISSION_INL
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "src_cpu/evaluate/evaluator_kernels.hpp"
#include "src_cpu/evaluate/evaluator_optics-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kiloband::cpu {
namespace HWY_NAMESPACE {

/// Smallest divisor that is used, a product of four lengths: the reciprocal is finite.
inline constexpr float kTinyProduct = 1e-36f;

/// T of shared/rough_transmission.h. With d = e - 1, s = wi + e wo = (wi + wo) + d wo turned upwards and m = s / |s|:
///   A = wi.s = (1 + wi.wo) + d wi.wo,   B = -wo.s = -((1 + wi.wo) + d),   both positive, else T = 0;
///   D(m) = shape(t) |s|^4 / (pi alpha_u alpha_v s_z^4),   t = q / s_z^2,   q = (s_x / alpha_u)^2 + (s_y / alpha_v)^2,
///   shape = exp(-t) or 1 / (1 + t)^2.
/// Snell's law holds at m, so that e cos_t |s| = e B, and with a = A + e B, b = e A + B
///   1 - F = 2 e A B (1 / a^2 + 1 / b^2)   without cancellation, and
///   T = 2 e shape / (pi alpha_u alpha_v) (A B / (a b s_z^2))^2 (a^2 + b^2):
/// |s| drops out, and one division is left.
HWY_INLINE Floats rough_transmission(const TransmissionTerms& p, std::size_t k) {
  const Floats d = hn::LoadU(kTag, p.index_less_one + k), e = hn::Add(d, constant(1));
  const Floats x = hn::MulAdd(d, constant(p.ox), constant(p.sx));
  const Floats y = hn::MulAdd(d, constant(p.oy), constant(p.sy));
  const Floats z = hn::MulAdd(d, constant(p.oz), constant(p.sz));
  const Floats a_i = hn::MulAdd(d, constant(p.cosine), constant(p.one_plus_cosine));
  const Floats a_o = hn::Add(d, constant(p.one_plus_cosine));
  const Floats up = hn::And(z, hn::SignBit(kTag));
  const Floats in = hn::Xor(a_i, up), out = hn::Xor(hn::Neg(a_o), up);
  const Floats u = hn::Mul(x, constant(p.inverse_alpha_u)), v = hn::Mul(y, constant(p.inverse_alpha_v));
  const Floats q = hn::MulAdd(u, u, square(v)), z2 = hn::Max(square(z), constant(kTiny));
  const Floats a = hn::MulAdd(e, out, in), b = hn::MulAdd(e, in, out), ab = hn::Mul(a, b);
  const Floats height = p.ggx ? hn::Add(z2, q) : z2;  // of GGX, shape is a part of the quotient
  const Floats inverse = hn::Div(constant(1), hn::Max(hn::Mul(ab, height), constant(kTinyProduct)));
  Floats norm = hn::Mul(constant(2 * p.norm), e);
  if (!p.ggx) norm = hn::Mul(norm, hn::Exp(kTag, hn::Mul(hn::Mul(hn::Neg(q), ab), inverse)));
  const Floats quotient = hn::Mul(hn::Mul(in, out), inverse);
  const Floats value = hn::Mul(hn::Mul(norm, quotient), hn::Mul(quotient, hn::MulAdd(a, a, square(b))));
  const auto valid = hn::And(hn::Gt(in, hn::Zero(kTag)), hn::Gt(out, hn::Zero(kTag)));
  return hn::IfThenElseZero(valid, value);
}

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::cpu
HWY_AFTER_NAMESPACE();

#endif
