#include "src_cpu/evaluate/derived_rows.hpp"

#include <algorithm>

namespace kiloband::cpu {

DerivedRows::DerivedRows(const FlatScene& scene, const DerivedChannels& derived,
                         const EvaluatorKernels& kernels)
    : scene_(scene), derived_(derived), kernels_(kernels), density_(scene.channels) {
  for (const RegularTable& response : derived.responses) rows_.push_back(make_row(response));
  shares_.assign(pad_channels(scene.channels.size()), 1.0f);
  accumulators_ = aligned_zeros<float>(rows_.size() * kMaxLanes);
  make_plan();
}

DerivedRows::Row DerivedRows::make_row(const RegularTable& response) const {
  Row row;
  const Spectrum::Range range = response.support();
  const auto covers = [&](const Channel& c) { return c.max_nm >= range.min_nm && c.min_nm <= range.max_nm; };
  std::size_t first = scene_.channels.size(), end = 0;
  for (std::size_t k = 0; k < scene_.channels.size(); ++k) {
    if (!covers(scene_.channels[k])) continue;
    first = std::min(first, k);
    row.scale = end == 0 ? scene_.channel_scale[k] : std::max(row.scale, scene_.channel_scale[k]);
    end = k + 1;
  }
  if (end == 0) return row;
  row.first_group = first / kRowPadding;
  row.group_count = (end - 1) / kRowPadding + 1 - row.first_group;
  row.factor = aligned_zeros<float>(row.group_count * kRowPadding);
  row.weights = aligned_zeros<float>(row.group_count * kRowPadding);
  for (std::size_t k = first; k < end; ++k) {
    if (covers(scene_.channels[k]))
      row.factor[k - row.first_group * kRowPadding] = static_cast<float>(scene_.channel_scale[k] / row.scale);
  }
  row.table.assign(response.values.begin(), response.values.end());
  return row;
}

void DerivedRows::make_plan() {
  const std::size_t groups = pad_channels(scene_.channels.size()) / kRowPadding;
  for (std::size_t g = 0; g < groups; ++g) {
    group_first_.push_back(static_cast<uint32_t>(entries_.size()));
    for (std::size_t d = 0; d < rows_.size(); ++d) {
      const Row& row = rows_[d];
      if (g < row.first_group || g >= row.first_group + row.group_count) continue;
      entries_.push_back({static_cast<uint32_t>(d), row.weights.get() + (g - row.first_group) * kRowPadding});
    }
  }
  group_first_.push_back(static_cast<uint32_t>(entries_.size()));
  plan_ = {rows_.size(), group_first_.data(), entries_.data(), accumulators_.get()};
}

void DerivedRows::share_wavelengths(const double* lambda_nm) {
  for (std::size_t k = 0; k < scene_.channels.size(); ++k)
    shares_[k] = static_cast<float>(1 / channel_divisor(scene_.channels[k], density_.at(lambda_nm[k])));
}

void DerivedRows::fill(std::size_t d, const DenseSpectra& spectra) {
  Row& row = rows_[d];
  const RegularTable& response = derived_.responses[d];
  const std::size_t first = row.first_group * kRowPadding;
  const std::size_t n = row.group_count * kRowPadding;
  if (n == 0) return;
  const double* const lambda_nm = spectra.lambda_nm() + first;
  if (spectra.fast())
    kernels_.sample_table(view_of(row.table, response), lambda_nm, n, row.weights.get());
  else
    kernels_.sample_exact(view_of(response.values, response), lambda_nm, nullptr, n, row.weights.get());
  for (std::size_t i = 0; i < n; ++i) row.weights[i] *= row.factor[i] * shares_[first + i];
}

const DerivedPlan* DerivedRows::plan(const DenseSpectra& spectra) {
  if (rows_.empty()) return nullptr;
  if (generation_ != spectra.generation()) {
    if (density_.overlapping()) share_wavelengths(spectra.lambda_nm());
    for (std::size_t d = 0; d < rows_.size(); ++d) fill(d, spectra);
    generation_ = spectra.generation();
  }
  return &plan_;
}

}  // namespace kiloband::cpu
