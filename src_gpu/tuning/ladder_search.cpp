#include "src_gpu/tuning/ladder_search.hpp"

#include <set>

namespace kiloband::opencl {
namespace {

constexpr int kRounds = 3;
constexpr int kSteps[] = {1, 2};

class Climber {
 public:
  Climber(const std::vector<Ladder>& ladders, double least_gain, const SpeedOver& speed_over,
          const std::function<bool()>& stop)
      : ladders_(ladders), least_gain_(least_gain), speed_over_(speed_over), stop_(stop) {
    for (const Ladder& ladder : ladders) best_.push_back(ladder.start);
  }

  /// Returns whether anything changed.
  bool climb_all() {
    const Rungs before = best_;
    for (std::size_t l = 0; l < ladders_.size(); ++l) {
      if (!climb_one(l, +1)) climb_one(l, -1);
    }
    return best_ != before;
  }

  const Rungs& best() const { return best_; }

 private:
  bool climb_one(std::size_t ladder, int direction) {
    bool climbed = false;
    while (step_up(ladder, direction)) climbed = true;
    return climbed;
  }

  bool step_up(std::size_t ladder, int direction) {
    for (const int step : kSteps) {
      const auto rung = static_cast<std::ptrdiff_t>(best_[ladder]) + direction * step;
      if (rung < 0 || rung >= static_cast<std::ptrdiff_t>(ladders_[ladder].values.size())) return false;
      Rungs other = best_;
      other[ladder] = static_cast<std::size_t>(rung);
      if (!is_faster(other)) continue;
      best_ = other;
      return true;
    }
    return false;
  }

  bool is_faster(const Rungs& other) {
    if (stop_() || !compared_.emplace(best_, other).second) return false;
    return speed_over_(best_, other) >= least_gain_;
  }

  const std::vector<Ladder>& ladders_;
  double least_gain_;
  const SpeedOver& speed_over_;
  const std::function<bool()>& stop_;
  Rungs best_;
  std::set<std::pair<Rungs, Rungs>> compared_;
};

}  // namespace

Rungs climb(const std::vector<Ladder>& ladders, double least_gain, const SpeedOver& speed_over,
            const std::function<bool()>& stop) {
  Climber climber(ladders, least_gain, speed_over, stop);
  for (int round = 0; round < kRounds && climber.climb_all(); ++round) {
  }
  return climber.best();
}

}  // namespace kiloband::opencl
