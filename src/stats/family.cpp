#include "stats/family.hpp"

#include "stats/random.hpp"

namespace kiloband::stats {

double case_level(double family, std::size_t cases) {
  return family / static_cast<double>(cases);
}

uint64_t repeat_seed(uint64_t seed) {
  return mix_seed(seed, 0x5265706561740a0au) & 0xffffffffu;
}

Stage next_stage(bool passed, int attempt) {
  if (passed) return Stage::kPassed;
  return attempt == 0 ? Stage::kRepeat : Stage::kFailed;
}

}  // namespace kiloband::stats
