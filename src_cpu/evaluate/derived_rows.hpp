// Weights of derived channels at one wavelength offset.
#pragma once

#include <vector>

#include "spectral/channel_density.hpp"
#include "src_cpu/evaluate/dense_spectra.hpp"

namespace kiloband::cpu {

/// Row d holds, for the channels that response d can cover at any offset, response_d(lambda_k) share_k
/// times channel_scale_k / scale(d): what a film channel adds to film channel d. share_k: DerivedChannels.
class DerivedRows {
 public:
  DerivedRows(const FlatScene& scene, const DerivedChannels& derived, const EvaluatorKernels& kernels);

  std::size_t count() const { return rows_.size(); }
  /// Largest channel_scale of the covered channels, or 1.
  double scale(std::size_t d) const { return rows_[d].scale; }
  /// The weights at spectra's offset; null if there are no derived channels. Valid until the next call.
  const DerivedPlan* plan(const DenseSpectra& spectra);

 private:
  struct Row {
    std::size_t first_group = 0, group_count = 0;  // groups of kRowPadding channels
    double scale = 1;
    hwy::AlignedFreeUniquePtr<float[]> factor;  // channel_scale_k / scale where covered, else 0
    hwy::AlignedFreeUniquePtr<float[]> weights;
    std::vector<float> table;  // float copy of the response
  };

  Row make_row(const RegularTable& response) const;
  void make_plan();
  void share_wavelengths(const double* lambda_nm);
  void fill(std::size_t d, const DenseSpectra& spectra);

  const FlatScene& scene_;
  const DerivedChannels& derived_;
  const EvaluatorKernels& kernels_;
  std::vector<Row> rows_;
  ChannelDensity density_;
  std::vector<float> shares_;  // [channel]; 1 where channels do not overlap
  std::vector<uint32_t> group_first_;
  std::vector<DerivedPlan::Entry> entries_;
  hwy::AlignedFreeUniquePtr<float[]> accumulators_;
  DerivedPlan plan_;
  uint64_t generation_ = 0;
};

}  // namespace kiloband::cpu
