// Dense rows from tables, mixtures, bands and colours, a vector of channels at a time;
// compiled once per instruction set.
//
// No include guard of the usual kind: evaluator_kernels.cpp includes itself, and this file, once per target.
#if defined(KILOBAND_EVALUATOR_TABLES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_EVALUATOR_TABLES_INL
#undef KILOBAND_EVALUATOR_TABLES_INL
#else
#define KILOBAND_EVALUATOR_TABLES_INL
#endif

#include "src_cpu/evaluate/evaluator_optics-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kiloband::cpu {
namespace HWY_NAMESPACE {

inline constexpr std::size_t kLanes = hn::MaxLanes(Tag());

HWY_INLINE Floats load(const float* row, std::size_t k) {
  return hn::LoadU(kTag, row + k);
}

/// Positions in a table, as half vectors: entry, and the weights of it and the next.
/// Both weights are 0 outside.
struct Position {
  hn::Vec<hn::Rebind<int32_t, DoubleTag>> index;
  hn::Vec<HalfTag> first, second;
};

HWY_INLINE Position locate(const FloatTable& table, const double* lambda_nm) {
  const double last = static_cast<double>(table.size - 1);
  const Doubles raw = hn::Mul(hn::Sub(hn::LoadU(kDoubleTag, lambda_nm), hn::Set(kDoubleTag, table.min_nm)),
                              hn::Set(kDoubleTag, 1 / table.step_nm));
  const Doubles zero = hn::Zero(kDoubleTag);
  // The last entry's wavelength may round to a hair beyond it.
  const auto within = hn::And(hn::Ge(raw, zero), hn::Le(raw, hn::Set(kDoubleTag, last * (1 + 1e-12))));
  const Doubles position = hn::Min(hn::Max(raw, zero), hn::Set(kDoubleTag, last));
  const Doubles index = hn::Min(hn::Floor(position), hn::Set(kDoubleTag, last - 1));
  const Doubles one = hn::Set(kDoubleTag, 1.0);
  const Doubles inside = table.extrapolate ? one : hn::IfThenElseZero(within, one);
  // Both weights are rounded from double: a steep spectrum keeps its relative precision near zero.
  const Doubles second = hn::Mul(hn::Sub(position, index), inside);
  return {hn::DemoteTo(hn::Rebind<int32_t, DoubleTag>(), index),
          hn::DemoteTo(HalfTag(), hn::Sub(inside, second)), hn::DemoteTo(HalfTag(), second)};
}

inline void sample_table(const FloatTable& table, const double* lambda_nm, std::size_t count, float* out) {
  const hn::RebindToSigned<Tag> index_tag;
  for (std::size_t k = 0; k < count; k += kLanes) {
    const Position low = locate(table, lambda_nm + k);
    const Position high = locate(table, lambda_nm + k + kLanes / 2);
    const auto index = hn::Combine(index_tag, high.index, low.index);
    const Floats a = hn::GatherIndex(kTag, table.values, index);
    const Floats b = hn::GatherIndex(kTag, table.values + 1, index);
    const Floats value = hn::MulAdd(hn::Combine(kTag, high.second, low.second), b,
                                    hn::Mul(hn::Combine(kTag, high.first, low.first), a));
    hn::StoreU(value, kTag, out + k);
  }
}

/// RegularTable::operator(), operation by operation.
HWY_INLINE Doubles exact_value(const DoubleTable& table, Doubles lambda_nm) {
  const hn::RebindToSigned<DoubleTag> index_tag;
  const double last = static_cast<double>(table.size - 1);
  const Doubles position =
      hn::Div(hn::Sub(lambda_nm, hn::Set(kDoubleTag, table.min_nm)), hn::Set(kDoubleTag, table.step_nm));
  const auto starts = hn::Ge(position, hn::Zero(kDoubleTag)),
             ends = hn::Ge(position, hn::Set(kDoubleTag, last));
  const Doubles index =
      hn::Min(hn::Floor(hn::IfThenElseZero(starts, position)), hn::Set(kDoubleTag, last - 1));
  const auto entry = hn::ConvertTo(index_tag, index);
  const Doubles t = hn::Sub(position, index), rest = hn::Sub(hn::Set(kDoubleTag, 1.0), t);
  const Doubles inner = hn::Add(hn::Mul(rest, hn::GatherIndex(kDoubleTag, table.values, entry)),
                                hn::Mul(t, hn::GatherIndex(kDoubleTag, table.values + 1, entry)));
  const double front = table.extrapolate ? table.values[0] : 0;
  const double back = table.values[table.size - 1], beyond = table.extrapolate ? back : 0;
  const auto kept = hn::Le(position, hn::Set(kDoubleTag, last * (1 + 1e-12)));
  const Doubles end = hn::IfThenElse(kept, hn::Set(kDoubleTag, back), hn::Set(kDoubleTag, beyond));
  return hn::IfThenElse(starts, hn::IfThenElse(ends, end, inner), hn::Set(kDoubleTag, front));
}

inline void sample_exact(const DoubleTable& table, const double* lambda_nm, const double* factor,
                         std::size_t count, float* out) {
  const std::size_t n = hn::Lanes(kDoubleTag), end = (count + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
  for (std::size_t k = 0; k < end; k += n) {
    Doubles value = exact_value(table, hn::LoadU(kDoubleTag, lambda_nm + k));
    if (factor) value = hn::Mul(value, hn::LoadU(kDoubleTag, factor + k));
    hn::StoreU(hn::DemoteTo(HalfTag(), value), HalfTag(), out + k);
  }
}

inline void weighted_sum(const float* const* row, const float* weights, std::size_t rows, std::size_t count,
                         float* out) {
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    Floats sum = hn::Zero(kTag);
    for (std::size_t r = 0; r < rows; ++r) sum = hn::MulAdd(constant(weights[r]), load(row[r], i), sum);
    hn::StoreU(sum, kTag, out + i);
  }
  for (; i < count; ++i) {
    float sum = 0;
    for (std::size_t r = 0; r < rows; ++r) sum += weights[r] * row[r][i];
    out[i] = sum;
  }
}

inline void mix_bands(const float* values, const int32_t* index, const float* first, const float* second,
                      std::size_t count, float* out) {
  const hn::RebindToSigned<Tag> index_tag;
  for (std::size_t i = 0; i < count; i += kLanes) {
    const auto at = hn::LoadU(index_tag, index + i);
    const Floats a = hn::GatherIndex(kTag, values, at), b = hn::GatherIndex(kTag, values + 1, at);
    hn::StoreU(hn::MulAdd(load(second, i), b, hn::Mul(load(first, i), a)), kTag, out + i);
  }
}

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
