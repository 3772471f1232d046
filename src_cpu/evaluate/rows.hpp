// Dense rows of channels: their length, their memory.
#pragma once

#include <hwy/aligned_allocator.h>

#include <algorithm>
#include <cstddef>
#include <new>
#include <vector>

#include "src_cpu/evaluate/evaluator_kernels.hpp"

namespace kiloband::cpu {

/// n rounded up to a multiple of the padding of channel rows.
inline std::size_t pad_channels(std::size_t n) {
  return (n + kRowPadding - 1) / kRowPadding * kRowPadding;
}

/// `n` zeros, aligned for vectors.
/// throws std::bad_alloc
template <class T>
hwy::AlignedFreeUniquePtr<T[]> aligned_zeros(std::size_t n) {
  auto memory = hwy::AllocateAligned<T>(std::max<std::size_t>(n, 1));
  if (!memory) throw std::bad_alloc();
  std::fill_n(memory.get(), n, T{0});
  return memory;
}

/// Rows of one length that are used again; new ones are zeros.
class RowPool {
 public:
  /// channels: of a row, without padding
  explicit RowPool(std::size_t channels) : length_(pad_channels(channels)) {}

  /// Valid until release(), with what it held before.
  float* take() {
    if (used_ == rows_.size()) rows_.push_back(aligned_zeros<float>(length_));
    return rows_[used_++].get();
  }
  void release() { used_ = 0; }

 private:
  std::size_t length_;
  std::vector<hwy::AlignedFreeUniquePtr<float[]>> rows_;
  std::size_t used_ = 0;  // the first ones are taken
};

}  // namespace kiloband::cpu
