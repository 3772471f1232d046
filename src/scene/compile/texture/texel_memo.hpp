// Texels of colours that have been solved already: pictures repeat theirs. Internal to src/scene.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shared/records.h"

namespace kiloband {

struct SolvedTexel {
  KbFloat4 texel{};
  float bound = 0;
};

/// The last texel of each of up to 65,536 places that colours fall into: an upsampled texel takes 1.5 us, a look 5 ns. What it gives are the
/// bits of solving, as a colour is the same in its bits or solved.
class TexelMemo {
 public:
  /// texels  how many there are to find
  explicit TexelMemo(std::size_t texels)
      : bits_(std::bit_width(std::clamp<std::size_t>(texels, 2, std::size_t{1} << kMostBits) - 1)),
        entries_(std::size_t{1} << bits_) {}

  /// rgb    3 numbers
  /// solve  gives the SolvedTexel of a colour that is not there
  template <class Solve>
  const SolvedTexel& find(const float* rgb, const Solve& solve) {
    const uint32_t bits[3] = {std::bit_cast<uint32_t>(rgb[0]), std::bit_cast<uint32_t>(rgb[1]),
                              std::bit_cast<uint32_t>(rgb[2])};
    Entry& entry = entries_[place(bits)];
    if (!entry.known || entry.bits[0] != bits[0] || entry.bits[1] != bits[1] || entry.bits[2] != bits[2])
      entry = {{bits[0], bits[1], bits[2]}, true, solve()};
    return entry.solved;
  }

 private:
  struct Entry {
    uint32_t bits[3] = {};
    bool known = false;
    SolvedTexel solved;
  };
  static constexpr int kMostBits = 16;

  uint32_t place(const uint32_t (&bits)[3]) const {
    const uint32_t mixed = (bits[0] * 0x9e3779b1u ^ bits[1]) * 0x85ebca6bu ^ bits[2];
    return mixed * 0xc2b2ae35u >> (32 - bits_);
  }

  int bits_;
  std::vector<Entry> entries_;
};

}  // namespace kiloband
