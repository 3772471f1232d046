// Rows of sums that follow each other, as evaluators take them.
#pragma once

#include <span>
#include <vector>

#include "src_cpu/evaluate/evaluator.hpp"

namespace kiloband::test {

/// sums[pixel * evaluator.stride() + k]; evaluation is fastest where `sums` is aligned to 64 bytes.
class FollowingRows {
 public:
  FollowingRows(const cpu::Evaluator& evaluator, std::span<float> sums) {
    for (std::size_t first = 0; first + evaluator.stride() <= sums.size(); first += evaluator.stride())
      pixels_.push_back(&sums[first]);
  }
  operator cpu::SumRows() const { return {pixels_, false}; }

 private:
  std::vector<float*> pixels_;
};

}  // namespace kiloband::test
