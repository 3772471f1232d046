// Elementary functions of each lane, of additions, multiplications, divisions and square roots alone, so that every
// number of lanes gives the same bits; the standard library's would differ from machine to machine besides.
//
// The coefficients are fits of least maximal error (iteratively reweighted least squares at 4000 Chebyshev nodes) of
// what stands beside them; the errors stated are those that tests/unit/src_cpu/lanes measures.
//
// For one lane or a vector of them: see one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_LANE_MATH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_LANE_MATH_INL
#undef KILOBAND_LANE_MATH_INL
#else
#define KILOBAND_LANE_MATH_INL
#endif

#include "shared/lang.h"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// c0 + x (c1 + x (c2 + ...))
KB_INLINE F polynomial(F, float c) {
  return F(c);
}
template <class... Rest>
KB_INLINE F polynomial(F x, float c, Rest... rest) {
  return F(c) + x * polynomial(x, rest...);
}

/// e^x. Relative error below 1.5e-7 where it is no denormal; no larger than e^88 above 88.
KB_INLINE F exp(F x) {
  const F clamped = min(F(88.0f), max(F(-104.0f), x));
  const F n = floor(clamped * F(1.44269504f) + F(0.5f));
  // ln 2 in two parts, the first of which has few enough bits that n times it is exact.
  const F r = (clamped - n * F(0.693359375f)) - n * F(-2.12194440e-4f);
  // (e^r - 1 - r) / r^2 for |r| <= ln(2) / 2
  const F p = polynomial(r, 0.49999994f, 0.16666521f, 0.04166839f, 0.008368726f, 0.0013814579f);
  const F e = F(1) + (r + r * r * p);
  // Small ones in two steps, the second of which rounds to a denormal or, at e^-104, to 0.
  const M small = n < F(-100);
  const F power = as_floats(shift_left<23>(to_words(select(small, n + F(64), n)) + U(127u)));
  return e * power * select(small, F(0x1p-64f), F(1));
}

/// ln x of x > 0 that is no denormal. Relative error below 2e-7.
KB_INLINE F log(F x) {
  // x = 2^n m with m in [sqrt(1/2), sqrt(2))
  const U bits = as_words(x) - U(0x3f3504f3u);
  const F n = to_floats(shift_right<23>(bits + U(0x40000000u)) - U(128u));
  const F z = as_floats((bits & U(0x007fffffu)) + U(0x3f3504f3u)) - F(1);
  // (ln(1 + z) - z + z^2 / 2) / z^3
  const F p = polynomial(z, 0.33333313f, -0.2500001f, 0.2000212f, -0.16667996f, 0.14219551f, -0.12405591f,
                         0.11888175f, -0.11675641f, 0.067466013f);
  const F z2 = z * z;
  return (z - (F(0.5f) * z2 - z * z2 * p) + n * F(-2.12194440e-4f)) + n * F(0.693359375f);
}

/// Error function of x >= 0. Relative error below 3e-7.
KB_INLINE F erf_positive(F x) {
  const F x2 = x * x;
  // erf(x) / x in x^2, for x <= 1
  const F near = x * polynomial(x2, 1.1283791f, -0.37612626f, 0.11283585f, -0.02685381f, 0.0051883277f,
                                -0.000801019f, 7.853858e-05f);
  // -ln(1 - erf(x)), for 0.95 <= x <= 4; 1 - erf(4) = 1.5e-8
  const F t = min(x, F(4));
  const F far = F(1) - exp(-polynomial(t, -0.00018344415f, 1.1295568f, 0.63326263f, 0.10837248f,
                                       -0.025178967f, 0.004193611f, -0.00043910637f, 2.1496115e-05f));
  return select(x < F(1), near, far);
}

/// The inverse of erf on (-1, 1): kb_erf_inv() of shared/filter_sample.h, where source and error are stated.
KB_INLINE F erf_inverse(F x) {
  const F inside = min(F(KB_ONE_MINUS_EPSILON), max(F(-KB_ONE_MINUS_EPSILON), x));
  const F w = -log((F(1) - inside) * (F(1) + inside));
  const F central =
      polynomial(w - F(2.5f), 1.50140941f, 0.246640727f, -0.00417768164f, -0.00125372503f, 0.00021858087f,
                 -4.39150654e-06f, -3.5233877e-06f, 3.43273939e-07f, 2.81022636e-08f);
  const F tail =
      polynomial(sqrt(max(w, F(5))) - F(3), 2.83297682f, 1.00167406f, 0.00943887047f, -0.0076224613f,
                 0.00573950773f, -0.00367342844f, 0.00134934322f, 0.000100950558f, -0.000200214257f);
  return select(w < F(5), central, tail) * inside;
}

/// Sine and cosine of |x| <= pi / 4. Errors below 1e-7.
struct SinCos {
  F sin, cos;
};
KB_INLINE SinCos sin_cos_of_eighth(F x) {
  const F x2 = x * x;
  return {x * polynomial(x2, 1.0f, -0.16666667f, 0.008333329f, -0.00019839204f, 2.7173533e-06f),
          polynomial(x2, 1.0f, -0.5f, 0.041666616f, -0.0013886619f, 2.437993e-05f)};
}

/// Sine and cosine of 2 pi turns, for turns in [0, 2]. Absolute error below 3e-7.
KB_INLINE SinCos sin_cos_of_turns(F turns) {
  const F quarter = floor(F(4) * turns + F(0.5f));
  const SinCos r = sin_cos_of_eighth((turns - F(0.25f) * quarter) * F(2 * KB_PI));
  const U q = to_words(quarter);
  const M odd = has_bits(q, 1u);
  const F s = select(odd, r.cos, r.sin), c = select(odd, r.sin, r.cos);
  return {select(has_bits(q, 2u), -s, s), select(has_bits(q + U(1u), 2u), -c, c)};
}

/// The angle of (x, y) in (-pi, pi]; 0 of the origin. Absolute error below 4e-7.
KB_INLINE F arc_tangent(F y, F x) {
  const F ax = abs(x), ay = abs(y);
  const M steep = ay > ax;
  const F ratio = select(steep, ax, ay) / max(max(ax, ay), F(1e-37f));
  // atan(r) / r in r^2, for r <= 1
  const F r2 = ratio * ratio;
  const F angle = ratio * polynomial(r2, 1.0f, -0.33333072f, 0.1999262f, -0.14203642f, 0.10640924f,
                                     -0.07504274f, 0.042691275f, -0.016068479f, 0.002849852f);
  const F first = select(steep, F(0.5f * KB_PI) - angle, angle);
  return copysign(select(x < F(0), F(KB_PI) - first, first), y);
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
