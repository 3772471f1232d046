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

/// 1 - F of a dielectric boundary, e^2 = E + 1, for cosines that differ from lane to lane; 0 where
/// g^2 = E + c^2 <= 0.
HWY_INLINE Floats transmittance(Floats big_e, Floats c) {
  const Floats c2 = square(c);
  const Floats g2 = hn::Add(big_e, c2);
  const Floats g = hn::Sqrt(hn::Max(g2, hn::Zero(kTag)));
  return hn::IfThenElseZero(hn::Gt(g2, hn::Zero(kTag)),
                            hn::Sub(constant(1), partial_reflectance(big_e, g, c, c2)));
}

/// T of shared/rough_transmission.h. With s = wi + e wo = (wi + wo) + d wo, d = e - 1 = E / (e + 1), and
/// m = s / |s| turned upwards:
///   D(m) = shape(t) / (pi alpha_u alpha_v cos^4), t = ((s_x / alpha_u)^2 + (s_y / alpha_v)^2) / s_z^2,
///   cos^2 = s_z^2 / |s|^2, shape = exp(-t) or 1 / (1 + t)^2;  wi.s = (1 + wi.wo) + d wi.wo,
///   wo.s = (1 + wi.wo) + d.
HWY_INLINE Floats rough_transmission(const TransmissionTerms& p, std::size_t k) {
  const Floats big_e = hn::Add(hn::LoadU(kTag, p.high + k), hn::LoadU(kTag, p.low + k));
  const Floats e = hn::Sqrt(hn::Max(hn::Add(big_e, constant(1)), hn::Zero(kTag)));
  const Floats d = hn::Div(big_e, hn::Add(e, constant(1)));
  const Floats x = hn::MulAdd(d, constant(p.ox), constant(p.sx));
  const Floats y = hn::MulAdd(d, constant(p.oy), constant(p.sy));
  const Floats z = hn::MulAdd(d, constant(p.oz), constant(p.sz));
  const Floats z2 = hn::Max(square(z), constant(kTiny));
  const Floats size2 = hn::MulAdd(x, x, hn::MulAdd(y, y, z2));
  const Floats length = hn::CopySign(hn::Sqrt(size2), z);
  const Floats dot_i = hn::Div(hn::MulAdd(d, constant(p.cosine), constant(p.one_plus_cosine)), length);
  const Floats dot_o = hn::Div(hn::Add(d, constant(p.one_plus_cosine)), length);
  const Floats u = hn::Mul(x, constant(p.inverse_alpha_u)), v = hn::Mul(y, constant(p.inverse_alpha_v));
  const Floats slope2 = hn::Div(hn::MulAdd(u, u, square(v)), z2);
  Floats shape;
  if (p.ggx)
    shape = hn::Div(constant(1), square(hn::Add(constant(1), slope2)));
  else
    shape = hn::Exp(kTag, hn::Neg(hn::Min(slope2, constant(80))));
  const Floats inverse_cos2 = hn::Div(size2, z2);
  const Floats density = hn::Mul(hn::Mul(constant(p.norm), shape), square(inverse_cos2));
  const Floats seen = hn::Min(dot_i, constant(1));
  const Floats value =
      hn::Mul(hn::Mul(transmittance(big_e, seen), density), hn::Div(hn::Mul(seen, hn::Neg(dot_o)), size2));
  const auto valid = hn::And(hn::Gt(dot_i, hn::Zero(kTag)), hn::Lt(dot_o, hn::Zero(kTag)));
  return hn::IfThenElseZero(valid, value);
}

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::cpu
HWY_AFTER_NAMESPACE();

#endif
