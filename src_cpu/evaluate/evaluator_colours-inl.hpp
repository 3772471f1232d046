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

using Whole = hn::Vec<hn::RebindToSigned<Tag>>;

/// Polynomials of a lookup in its cells.
struct ColourFit {
  static constexpr std::size_t kStride = ColourCells::kMost + kMaxLanes;
  alignas(64) float coefficients[ColourCells::kNodes][kStride];  // of t^j
  alignas(64) int32_t smooth[kStride];                           // 0: the polynomial is not accurate
};

/// A vector of cells: 1 where the polynomial is accurate, else 0. S(v) has branch points at v = +-i. If v(y) keeps away from them for all
/// complex y within R = kReach half widths of the centre, which it does if |v'| R + |a| R^2 < |v +- i| at the centre, S is analytic in
/// an ellipse about the cell whose semi-axes add up to 7.9 half widths, and coefficients fall as 7.9^-n (Trefethen, Approximation Theory
/// and Approximation Practice, theorems 8.1 and 8.2). Of colours of pictures four cells in five pass, with a relative error of 6e-7 at
/// most; of parabolas 1.6e-6: far from the branch points and dark, S ~ 1 / (4 v^2).
HWY_INLINE Whole smooth_cells(const ColourTerms& terms, Floats centre) {
  constexpr float kReach = 4, kRadius = kReach * static_cast<float>(ColourCells::kWidthNm / 2);
  auto smooth = hn::Eq(centre, centre);
  for (uint32_t i = 0; i < terms.count; ++i) {
    const float(&c)[3] = terms.coefficients[i];
    const Floats v = hn::MulAdd(hn::MulAdd(constant(c[0]), centre, constant(c[1])), centre, constant(c[2]));
    const Floats slope = hn::MulAdd(constant(2 * c[0]), centre, constant(c[1]));
    const Floats moved =
        hn::MulAdd(hn::Abs(slope), constant(kRadius), constant(std::abs(c[0]) * kRadius * kRadius));
    const auto within = hn::Lt(square(moved), hn::MulAdd(v, v, constant(1)));
    smooth = hn::And(smooth, within);
  }
  const hn::RebindToSigned<Tag> tag;
  return hn::IfThenElseZero(hn::RebindMask(tag, smooth), hn::Set(tag, 1));
}

/// Coefficients of t^j from the values at the 8 nodes, cells in lanes: those of Chebyshev's polynomials first, which fall off, so that
/// their large numbers meet small ones.
HWY_INLINE void fit_cells(const Floats (&f)[ColourCells::kNodes], ColourFit& fit, std::size_t c) {
  // cos(j pi / 16)
  constexpr float k1 = 0.98078528f, k2 = 0.92387953f, k3 = 0.83146961f, k4 = 0.70710678f, k5 = 0.55557023f,
                  k6 = 0.38268343f, k7 = 0.19509032f;
  Floats p[4], m[4];
  for (std::size_t n = 0; n < 4; ++n) {
    p[n] = hn::Mul(constant(0.25f), hn::Add(f[n], f[7 - n]));
    m[n] = hn::Mul(constant(0.25f), hn::Sub(f[n], f[7 - n]));
  }
  const Floats outer = hn::Sub(p[0], p[3]), inner = hn::Sub(p[1], p[2]);
  const Floats ends = hn::Add(p[0], p[3]), middle = hn::Add(p[1], p[2]);
  const auto sum = [](float a, Floats x, float b, Floats y)
                       HWY_ATTR { return hn::MulAdd(constant(a), x, hn::Mul(constant(b), y)); };
  const auto odd = [&](float a, float b, float g, float d)
                       HWY_ATTR { return hn::Add(sum(a, m[0], b, m[1]), sum(g, m[2], d, m[3])); };
  const Floats c0 = sum(0.5f, ends, 0.5f, middle), c2 = sum(k2, outer, k6, inner);
  const Floats c4 = sum(k4, ends, -k4, middle), c6 = sum(k6, outer, -k2, inner);
  const Floats c1 = odd(k1, k3, k5, k7), c3 = odd(k3, -k7, -k1, -k5);
  const Floats c5 = odd(k5, -k1, k7, k3), c7 = odd(k7, -k5, k3, -k1);
  const Floats of_t[ColourCells::kNodes] = {hn::Add(hn::Sub(c0, c2), hn::Sub(c4, c6)),
                                            hn::Add(sum(-3, c3, 5, c5), hn::MulAdd(constant(-7), c7, c1)),
                                            hn::MulAdd(constant(18), c6, sum(2, c2, -8, c4)),
                                            hn::MulAdd(constant(56), c7, sum(4, c3, -20, c5)),
                                            sum(8, c4, -48, c6),
                                            sum(16, c5, -112, c7),
                                            hn::Mul(constant(32), c6),
                                            hn::Mul(constant(64), c7)};
  for (std::size_t j = 0; j < ColourCells::kNodes; ++j) hn::StoreU(of_t[j], kTag, &fit.coefficients[j][c]);
}

