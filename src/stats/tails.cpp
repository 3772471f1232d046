#include "stats/tails.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "stats/variance_test.hpp"

namespace kiloband::stats {
namespace {

constexpr std::size_t kKept = 500;

/// Hill (1975): k / sum ln(x_i / x_k) over the k largest.
double hill(std::vector<double> largest, std::size_t count) {
  if (count < 200) return std::numeric_limits<double>::quiet_NaN();
  std::ranges::sort(largest, std::greater<>());
  const std::size_t k = std::min(std::clamp<std::size_t>(count / 1000, 20, kKept), largest.size()) - 1;
  if (!(largest[k] > 0)) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0;
  for (std::size_t i = 0; i < k; ++i) sum += std::log(largest[i] / largest[k]);
  return sum > 0 ? static_cast<double>(k) / sum : std::numeric_limits<double>::infinity();
}

}  // namespace

Tails::Tails(std::size_t channels) : channels_(channels) {}

void Tails::add(const UnitSample& pixel) {
  const UnitSample deviations = deviations_from_median(pixel);
  for (std::size_t r = 0; r < pixel.replicates(); ++r) {
    if (pixel.weights[r] == 0) continue;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      Channel& channel = channels_[c];
      const double d = deviations.mean_at(r, c);
      ++channel.count;
      channel.sum += pixel.mean_at(r, c);
      channel.squares += d * d;
      channel.fourths += d * d * d * d;
      if (channel.largest.size() == kKept && d <= channel.largest.front()) continue;
      channel.largest.push_back(d);
      std::ranges::push_heap(channel.largest, std::greater<>());
      if (channel.largest.size() <= kKept) continue;
      std::ranges::pop_heap(channel.largest, std::greater<>());
      channel.largest.pop_back();
    }
  }
}

std::vector<TailWeight> Tails::finish() const {
  std::vector<TailWeight> result;
  for (const Channel& channel : channels_) {
    TailWeight tail;
    tail.count = channel.count;
    if (channel.squares > 0 && channel.fourths > 0) {
      const double top = *std::ranges::max_element(channel.largest);
      tail.effective = channel.squares * channel.squares / channel.fourths;
      tail.top_variance = top * top / channel.squares;
      tail.top_sum = channel.sum != 0 ? top / std::abs(channel.sum) : 0;
    } else {
      tail.effective = static_cast<double>(channel.count);  // nothing varies
    }
    tail.hill_index = hill(channel.largest, channel.count);
    result.push_back(tail);
  }
  return result;
}

std::size_t heaviest_channel(const std::vector<TailWeight>& tails) {
  const auto share = [](const TailWeight& t) {
    return t.count == 0 ? 1.0 : t.effective / static_cast<double>(t.count);
  };
  return static_cast<std::size_t>(std::ranges::min_element(tails, {}, share) - tails.begin());
}

}  // namespace kiloband::stats
