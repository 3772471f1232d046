// Vertices of gas (KB_KIND_MEDIUM of shared/path_vertex.h) for a block of channels;
// compiled once per instruction set.
//
// No include guard of the usual kind: see evaluator_optics-inl.hpp.
#if defined(KILOBAND_EVALUATOR_GAS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_EVALUATOR_GAS_INL
#undef KILOBAND_EVALUATOR_GAS_INL
#else
#define KILOBAND_EVALUATOR_GAS_INL
#endif

#include <numbers>

#include "src_cpu/evaluate/evaluator_optics-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kiloband::cpu {
namespace HWY_NAMESPACE {

/// exp(-x) and 1 - exp(-x), which keeps its relative accuracy for thin gas. Of x = n ln 2 - r, |r| <= ln 2 / 2, both are
///   e^-x = 2^-n (1 + p),  1 - e^-x = (1 - 2^-n) - 2^-n p
/// with one p = e^r - 1, Taylor's polynomial of degree 7 (the next term is 1.5e-8 of p there).
struct Absorbed {
  Floats passes, stays;
};
/// x: no NaN; >= 0, or negative by rounding
HWY_INLINE Absorbed absorbed(Floats x) {
  const hn::RebindToSigned<Tag> words;
  const Floats depth = hn::Min(x, constant(104));  // beyond which floats have no e^-x
  const Floats turns = hn::Round(hn::Mul(depth, constant(std::numbers::log2e_v<float>)));
  constexpr float kHigh = 0.693359375f;  // few bits, so that its product is exact
  constexpr auto kLow = static_cast<float>(std::numbers::ln2 - kHigh);
  const Floats r = hn::MulAdd(turns, constant(kLow), hn::MulSub(turns, constant(kHigh), depth));
  Floats p = hn::MulAdd(r, constant(1.0f / 5040), constant(1.0f / 720));
  p = hn::MulAdd(r, p, constant(1.0f / 120));
  p = hn::MulAdd(r, p, constant(1.0f / 24));
  p = hn::MulAdd(r, p, constant(1.0f / 6));
  p = hn::MulAdd(r, p, constant(0.5f));
  p = hn::MulAdd(hn::Mul(r, r), p, r);
  // Floats have no 2^-150: two factors.
  const auto n = hn::ConvertTo(words, turns), half = hn::ShiftRight<1>(n), bias = hn::Set(words, 127);
  const Floats first = hn::BitCast(kTag, hn::ShiftLeft<23>(hn::Sub(bias, half)));
  const Floats second = hn::BitCast(kTag, hn::ShiftLeft<23>(hn::Sub(bias, hn::Sub(n, half))));
  const Floats power = hn::Mul(first, second);
  return {hn::Mul(hn::MulAdd(first, p, first), second), hn::NegMulAdd(power, p, hn::Sub(constant(1), power))};
}

/// B(T) / B(T_r) at T <= T_r with y = hc / (k lambda) in kelvin:
///   (e^(y/T_r) - 1) / (e^(y/T) - 1) = p (1 - e^(-y/T_r)) / (1 - e^(-y/T)),  p = exp(-y (1/T - 1/T_r)).
/// What the float range holds of it has y (1/T - 1/T_r) < 104, however large y / T is: the exponent is formed
/// from the difference of the reciprocals (taken in double), so its relative rounding, 3 * 2^-25 at most (y,
/// the product's two parts), comes to 1e-5 of the ratio at the bottom of the range and to 1e-6 where the
/// ratio is above 1e-4. In the denominator e^(-y/T) is p e^(-y/T_r) where y / T > 0.5: p's own rounding counts
/// e^(-y/T) / (1 - e^(-y/T)) times more, 1.54 at most there, which adds 4e-7.
struct PlanckReference {
  double reciprocal;      // 1 / T_r
  Floats y;               // K
  Absorbed at_reference;  // of y / T_r
};

HWY_INLINE PlanckReference planck_reference(Floats y, double reference_k) {
  const double reciprocal = 1 / reference_k;
  return {reciprocal, y, absorbed(hn::Mul(y, constant(static_cast<float>(reciprocal))))};
}

HWY_INLINE Floats planck_ratio(const PlanckReference& r, double temperature_k) {
  const double reciprocal = 1 / temperature_k, difference = reciprocal - r.reciprocal;
  const Floats power = absorbed(hn::Mul(r.y, constant(static_cast<float>(difference)))).passes;
  // The rounding of `difference` to float, put back.
  const Floats rest = hn::Mul(r.y, constant(static_cast<float>(difference - static_cast<float>(difference))));
  const Floats p = hn::NegMulAdd(rest, power, power);
  const Floats exponent = hn::Mul(r.y, constant(static_cast<float>(reciprocal)));
  Floats denominator = hn::NegMulAdd(p, r.at_reference.passes, constant(1));
  // Each channel by itself: its bits do not depend on the others.
  const auto apart = hn::Gt(exponent, constant(0.5f));
  if (!hn::AllTrue(kTag, apart)) denominator = hn::IfThenElse(apart, denominator, absorbed(exponent).stays);
  return hn::Div(hn::Mul(p, r.at_reference.stays), denominator);
}

/// (1 - e^-x (1 + x)) / x, what the far end of a cell contributes. Below 0.5, where the closed form cancels,
/// its series x / 2 - x^2 / 3 + x^3 / 8 - x^4 / 30 + x^5 / 144 - ..., with coefficients (-1)^n (n - 1) / n!
/// (the series' next term is 4e-7 of the sum there).
HWY_INLINE Floats far_share(Floats x, const Absorbed& a) {
  Floats series = hn::MulAdd(x, constant(1.0f / 5760), constant(-1.0f / 840));
  series = hn::MulAdd(x, series, constant(1.0f / 144));
  series = hn::MulAdd(x, series, constant(-1.0f / 30));
  series = hn::MulAdd(x, series, constant(1.0f / 8));
  series = hn::MulAdd(x, series, constant(-1.0f / 3));
  series = hn::Mul(x, hn::MulAdd(x, series, constant(0.5f)));
  const Floats closed = hn::Div(hn::NegMulAdd(x, a.passes, a.stays), hn::Max(x, constant(0.25f)));
  return hn::IfThenElse(hn::Lt(x, constant(0.5f)), series, closed);
}

/// The cells of a plume, from near to far. `scale`: what stands before the sum;
/// tau is multiplied by the transmittance.
HWY_INLINE Floats plume_radiance(const GasVertex& v, Floats scale, std::size_t k, Floats& tau) {
  const Floats kappa = hn::LoadU(kTag, v.a + k), reference = hn::LoadU(kTag, v.emit + k);
  const PlanckReference planck = planck_reference(hn::LoadU(kTag, v.second_k + k), v.reference_k);
  Floats near = planck_ratio(planck, v.cells.front().temperature_k), sum = hn::Zero(kTag);
  Floats passed = constant(1);
  for (std::size_t i = 1; i < v.cells.size(); ++i) {
    const Floats far = planck_ratio(planck, v.cells[i].temperature_k);
    const Floats x = hn::Mul(kappa, constant(v.cells[i].column));
    const Absorbed a = absorbed(x);
    const Floats source = hn::MulAdd(far_share(x, a), hn::Sub(far, near), hn::Mul(a.stays, near));
    sum = hn::MulAdd(passed, source, sum);
    passed = hn::Mul(passed, a.passes);
    near = far;
  }
  tau = hn::Mul(tau, passed);
  return hn::Mul(hn::Mul(scale, reference), sum);
}

/// tau, radiance, aside: a vector each.
HWY_INLINE void medium_vector(const GasVertex& v, std::size_t k, float* tau, float* radiance, float* aside) {
  const Floats kappa = hn::LoadU(kTag, v.a + k);
  Floats t = hn::Load(kTag, tau), l = hn::Load(kTag, radiance), q = hn::Load(kTag, aside);
  if (v.flags & KB_VERTEX_NEE) {
    q = hn::Mul(q, absorbed(hn::Mul(kappa, constant(v.nee0))).passes);
    if (!(v.flags & KB_VERTEX_DEFER)) {
      l = hn::Add(l, q);
      q = constant(1);
    }
  } else if (v.flags & KB_VERTEX_DEFER) {
    q = absorbed(hn::Mul(kappa, constant(v.scatter0))).passes;
  } else if (!v.cells.empty()) {
    const Floats scale = hn::Mul(hn::Mul(t, q), constant(v.emit_weight));
    l = hn::Add(l, plume_radiance(v, scale, k, t));
    q = constant(1);
  } else {
    const Absorbed a = absorbed(hn::Mul(kappa, constant(v.scatter0)));
    if (v.flags & KB_VERTEX_EMIT) {
      const Floats emitted = hn::Mul(hn::Mul(q, constant(v.emit_weight)), hn::LoadU(kTag, v.emit + k));
      l = hn::MulAdd(hn::Mul(t, a.stays), emitted, l);
      q = constant(1);
    }
    if (v.flags & KB_VERTEX_SCATTER) t = hn::Mul(t, a.passes);
  }
  hn::Store(t, kTag, tau);
  hn::Store(l, kTag, radiance);
  hn::Store(q, kTag, aside);
}

/// One vertex for `lanes` channels from k on, a multiple of a vector's.
HWY_NOINLINE void gas_step(const GasVertex& v, std::size_t k, std::size_t lanes, float* tau, float* radiance,
                           float* aside) {
  for (std::size_t i = 0; i < lanes; i += hn::Lanes(kTag)) {
    if (v.of == GasVertex::Of::kMedium) {
      medium_vector(v, k + i, tau + i, radiance + i, aside + i);
      continue;
    }
    const Floats factor = hn::Mul(constant(v.emit_weight), hn::LoadU(kTag, v.a + k + i));
    const Floats light = hn::LoadU(kTag, v.emit + k + i);
    hn::Store(hn::Mul(hn::Mul(hn::Load(kTag, tau + i), factor), light), kTag, aside + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::cpu
HWY_AFTER_NAMESPACE();

#endif
