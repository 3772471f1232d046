// Dense rows from colours, a vector of channels at a time; compiled once per instruction set.
//
// No include guard of the usual kind: evaluator_kernels.cpp includes itself, and this file, once per target.
#if defined(KILOBAND_EVALUATOR_COLOURS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_EVALUATOR_COLOURS_INL
#undef KILOBAND_EVALUATOR_COLOURS_INL
#else
#define KILOBAND_EVALUATOR_COLOURS_INL
#endif

#include "src_cpu/evaluate/evaluator_tables-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kiloband::cpu {
namespace HWY_NAMESPACE {

/// Divisors of tails are at most this, so that a product of four is finite: S below 2.4e-10 counts as that.
inline constexpr float kLargestDivisor = 0x1p31f;

struct Quotient {
  Floats numerator, divisor;
};

HWY_INLINE Quotient sum_of(const Quotient& a, const Quotient& b) {
  return {hn::MulAdd(a.numerator, b.divisor, hn::Mul(b.numerator, a.divisor)), hn::Mul(a.divisor, b.divisor)};
}

/// w S(v) of term i, S(v) = 1/2 + v / (2 sqrt(1 + v^2)), v its parabola at y. For v < 0 the difference is expanded:
/// S(-|v|) = 1 / (2 r (r + |v|)), r^2 = 1 + v^2, which keeps relative precision where S is small; S(|v|) = 1 - S(-|v|).
/// Returns the quotient, and adds the 1 to `whole`.
HWY_INLINE Quotient tail(const ColourTerms& terms, std::size_t i, Floats y, Floats& whole) {
  const float(&c)[3] = terms.coefficients[i];
  const Floats v = hn::MulAdd(hn::MulAdd(constant(c[0]), y, constant(c[1])), y, constant(c[2]));
  const Floats r = hn::Sqrt(hn::MulAdd(v, v, constant(1)));
  const Floats divisor = hn::Mul(r, hn::Add(r, hn::Abs(v)));
  const Floats half = constant(0.5f * terms.weights[i]);
  const Floats numerator = hn::Xor(half, hn::AndNot(v, hn::SignBit(kTag)));  // -half where v >= 0
  whole = hn::Add(whole, hn::Sub(half, numerator));
  return {numerator, hn::Min(constant(kLargestDivisor), divisor)};  // in this order: not a number stays that
}

/// Roots and divisions share a unit (10 and 6 cycles for 16 lanes on Zen 4, where all else takes 1): one division for all terms.
HWY_INLINE Floats colour_at(const ColourTerms& terms, Floats y) {
  static_assert(ColourTerms::kMost == 4);
  Floats whole = constant(terms.constant);
  if (terms.count == 0) return whole;
  Quotient sum = sum_of(tail(terms, 0, y, whole), tail(terms, 1, y, whole));
  if (terms.count > 2) sum = sum_of(sum, sum_of(tail(terms, 2, y, whole), tail(terms, 3, y, whole)));
  return hn::Add(whole, hn::Div(sum.numerator, sum.divisor));
}

/// A whole row at a time: where the next vertex follows after a block of channels, the unit waits for what depends on it.
inline void colour_row(const ColourTerms& terms, const ColourOffsets& offsets, std::size_t count,
                       float* out) {
  const auto store = [&](Floats value, std::size_t k) {
    hn::StoreU(terms.factor ? hn::Mul(value, load(terms.factor, k)) : value, kTag, out + k);
  };
  std::size_t k = 0;
  for (; k < offsets.distinct; k += kLanes) store(colour_at(terms, load(offsets.nm, k)), k);
  if (k >= count) return;
  const Floats last = colour_at(terms, load(offsets.nm, k));
  for (; k < count; k += kLanes) store(last, k);
}

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::cpu
HWY_AFTER_NAMESPACE();

#endif
