// The steps of a path (StepKind), written while its vertices are read. Small enough to stay in registers.
#pragma once

#include <cmath>
#include <cstddef>

#include "src_cpu/evaluate/evaluator_kernels.hpp"

namespace kiloband::cpu {

/// Scalars become weights of steps: the throughput is scale P, of which P is a product of rows that steps multiply.
class StepWriter {
 public:
  /// Most steps of an entry: emission with another row than before, a light sample, a reflection, P rescaled, one channel kept.
  static constexpr std::size_t kMostSteps = 7;

  StepWriter() = default;
  /// steps: room for kMostSteps times the entries of a path
  explicit StepWriter(PathStep* steps) : next_(steps), first_(steps) {}

  std::size_t count() const { return static_cast<std::size_t>(next_ - first_); }
  /// Emission row of S; null: S is 0.
  const float* light() const { return light_; }

  /// L += tau weight row. Where P has not changed since the step before, that one takes the weight, too.
  void emit(const float* row, float weight) {
    const bool same = !light_ || light_ == row;
    begin_light(row);
    if (same && keeps_product())
      next_[-1].weight += scale_ * weight;
    else
      push(StepKind::kAdd, scale_ * weight, nullptr);
  }

  /// tau *= row
  void reflect(const float* row) { push(StepKind::kReflect, 0, row); }
  /// tau *= row; L += tau weight light
  void reflect(const float* row, const float* light, float weight) {
    begin_light(light);
    push(StepKind::kReflect, scale_ * weight, row);
  }

  /// tau *= weight. P takes over what would carry scale far from 1, so that neither leaves the range of floats
  /// before the throughput does.
  void scatter(float weight) {
    constexpr float kFar = 0x1p40f;
    scale_ *= weight;
    const float size = std::fabs(scale_);
    if (size < kFar && size > 1 / kFar) return;
    push(StepKind::kScale, scale_, nullptr);
    scale_ = 1;
  }

  /// L += tau weight row light
  void sample(const float* row, float weight, const float* light) {
    next_->light = light;
    push(StepKind::kSample, scale_ * weight, row);
  }

  void gas(const GasVertex& vertex) {
    next_->gas = &vertex;
    push(StepKind::kGas, scale_, nullptr);
    scale_ = 1;
  }

  void keep_one(std::size_t channel) {
    if (light_) push(StepKind::kLight, 0, light_);
    light_ = nullptr;
    next_->survivor = channel;
    push(StepKind::kKeepOne, 0, nullptr);
  }

 private:
  /// There is a step before, and it has put P into S as P is now.
  bool keeps_product() const {
    return next_ != first_ && (next_[-1].kind == StepKind::kReflect || next_[-1].kind == StepKind::kAdd);
  }

  void push(StepKind kind, float weight, const float* row) {
    next_->kind = kind;
    next_->weight = weight;
    next_++->row = row;
  }

  /// From here on S is in units of `row`.
  void begin_light(const float* row) {
    if (light_ && light_ != row) push(StepKind::kLight, 0, light_);
    light_ = row;
  }

  PathStep* next_ = nullptr;
  PathStep* first_ = nullptr;
  const float* light_ = nullptr;
  float scale_ = 1;
};

}  // namespace kiloband::cpu
