#include "src_gpu/path/launch_pace.hpp"

#include <algorithm>

namespace kiloband::opencl {
namespace {

constexpr uint64_t kGrowth = 4;

}  // namespace

LaunchPace::LaunchPace(double seconds, uint64_t first, uint64_t fewest, uint64_t most)
    : target_(seconds / 2),
      fewest_(std::min(fewest, most)),
      most_(most),
      limit_(std::clamp(first, fewest_, most_)) {}

void LaunchPace::learn(uint64_t units, double seconds) {
  if (units == 0) return;
  rate_ = std::max(seconds / static_cast<double>(units), rate_ / 2);
  // A launch far below the limit tells little about one that is larger still.
  const uint64_t reach = units >= limit_ / 2 ? std::max(units, limit_ / kGrowth) * kGrowth : limit_;
  const double fitting = rate_ > 0 ? target_ / rate_ : static_cast<double>(most_);
  const uint64_t fit = fitting < static_cast<double>(reach) ? static_cast<uint64_t>(fitting) : reach;
  limit_ = std::clamp(fit, fewest_, most_);
}

}  // namespace kiloband::opencl
