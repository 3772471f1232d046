#include "render/checkpoint/checkpoint_reader.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "base/error.hpp"

namespace kiloband {
namespace {

constexpr uint64_t kMostReplicates = 4096, kMostExtent = 1u << 24, kMostChannels = uint64_t{1} << 32;
constexpr uint64_t kMostSamples = uint64_t{1} << 32;  // of a pixel: their numbers have 32 bits

uint64_t blocks_along(uint64_t begin, uint64_t extent) {
  return (begin + extent - 1) / kBlockSize - begin / kBlockSize + 1;
}

bool has_closed(const SumRule& rule, uint32_t attempted) {
  return attempted > rule.chunk;
}

bool all_zero(const PixelSumsView& sums) {
  return std::ranges::all_of(sums.open, [](float v) { return v == 0; }) &&
         std::ranges::all_of(sums.closed, [](ClosedSum v) { return v == 0; });
}

}  // namespace

uint64_t checkpoint_pixel_bytes(const SumRule& rule, uint64_t channels, uint32_t attempted) {
  return sizeof(uint32_t) +
         channels * (sizeof(float) + (has_closed(rule, attempted) ? sizeof(ClosedSum) : 0));
}

uint64_t count_not_finite(const SumRule& rule, const PixelSumsView& sums) {
  uint64_t count = 0;
  for (const float value : sums.open) count += !std::isfinite(value);
  for (const ClosedSum value : sums.closed) {
    if (rule.kind == SumRule::Kind::kFolded) {
      count += !std::isfinite(std::bit_cast<double>(value));
    } else {
      const auto sum = std::bit_cast<CompensatedSum>(value);
      count += !std::isfinite(sum.sum) || !std::isfinite(sum.lost);
    }
  }
  return count;
}

CheckpointReader::CheckpointReader(const std::filesystem::path& file) : source_(file), name_(file.string()) {
  read_header();
  read_attempted();
  check_size();
}

void CheckpointReader::fail(const std::string& what) const {
  throw InputError("checkpoint " + name_ + " " + what);
}

void CheckpointReader::get(std::span<char> bytes) {
  if (!source_.read(bytes)) fail("is not a checkpoint or ends early");
  hash_.add(bytes);
}

void CheckpointReader::read_header() {
  std::array<char, kCheckpointMagic.size()> magic{};
  get(magic);
  if (!std::equal(magic.begin(), magic.end() - 1, kCheckpointMagic.begin())) fail("is not a checkpoint");
  if (magic.back() != kCheckpointMagic.back())
    fail(fmt::format(
        "has the format {} of another version of kiloband; this one reads format {}: remove it to render "
        "anew",
        magic.back() >= '!' && magic.back() <= '~' ? std::string(1, magic.back()) : "?",
        kCheckpointMagic.back()));
  CheckpointHeader header{};
  get_all<uint64_t>(header);
  const uint64_t expected = hash_.value();
  uint64_t checksum = 0;
  get_all(std::span(&checksum, 1));
  if (checksum != expected) fail("is damaged: the checksum of its header differs");
  check_header(header);
  outline_.fingerprint = header[kEntryFingerprint];
  outline_.rect = {static_cast<uint32_t>(header[kEntryX]), static_cast<uint32_t>(header[kEntryY]),
                   static_cast<uint32_t>(header[kEntryWidth]), static_cast<uint32_t>(header[kEntryHeight])};
  outline_.channels = header[kEntryChannels];
  outline_.replicates = static_cast<uint32_t>(header[kEntryReplicates]);
  outline_.rule = {static_cast<SumRule::Kind>(header[kEntrySums]), static_cast<uint32_t>(header[kEntryChunk]),
                   static_cast<uint32_t>(header[kEntryPeriod]), 1};
}

void CheckpointReader::check_header(const CheckpointHeader& header) const {
  const auto check = [&](CheckpointEntry entry, const char* what, uint64_t least, uint64_t most) {
    if (header[entry] < least || header[entry] > most)
      fail(fmt::format("is damaged: {} is {}, must be from {} to {}", what, header[entry], least, most));
  };
  check(kEntryX, "the left edge", 0, kMostExtent);
  check(kEntryY, "the upper edge", 0, kMostExtent);
  check(kEntryWidth, "the width", 1, kMostExtent);
  check(kEntryHeight, "the height", 1, kMostExtent);
  check(kEntryChannels, "the number of channels", 1, kMostChannels);
  check(kEntryReplicates, "the number of replicates", 1, kMostReplicates);
  check(kEntrySums, "the kind of sums", 0, 1);
  check(kEntryChunk, "the chunk of samples", 0, 1u << 16);
  check(kEntryPeriod, "the period of chunks", 1, 1u << 16);
}

uint32_t CheckpointReader::attempted(uint32_t replicate, uint32_t block) const {
  return attempted_.at(std::size_t{replicate} * blocks_.size() + block);
}

void CheckpointReader::read_attempted() {
  const PixelRect& rect = outline_.rect;
  const uint64_t blocks = blocks_along(rect.x0, rect.width) * blocks_along(rect.y0, rect.height);
  if (blocks * outline_.replicates > source_.size() / sizeof(uint32_t))
    fail("is not a checkpoint or ends early");
  blocks_ = cut_into_blocks(rect);
  attempted_.resize(blocks * outline_.replicates);
  get_all<uint32_t>(attempted_);
  for (uint32_t r = 0; r < outline_.replicates; ++r) {
    const uint64_t most = (kMostSamples - r + outline_.replicates - 1) / outline_.replicates;
    for (uint32_t b = 0; b < blocks; ++b) {
      const uint32_t samples = attempted(r, b);
      if (samples > most)
        fail(fmt::format("holds what no render makes: {} samples in block {} of replicate {}, at most {}",
                         samples, b, r, most));
      outline_.most_samples = std::max(outline_.most_samples, samples);
      outline_.pixel_samples += samples * blocks_[b].pixels();
    }
  }
}

/// Of the whole file, before anything that depends on it is allocated.
void CheckpointReader::check_size() const {
  uint64_t left = source_.size();
  const auto take = [&](uint64_t bytes) {
    if (bytes > left) fail("is not a checkpoint or ends early");
    left -= bytes;
  };
  take(kCheckpointMagic.size() + (kCheckpointEntries + 1) * sizeof(uint64_t));
  take(attempted_.size() * sizeof(uint32_t));
  for (uint32_t r = 0; r < outline_.replicates; ++r) {
    for (uint32_t b = 0; b < blocks_.size(); ++b) {
      if (const uint32_t samples = attempted(r, b); samples > 0)
        take(blocks_[b].pixels() * checkpoint_pixel_bytes(outline_.rule, outline_.channels, samples));
    }
  }
  take(2 * sizeof(uint64_t));
  if (left > 0) fail(fmt::format("is damaged: {} bytes follow its end", left));
}

void CheckpointReader::read_sums(const std::function<PixelSums(uint32_t, std::size_t)>& place) {
  for (uint32_t r = 0; r < outline_.replicates; ++r) {
    for (uint32_t b = 0; b < blocks_.size(); ++b) {
      if (attempted(r, b) > 0) read_block(r, b, place);
    }
  }
  uint64_t not_finite = 0, checksum = 0;
  get_all(std::span(&not_finite, 1));
  const uint64_t expected = hash_.value();
  get_all(std::span(&checksum, 1));
  if (checksum != expected) fail("is damaged: the checksum differs");
  if (not_finite != not_finite_)
    fail(fmt::format("holds what no render makes: {} values that are not finite, {} are stated", not_finite_,
                     not_finite));
}

void CheckpointReader::read_block(uint32_t replicate, uint32_t block,
                                  const std::function<PixelSums(uint32_t, std::size_t)>& place) {
  const PixelRect& rect = blocks_[block];
  const bool closed = has_closed(outline_.rule, attempted(replicate, block));
  counts_.resize(rect.pixels());
  get_all<uint32_t>(counts_);
  for (std::size_t p = 0; p < rect.pixels(); ++p) {
    const std::size_t x = rect.x0 - outline_.rect.x0 + p % rect.width;
    const std::size_t y = rect.y0 - outline_.rect.y0 + p / rect.width;
    const PixelSums sums = place(replicate, y * outline_.rect.width + x);
    sums.count = counts_[p];
    get_all(sums.open);
    if (closed) get_all(sums.closed);
    const PixelSumsView got{sums.count, sums.open, closed ? sums.closed : std::span<ClosedSum>()};
    check_pixel(replicate, block, p, got);
    not_finite_ += count_not_finite(outline_.rule, got);
  }
}

void CheckpointReader::check_pixel(uint32_t replicate, uint32_t block, std::size_t pixel,
                                   const PixelSumsView& sums) const {
  const auto say = [&](const std::string& what) {
    const PixelRect& rect = blocks_[block];
    fail(fmt::format("holds what no render makes: {} in pixel {},{} of replicate {}", what,
                     rect.x0 + pixel % rect.width, rect.y0 + pixel / rect.width, replicate));
  };
  const uint32_t most = attempted(replicate, block);
  if (sums.count > most) say(fmt::format("{} valid of {} samples", sums.count, most));
  if (sums.count == 0 && !all_zero(sums)) say("a sum of no samples");
}

}  // namespace kiloband
