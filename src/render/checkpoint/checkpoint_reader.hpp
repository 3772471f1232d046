// Reading and checking checkpoints, piece by piece;
// nothing is allocated that the file is not long enough for.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "base/hash.hpp"
#include "render/checkpoint/checkpoint.hpp"
#include "render/checkpoint/checkpoint_source.hpp"

namespace kiloband {

// Layout, little endian: magic; header (u64 each, CheckpointEntry); its checksum (u64); samples per pixel of
// every replicate and block, invalid ones included (u32, [replicate][block]). Then, for each replicate and
// block with samples: valid samples (u32) of the block's pixels, row by row; of each pixel the open sums
// (float) of all channels and, if there are more samples than a chunk, the closed ones (ClosedSum). At the
// end the number of values that are not finite and the checksum of all before it (u64 each).
inline constexpr std::array<char, 16> kCheckpointMagic{'k', 'i', 'l', 'o', 'b', 'a', 'n', 'd',
                                                       ' ', 'c', 'h', 'e', 'c', 'k', ' ', '2'};
enum CheckpointEntry {
  kEntryFingerprint,
  kEntryX,
  kEntryY,
  kEntryWidth,
  kEntryHeight,
  kEntryChannels,
  kEntryReplicates,
  kEntrySums,
  kEntryChunk,
  kEntryPeriod,
  kCheckpointEntries
};
using CheckpointHeader = std::array<uint64_t, kCheckpointEntries>;

/// Bytes of a pixel of a block with `attempted` samples.
uint64_t checkpoint_pixel_bytes(const SumRule& rule, uint64_t channels, uint32_t attempted);
/// Values of a pixel that are not finite.
uint64_t count_not_finite(const SumRule& rule, const PixelSumsView& sums);

class CheckpointReader {
 public:
  /// Reads and checks all before the sums.
  /// throws InputError
  explicit CheckpointReader(const std::filesystem::path& file);

  const CheckpointOutline& outline() const { return outline_; }
  const std::vector<PixelRect>& blocks() const { return blocks_; }
  uint32_t attempted(uint32_t replicate, uint32_t block) const;
  /// Reads and checks the rest, into what `place` says for each replicate and pixel (index in the rectangle).
  /// PixelSums::closed may be empty where there are not more samples than a chunk.
  /// throws InputError
  void read_sums(const std::function<PixelSums(uint32_t replicate, std::size_t pixel)>& place);
  [[noreturn]] void fail(const std::string& what) const;

 private:
  void get(std::span<char> bytes);
  template <class T>
  void get_all(std::span<T> values) {
    get({reinterpret_cast<char*>(values.data()), values.size_bytes()});
  }
  void read_header();
  void check_header(const CheckpointHeader& header) const;
  void read_attempted();
  void check_size() const;
  void read_block(uint32_t replicate, uint32_t block,
                  const std::function<PixelSums(uint32_t, std::size_t)>& place);
  void check_pixel(uint32_t replicate, uint32_t block, std::size_t pixel, const PixelSumsView& sums) const;

  CheckpointSource source_;
  std::string name_;
  WordHash hash_;
  CheckpointOutline outline_;
  std::vector<PixelRect> blocks_;
  std::vector<uint32_t> attempted_;  // [replicate][block]
  std::vector<uint32_t> counts_;     // of a block
  uint64_t not_finite_ = 0;
};

}  // namespace kiloband
