// The SIMD kernels of deferred evaluation (DPEPT paper, algorithm 1), compiled for SSE4.2, AVX2 and AVX-512.
//
// One path, all channels: for each block of channels, P, S and L stay in registers over all steps; then one
// read-modify-write of the film. Every lane is a channel, so a channel's bits do not depend
// on its neighbours.
#include "src_cpu/evaluate/evaluator_kernels.hpp"

#include <hwy/cache_control.h>

#include <algorithm>
#include <stdexcept>

#include "shared/records.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src_cpu/evaluate/evaluator_kernels.cpp"
#include "base/simd_targets.hpp"
// Before foreach_target.h.
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks for.
#include <hwy/highway.h>

#include "src_cpu/evaluate/evaluator_colours-inl.hpp"
#include "src_cpu/evaluate/evaluator_factors-inl.hpp"
#include "src_cpu/evaluate/evaluator_gas-inl.hpp"
#include "src_cpu/evaluate/evaluator_tables-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kiloband::cpu {
namespace HWY_NAMESPACE {

/// Vectors of a full block: P, S and L take 12 of the 16 (SSE4, AVX2) or 32 registers.
inline constexpr std::size_t kBlockVectors = 4;
static_assert(kBlockVectors * kVectorChannels <= kRowPadding && kVectorChannels <= kMaxLanes);

/// State of a block of V vectors of channels: P, S and L of StepKind.
template <std::size_t V>
struct Block {
  Floats product[V], light[V], radiance[V];

  template <class F>
  static HWY_INLINE void each(F&& f) {
    unrolled(f, std::make_index_sequence<V>{});
  }

  HWY_INLINE void reflect(const PathStep& step, std::size_t k) {
    each([&](auto i) HWY_ATTR { product[i] = hn::Mul(product[i], load(step.row, k + i * kVectorChannels)); });
    add(step);
  }

  HWY_INLINE void add(const PathStep& step) {
    const Floats weight = constant(step.weight);
    each([&](auto i) HWY_ATTR { light[i] = hn::MulAdd(product[i], weight, light[i]); });
  }

  HWY_INLINE void close(const float* row, std::size_t k) {
    each([&](auto i) HWY_ATTR {
      radiance[i] = hn::MulAdd(light[i], load(row, k + i * kVectorChannels), radiance[i]);
      light[i] = hn::Zero(kTag);
    });
  }

  HWY_INLINE void sample(const PathStep& step, std::size_t k) {
    const Floats weight = constant(step.weight);
    each([&](auto i) HWY_ATTR {
      const Floats factor =
          hn::Mul(load(step.row, k + i * kVectorChannels), load(step.light, k + i * kVectorChannels));
      radiance[i] = hn::MulAdd(hn::Mul(product[i], weight), factor, radiance[i]);
    });
  }

  HWY_INLINE void scale(const PathStep& step) {
    each([&](auto i) HWY_ATTR { product[i] = hn::Mul(product[i], constant(step.weight)); });
  }

  HWY_INLINE void gas(const PathStep& step, std::size_t k, float* aside) {
    alignas(64) float t[V * kVectorChannels], l[V * kVectorChannels];
    each([&](auto i) HWY_ATTR {
      hn::Store(hn::Mul(product[i], constant(step.weight)), kTag, t + i * kVectorChannels);
      hn::Store(radiance[i], kTag, l + i * kVectorChannels);
    });
    gas_step(*step.gas, k, V * kVectorChannels, t, l, aside);
    each([&](auto i) HWY_ATTR {
      product[i] = hn::Load(kTag, t + i * kVectorChannels);
      radiance[i] = hn::Load(kTag, l + i * kVectorChannels);
    });
  }

  /// Returns false if the block has no channel that goes on.
  HWY_INLINE bool keep_one(const PathStep& step, std::size_t k) {
    if (step.survivor < k || step.survivor >= k + V * kVectorChannels) return false;
    const hn::RebindToSigned<Tag> tag;
    const auto lane = hn::Set(tag, static_cast<int32_t>(step.survivor - k));
    each([&](auto i) HWY_ATTR {
      const auto kept = hn::Eq(hn::Iota(tag, static_cast<int32_t>(i * kVectorChannels)), lane);
      product[i] = hn::IfThenElseZero(hn::RebindMask(kTag, kept), product[i]);
    });
    return true;
  }