HWY_INLINE void fit_colour(const ColourTerms& terms, const ColourCells& cells, ColourFit& fit) {
  // Of few cells, the nodes of several share a vector.
  constexpr std::size_t kFew = 4;
  alignas(64) float values[ColourCells::kNodes * kFew + 2 * kMaxLanes];
  const bool few = cells.count <= kFew;
  if (few) {
    const std::size_t count = ColourCells::kNodes * cells.count;
    for (std::size_t i = 0; i < count; i += kVectorChannels)
      hn::Store(colour_at(terms, load(cells.nodes, i)), kTag, values + i);
    std::fill_n(values + count, kMaxLanes, 0.0f);  // read in lanes that have no cell
  }
  for (std::size_t c = 0; c < cells.count; c += kVectorChannels) {
    hn::StoreU(smooth_cells(terms, load(cells.centres, c)), hn::RebindToSigned<Tag>(), fit.smooth + c);
    Floats f[ColourCells::kNodes];
    for (std::size_t n = 0; n < ColourCells::kNodes; ++n) {
      const std::size_t first = n * cells.count + c;
      f[n] = few ? load(values, first) : colour_at(terms, load(cells.nodes, first));
    }
    fit_cells(f, fit, c);
  }
  fit.smooth[ColourCells::kAlone] = 0;
}

/// By pairs, fours and eights: of a chain of seven, the unit would wait for each.
HWY_INLINE Floats polynomial(const ColourFit& fit, int32_t cell, Floats t) {
  static_assert(ColourCells::kNodes == 8);
  const auto a = [&](std::size_t j) HWY_ATTR { return constant(fit.coefficients[j][cell]); };
  const Floats t2 = square(t), t4 = square(t2);
  const Floats low = hn::MulAdd(hn::MulAdd(a(3), t, a(2)), t2, hn::MulAdd(a(1), t, a(0)));
  const Floats high = hn::MulAdd(hn::MulAdd(a(7), t, a(6)), t2, hn::MulAdd(a(5), t, a(4)));
  return hn::MulAdd(high, t4, low);
}

/// Channels from k on that are in several cells, or alone.
HWY_NOINLINE Floats mixed_colour(const ColourTerms& terms, const ColourOffsets& offsets, const ColourFit& fit,
                                 std::size_t k) {
  const hn::RebindToSigned<Tag> tag;
  const Floats t = load(offsets.cells->place, k);
  const auto cells = hn::LoadU(tag, offsets.cells->cell + k);
  auto left = hn::Eq(cells, cells);
  Floats value = hn::Zero(kTag), alone = value;
  bool has_alone = false;
  while (!hn::AllFalse(tag, left)) {
    const int32_t cell = offsets.cells->cell[k + hn::FindKnownFirstTrue(tag, left)];
    const auto mine = hn::And(left, hn::Eq(cells, hn::Set(tag, cell)));
    Floats part;
    if (fit.smooth[cell]) {
      part = polynomial(fit, cell, t);
    } else {
      if (!has_alone) alone = colour_at(terms, load(offsets.nm, k));
      has_alone = true;
      part = alone;
    }
    value = hn::IfThenElse(hn::RebindMask(kTag, mine), part, value);
    left = hn::AndNot(mine, left);
  }
  return value;
}

/// A whole row at a time: where the next vertex follows after a block of channels, the unit waits for what depends on it.
template <class At>
HWY_INLINE void fill_row(const ColourTerms& terms, const ColourOffsets& offsets, std::size_t count,
                         float* out, const At& at) {
  const auto store = [&](Floats value, std::size_t k) HWY_ATTR {
    hn::StoreU(terms.factor ? hn::Mul(value, load(terms.factor, k)) : value, kTag, out + k);
  };
  std::size_t k = 0;
  for (; k < offsets.distinct; k += kVectorChannels) store(at(k), k);
  if (k >= count) return;
  const Floats last = at(k);
  for (; k < count; k += kVectorChannels) store(last, k);
}

inline void colour_row(const ColourTerms& terms, const ColourOffsets& offsets, std::size_t count,
                       float* out) {
  if (!offsets.cells || terms.count == 0) {
    fill_row(terms, offsets, count, out,
             [&](std::size_t k) HWY_ATTR { return colour_at(terms, load(offsets.nm, k)); });
    return;
  }
  ColourFit fit;
  fit_colour(terms, *offsets.cells, fit);
  const int32_t* const cell = offsets.cells->cell;
  const hn::RebindToSigned<Tag> tag;
  fill_row(
      terms, offsets, count, out, [&](std::size_t k) HWY_ATTR __attribute__((always_inline)) {
        // In increasing order, channels of a vector are mostly in one cell or two.
        const int32_t first = cell[k], last = cell[k + kVectorChannels - 1];
        const auto cells = hn::LoadU(tag, cell + k);
        const auto in_first = hn::Eq(cells, hn::Set(tag, first)), in_last = hn::Eq(cells, hn::Set(tag, last));
        if (HWY_UNLIKELY(!hn::AllTrue(tag, hn::Or(in_first, in_last)) || !fit.smooth[first] ||
                         !fit.smooth[last]))
          return mixed_colour(terms, offsets, fit, k);
        const Floats t = load(offsets.cells->place, k), value = polynomial(fit, first, t);
        if (first == last) return value;
        return hn::IfThenElse(hn::RebindMask(kTag, in_first), value, polynomial(fit, last, t));
      });
}

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::cpu
HWY_AFTER_NAMESPACE();

#endif
