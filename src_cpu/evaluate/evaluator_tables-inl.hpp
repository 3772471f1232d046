// Dense rows from tables, mixtures and bands, a vector of channels at a time;
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

inline constexpr std::size_t kVectorChannels = hn::MaxLanes(Tag());

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
  for (std::size_t k = 0; k < count; k += kVectorChannels) {
    const Position low = locate(table, lambda_nm + k);
    const Position high = locate(table, lambda_nm + k + kVectorChannels / 2);
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

inline void sample_double(const DoubleTable& table, const double* lambda_nm, std::size_t count, double* out) {
  const std::size_t n = hn::Lanes(kDoubleTag), end = (count + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
  for (std::size_t k = 0; k < end; k += n)
    hn::StoreU(exact_value(table, hn::LoadU(kDoubleTag, lambda_nm + k)), kDoubleTag, out + k);
}

/// V vectors of a weighted sum, from i on.
template <std::size_t V>
HWY_INLINE void sum_rows(const float* const* row, const float* weights, std::size_t rows, std::size_t i,
                         float* out) {
  constexpr std::make_index_sequence<V> kEach;
  Floats sum[V];
  unrolled([&](auto v) HWY_ATTR { sum[v] = hn::Zero(kTag); }, kEach);
  for (std::size_t r = 0; r < rows; ++r) {
    const Floats weight = constant(weights[r]);
    const float* const from = row[r] + i;
    unrolled([&](auto v) HWY_ATTR { sum[v] = hn::MulAdd(weight, load(from, v * kVectorChannels), sum[v]); },
             kEach);
  }
  unrolled([&](auto v) HWY_ATTR { hn::StoreU(sum[v], kTag, out + i + v * kVectorChannels); }, kEach);
}

/// Four vectors at a time: of one, the loop over its rows takes longer than they do.
inline void weighted_sum(const float* const* row, const float* weights, std::size_t rows, std::size_t count,
                         float* out) {
  std::size_t i = 0;
  for (; i + 4 * kVectorChannels <= count; i += 4 * kVectorChannels) sum_rows<4>(row, weights, rows, i, out);
  for (; i + kVectorChannels <= count; i += kVectorChannels) sum_rows<1>(row, weights, rows, i, out);
  for (; i < count; ++i) {
    float sum = 0;
    for (std::size_t r = 0; r < rows; ++r) sum += weights[r] * row[r][i];
    out[i] = sum;
  }
}

inline void mix_bands(const float* values, const int32_t* index, const float* first, const float* second,
                      std::size_t count, float* out) {
  const hn::RebindToSigned<Tag> index_tag;
  for (std::size_t i = 0; i < count; i += kVectorChannels) {
    const auto at = hn::LoadU(index_tag, index + i);
    const Floats a = hn::GatherIndex(kTag, values, at), b = hn::GatherIndex(kTag, values + 1, at);
    hn::StoreU(hn::MulAdd(load(second, i), b, hn::Mul(load(first, i), a)), kTag, out + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::cpu
HWY_AFTER_NAMESPACE();

#endif