  /// Adds the weighted radiances to the accumulators of the derived channels that the block's group has.
  HWY_INLINE void derive(const DerivedPlan& plan, std::size_t k) const {
    const std::size_t group = k / kRowPadding, place = k % kRowPadding;
    for (uint32_t e = plan.group_first[group]; e < plan.group_first[group + 1]; ++e) {
      const float* weights = plan.entries[e].weights + place;
      float* accumulator = plan.accumulators + plan.entries[e].derived * kMaxLanes;
      Floats sum = hn::Mul(radiance[0], load(weights, 0));
      each([&](auto i) HWY_ATTR {
        if constexpr (i > 0) sum = hn::MulAdd(radiance[i], load(weights, i * kVectorChannels), sum);
      });
      hn::Store(hn::Add(hn::Load(kTag, accumulator), sum), kTag, accumulator);
    }
  }
};

/// Returns false where a path goes on in none of the block's channels: S is 0, and what is to come has no rows for them.
template <std::size_t V>
HWY_INLINE bool run_steps(Block<V>& block, const PathProgram& path, std::size_t k, float* aside) {
  for (const PathStep *step = path.steps, *end = step + path.step_count; step != end; ++step) {
    if (step->kind == StepKind::kReflect) {
      block.reflect(*step, k);
    } else if (step->kind == StepKind::kAdd) {
      block.add(*step);
    } else if (step->kind == StepKind::kLight) {
      block.close(step->row, k);
    } else if (step->kind == StepKind::kSample) {
      block.sample(*step, k);
    } else if (step->kind == StepKind::kScale) {
      block.scale(*step);
    } else if (step->kind == StepKind::kGas) {
      block.gas(*step, k, aside);
    } else if (!block.keep_one(*step, k)) {
      return false;
    }
  }
  return true;
}

/// What is behind belongs to another pixel, which another thread may add to.
HWY_INLINE void add_part(Floats radiance, std::size_t count, float* film) {
  alignas(64) float values[kVectorChannels];
  hn::Store(radiance, kTag, values);
  for (std::size_t i = 0; i < count; ++i) film[i] += values[i];
}

/// Channels [k, k + V * kVectorChannels) of the path.
template <std::size_t V>
HWY_INLINE void evaluate_block(const PathProgram& path, std::size_t k, float* film) {
  Block<V> block;
  alignas(64) float aside[V * kVectorChannels];
  if (path.gas) std::fill_n(aside, V * kVectorChannels, 1.0f);
  block.each([&](auto i) HWY_ATTR {
    block.product[i] = constant(1);
    block.light[i] = block.radiance[i] = hn::Zero(kTag);
    if (path.next_film) hwy::Prefetch(path.next_film + k + i * kVectorChannels);
  });
  if (run_steps(block, path, k, aside) && path.light) block.close(path.light, k);
  if (path.derived) block.derive(*path.derived, k);
  block.each([&](auto i) HWY_ATTR {
    const std::size_t first = k + i * kVectorChannels;
    if (first + kVectorChannels <= path.derived_offset)
      hn::StoreU(hn::Add(hn::LoadU(kTag, film + first), block.radiance[i]), kTag, film + first);
    else if (first < path.derived_offset)
      add_part(block.radiance[i], path.derived_offset - first, film + first);
  });
}

void finish_derived(const DerivedPlan& plan, float* derived) {
  for (std::size_t d = 0; d < plan.count; ++d) {
    float* accumulator = plan.accumulators + d * kMaxLanes;
    derived[d] += hn::GetLane(hn::SumOfLanes(kTag, hn::Load(kTag, accumulator)));
    hn::Store(hn::Zero(kTag), kTag, accumulator);
  }
}

void evaluate_path(const PathProgram& path, float* film) {
  std::size_t k = 0;
  for (; k + kBlockVectors * kVectorChannels <= path.channels; k += kBlockVectors * kVectorChannels) {
    evaluate_block<kBlockVectors>(path, k, film);
  }
  // The rest with as few vectors as do; rows are padded.
  const std::size_t rest = path.channels - k;
  if (rest > 3 * kVectorChannels) {
    evaluate_block<kBlockVectors>(path, k, film);
  } else if (rest > 2 * kVectorChannels) {
    evaluate_block<3>(path, k, film);
  } else if (rest > kVectorChannels) {
    evaluate_block<2>(path, k, film);
  } else if (rest > 0) {
    evaluate_block<1>(path, k, film);
  }
  if (path.derived) finish_derived(*path.derived, film + path.derived_offset);
}

inline constexpr EvaluatorKernels kKernels{evaluate_path, sample_table, sample_exact, sample_double,
                                           weighted_sum,  mix_bands,    fresnel_row,  transmission_row,
                                           internal_row,  tinted_row,   colour_row};

}  // namespace HWY_NAMESPACE
}  // namespace kiloband::cpu
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kiloband::cpu {

// Every target has its own namespace: the choice is the caller's, not Highway's global one.
const EvaluatorKernels& evaluator_kernels(Isa isa) {
  const EvaluatorKernels* const of_isa[] = {nullptr, HWY_CHOOSE_SSE4(kKernels), HWY_CHOOSE_AVX2(kKernels),
                                            HWY_CHOOSE_AVX3(kKernels)};
  const auto* const kernels = of_isa[static_cast<int>(isa)];
  if (!kernels) throw std::logic_error("evaluator_kernels: the instruction set is not resolved");
  return *kernels;
}

}  // namespace kiloband::cpu
#endif
