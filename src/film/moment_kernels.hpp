// What a replicate's mean changes in the moments of its pixel: loops over channels, compiled for SSE4.2, AVX2 and
// AVX-512. Products and sums are rounded one by one: every instruction set gives the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace kiloband::film {

/// mean[k] = factor * values[k] for k < channels.
struct ScaledMeans {
  std::size_t channels = 0;
  const float* values = nullptr;
  float factor = 1;
};

/// Factors of one update.
struct MomentWeights {
  float mean;  // n / (N + n)
  float m2;    // N n / (N + n)
};
/// Of n = `added` samples beside N = `before`; added > 0.
MomentWeights moment_weights(uint64_t before, uint64_t added);

/// mean[k] = x[k]
void set_mean(const ScaledMeans& x, float* mean);
/// mean[k] += weight * (x[k] - mean[k])
void update_mean(const ScaledMeans& x, float weight, float* mean);
/// The same, and m2[k] += (weights.m2 * d) * d with d = x[k] - mean[k] before.
void update_moments(const ScaledMeans& x, const MomentWeights& weights, float* mean, float* m2);
/// sums[k] += count * x[k], in double
void add_samples(const ScaledMeans& x, double count, double* sums);

}  // namespace kiloband::film
