#include "film/moment_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "film/moment_kernels.cpp"
#include "base/simd_targets.hpp"
// Before foreach_target.h.
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks for.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace kiloband::film {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Every loop runs over whole vectors, then over 4 channels at a time, then over single ones.
inline constexpr hn::ScalableTag<float> kWide;
inline constexpr hn::CappedTag<float, 4> kFour;
inline constexpr hn::CappedTag<float, 1> kOne;
inline constexpr hn::ScalableTag<double> kWideDouble;
inline constexpr hn::CappedTag<double, 1> kOneDouble;

template <class D>
HWY_INLINE hn::Vec<D> scaled(D d, const ScaledMeans& x, std::size_t k) {
  return hn::Mul(hn::LoadU(d, x.values + k), hn::Set(d, x.factor));
}

template <class D>
HWY_INLINE std::size_t set_from(D d, std::size_t k, const ScaledMeans& x, float* HWY_RESTRICT mean) {
  for (; k + hn::Lanes(d) <= x.channels; k += hn::Lanes(d)) hn::StoreU(scaled(d, x, k), d, mean + k);
  return k;
}

void set_mean(const ScaledMeans& x, float* mean) {
  set_from(kOne, set_from(kFour, set_from(kWide, 0, x, mean), x, mean), x, mean);
}

template <class D>
HWY_INLINE std::size_t mean_from(D d, std::size_t k, const ScaledMeans& x, float weight,
                                 float* HWY_RESTRICT mean) {
  for (; k + hn::Lanes(d) <= x.channels; k += hn::Lanes(d)) {
    const auto before = hn::LoadU(d, mean + k);
    const auto change = hn::Mul(hn::Set(d, weight), hn::Sub(scaled(d, x, k), before));
    hn::StoreU(hn::Add(before, change), d, mean + k);
  }
  return k;
}

void update_mean(const ScaledMeans& x, float weight, float* mean) {
  const std::size_t four = mean_from(kWide, 0, x, weight, mean);
  mean_from(kOne, mean_from(kFour, four, x, weight, mean), x, weight, mean);
}

template <class D>
HWY_INLINE std::size_t moments_from(D d, std::size_t k, const ScaledMeans& x, const MomentWeights& w,
                                    float* HWY_RESTRICT mean, float* HWY_RESTRICT m2) {
  for (; k + hn::Lanes(d) <= x.channels; k += hn::Lanes(d)) {
    const auto before = hn::LoadU(d, mean + k);
    const auto difference = hn::Sub(scaled(d, x, k), before);
    hn::StoreU(hn::Add(before, hn::Mul(hn::Set(d, w.mean), difference)), d, mean + k);
    const auto square = hn::Mul(hn::Mul(hn::Set(d, w.m2), difference), difference);
    hn::StoreU(hn::Add(hn::LoadU(d, m2 + k), square), d, m2 + k);
  }
  return k;
}

void update_moments(const ScaledMeans& x, const MomentWeights& weights, float* mean, float* m2) {
  const std::size_t four = moments_from(kWide, 0, x, weights, mean, m2);
  moments_from(kOne, moments_from(kFour, four, x, weights, mean, m2), x, weights, mean, m2);
}

/// d: doubles
template <class D>
HWY_INLINE std::size_t samples_from(D d, std::size_t k, const ScaledMeans& x, double count,
                                    double* HWY_RESTRICT sums) {
  const hn::Rebind<float, D> half;
  for (; k + hn::Lanes(d) <= x.channels; k += hn::Lanes(d)) {
    const auto mean = hn::PromoteTo(d, scaled(half, x, k));
    hn::StoreU(hn::Add(hn::LoadU(d, sums + k), hn::Mul(hn::Set(d, count), mean)), d, sums + k);
  }
  return k;
}

void add_samples(const ScaledMeans& x, double count, double* sums) {
  samples_from(kOneDouble, samples_from(kWideDouble, 0, x, count, sums), x, count, sums);
}

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::film
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kiloband::film {

// The update of West (1979): with N samples so far of mean m, and n more of mean x, d = x - m,
//   m' = m + n/(N + n) d,   M2' = M2 + N n/(N + n) d^2     (sum of n_r (m_r - m)^2),
// which is also the merging of two sets (Chan et al. 1979) once M2 of the second is added. The factors are
// per unit, so that the loops over channels are fused arithmetic without divisions. All terms of M2 are >= 0:
// nothing cancels but d, whose absolute error is an ulp of the mean.
MomentWeights moment_weights(uint64_t before, uint64_t added) {
  const double total = static_cast<double>(before) + static_cast<double>(added);
  const double fraction = static_cast<double>(added) / total;
  return {static_cast<float>(fraction), static_cast<float>(static_cast<double>(before) * fraction)};
}

HWY_EXPORT(set_mean);
HWY_EXPORT(update_mean);
HWY_EXPORT(update_moments);
HWY_EXPORT(add_samples);

void set_mean(const ScaledMeans& x, float* mean) {
  HWY_DYNAMIC_DISPATCH(set_mean)(x, mean);
}
void update_mean(const ScaledMeans& x, float weight, float* mean) {
  HWY_DYNAMIC_DISPATCH(update_mean)(x, weight, mean);
}
void update_moments(const ScaledMeans& x, const MomentWeights& weights, float* mean, float* m2) {
  HWY_DYNAMIC_DISPATCH(update_moments)(x, weights, mean, m2);
}
void add_samples(const ScaledMeans& x, double count, double* sums) {
  HWY_DYNAMIC_DISPATCH(add_samples)(x, count, sums);
}

}  // namespace kiloband::film
#endif
