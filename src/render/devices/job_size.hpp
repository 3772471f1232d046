// How many blocks a device takes at a time, so that all of several are done at the same time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace kiloband {

/// What is known of a device.
struct DeviceLoad {
  double speed = 0;         // work per second, in a unit that all share; 0: not known yet
  uint32_t at_once = 1;     // blocks that keep all of it busy, Backend::blocks_at_once()
  std::size_t in_hand = 0;  // blocks that it renders now
  bool works = true;        // it has not failed
};

/// Blocks that device `which` takes next of `left` that nobody has, at least 1; 0: none, since another would be
/// through with all of them before it had one. The fastest device is never told so: somebody takes what is left.
///
/// A device takes half of its share by speed of what is left (guided self-scheduling: Polychronopoulos and Kuck
/// 1987), rounded up to what keeps all of it busy as far as its share goes; one of unknown speed a quarter, and no more
/// than keeps it busy.
/// left  at least 1
std::size_t blocks_to_take(std::span<const DeviceLoad> devices, std::size_t which, std::size_t left);

}  // namespace kiloband
