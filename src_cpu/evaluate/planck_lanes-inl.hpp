// Planck's law at a temperature of its own for a vector of channels; compiled once per instruction set.
//
// No include guard of the usual kind: see evaluator_optics-inl.hpp.
#if defined(KILOBAND_PLANCK_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_PLANCK_LANES_INL
#undef KILOBAND_PLANCK_LANES_INL
#else
#define KILOBAND_PLANCK_LANES_INL
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace kiloband::cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// B(T) / B(T_r) with y = hc / (k lambda) in kelvin and a reference T_r:
///   (e^(y/T_r) - 1) / (e^(y/T) - 1) = exp(-y (1/T - 1/T_r)) (1 - e^(-y/T_r)) / (1 - e^(-y/T)).
/// What the float range holds of it has y (1/T - 1/T_r) < 104, however large y / T is: the exponent is formed
/// from the difference of the reciprocals (taken in double), so its relative rounding, 3 * 2^-25 at most (y,
/// the product's two parts), comes to 1e-5 of the ratio at the bottom of the range and to 1e-6 where the
/// ratio is above 1e-4.
struct PlanckReference {
  double reciprocal;                  // 1 / T_r
  hn::Vec<hn::ScalableTag<float>> y;  // K
  hn::Vec<hn::ScalableTag<float>> numerator;
};

HWY_INLINE PlanckReference planck_reference(hn::Vec<hn::ScalableTag<float>> y, double reference_k) {
  const hn::ScalableTag<float> d;
  const double reciprocal = 1 / reference_k;
  return {reciprocal, y, hn::Expm1(d, hn::Mul(y, hn::Set(d, static_cast<float>(-reciprocal))))};
}

HWY_INLINE hn::Vec<hn::ScalableTag<float>> planck_ratio(const PlanckReference& r, double temperature_k) {
  const hn::ScalableTag<float> d;
  const double reciprocal = 1 / temperature_k, difference = r.reciprocal - reciprocal;
  const auto exponent = hn::Mul(r.y, hn::Set(d, static_cast<float>(difference)));
  // The rounding of `difference` to float, put back.
  const auto rest = hn::Set(d, static_cast<float>(difference - static_cast<float>(difference)));
  const auto power = hn::MulAdd(hn::Mul(r.y, rest), hn::Exp(d, exponent), hn::Exp(d, exponent));
  const auto denominator = hn::Expm1(d, hn::Mul(r.y, hn::Set(d, static_cast<float>(-reciprocal))));
  return hn::Div(hn::Mul(power, r.numerator), denominator);
}

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::cpu
HWY_AFTER_NAMESPACE();

#endif
