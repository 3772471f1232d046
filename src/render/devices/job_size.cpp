#include "render/devices/job_size.hpp"

#include <algorithm>
#include <cmath>

namespace kiloband {
namespace {

/// Unknown speeds count as the mean of the known ones.
double speed_of_unknown(std::span<const DeviceLoad> devices) {
  double sum = 0;
  int known = 0;
  for (const DeviceLoad& device : devices) {
    if (!device.works || device.speed <= 0) continue;
    sum += device.speed;
    ++known;
  }
  return known > 0 ? sum / known : 1;
}

bool another_is_through_before(std::span<const DeviceLoad> devices, const DeviceLoad& asking,
                               std::size_t left) {
  return std::ranges::any_of(devices, [&](const DeviceLoad& other) {
    if (&other == &asking || !other.works || other.speed <= 0) return false;
    return static_cast<double>(other.in_hand + left) / other.speed < 1 / asking.speed;
  });
}

}  // namespace

std::size_t blocks_to_take(std::span<const DeviceLoad> devices, std::size_t which, std::size_t left) {
  const DeviceLoad& asking = devices[which];
  const bool known = asking.speed > 0;
  if (known && another_is_through_before(devices, asking, left)) return 0;
  const double unknown = speed_of_unknown(devices);
  double all = 0;
  std::size_t working = 0;
  for (const DeviceLoad& device : devices) {
    if (!device.works) continue;
    all += device.speed > 0 ? device.speed : unknown;
    ++working;
  }
  if (working == 1) return left;
  const double own = known ? asking.speed : unknown;
  const auto share = static_cast<std::size_t>(std::ceil(static_cast<double>(left) * own / all));
  const std::size_t most = std::clamp<std::size_t>(share, 1, left), busy = asking.at_once;
  if (!known) return std::clamp<std::size_t>(std::min(most / 4, busy), 1, left);
  return std::min(most, ((most + 1) / 2 + busy - 1) / busy * busy);
}

}  // namespace kiloband
