// Which media a path is in.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "shared/pipeline.h"

namespace kiloband::cpu {

/// The interiors that a path has entered and not left, in that order; the last one is where it is. Shapes of
/// one medium count together, so that a volume may be bounded by several shapes; entering what the path is in
/// already changes nothing (a ray can slip through an edge), and neither does leaving what it is not in.
class MediumStack {
 public:
  MediumStack() = default;
  explicit MediumStack(const std::array<uint16_t, KB_MEDIUM_DEPTH>& inside) : inside_(inside) {}

  /// The medium around the path: a media index, or KB_NONE.
  uint32_t current(uint32_t atmosphere) const {
    uint32_t medium = atmosphere;
    for (const uint16_t entry : inside_)
      if (entry != 0) medium = entry - 1u;
    return medium;
  }

  /// Returns false where the path is in too many media at a time.
  bool enter(uint32_t medium) {
    const auto entry = static_cast<uint16_t>(medium + 1);
    for (uint16_t& place : inside_) {
      if (place == entry) return true;
      if (place != 0) continue;
      place = entry;
      return true;
    }
    return false;
  }

  void leave(uint32_t medium) {
    const auto end = std::remove(inside_.begin(), inside_.end(), static_cast<uint16_t>(medium + 1));
    std::fill(end, inside_.end(), uint16_t{0});
  }

 private:
  std::array<uint16_t, KB_MEDIUM_DEPTH> inside_{};
};

}  // namespace kiloband::cpu
