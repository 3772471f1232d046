// Checkpoints: what they keep, and what they refuse.
#include "render/checkpoint/checkpoint.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "base/hash.hpp"
#include "tests/support/messages.hpp"

namespace kiloband::checkpoint_test {
namespace {

constexpr uint64_t kFingerprint = 7;
constexpr SumRule kRule{SumRule::Kind::kFolded, 4, 4, 1};
// Bytes of the checkpoint below: magic, header and its checksum; samples of 2 replicates and 2 blocks of a
// pixel; replicate 0 of block 0 (open sums), replicate 1 of block 1 (both kinds);
// values that are not finite, checksum.
constexpr std::size_t kHeader = 16, kTable = kHeader + 11 * 8, kFirst = kTable + 4 * 4,
                      kSecond = kFirst + 4 + 2 * 4, kEnd = kSecond + 4 + 2 * 4 + 2 * 8, kSize = kEnd + 16;

SpectralFilm film_of(uint32_t replicates = 2) {
  FilmOptions options;
  options.channels = 2;
  options.replicates = replicates;
  options.held = true;
  options.sums = kRule;
  return SpectralFilm({31, 0, 2, 1}, options);  // pixels in two blocks
}

void put(SpectralFilm& film, uint32_t replicate, uint32_t block, uint32_t attempted, uint32_t count) {
  const PixelSums sums = film.pixel_sums(replicate, block);
  sums.count = count;
  sums.open[0] = 1.5f;
  sums.open[1] = 2.5f;
  if (attempted > kRule.chunk) sums.closed[1] = std::bit_cast<ClosedSum>(12.25);
  film.set_attempted(replicate, block, attempted);
}

SpectralFilm filled() {
  SpectralFilm film = film_of();
  put(film, 0, 0, 3, 2);
  put(film, 1, 1, 9, 9);
  return film;
}

class Checkpoint : public testing::Test {
 protected:
  std::string bytes_of(const SpectralFilm& film) {
    write_checkpoint(file_, film, kFingerprint);
    return folder_.read("render.ck");
  }

  /// What is said about the file with these bytes.
  std::string said(const std::string& bytes) {
    folder_.write("render.ck", bytes);
    const std::string name = "checkpoint " + file_.string() + " ";
    SpectralFilm film = film_of();
    const std::string text = test::error_of([&] { read_checkpoint(file_, film, kFingerprint); });
    if (text == "accepted") return text;
    EXPECT_TRUE(text.starts_with(name)) << text;
    return text.substr(name.size());
  }

  test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "render.ck";
};

template <class T>
void put(std::string& bytes, std::size_t at, const T& value) {
  std::memcpy(&bytes.at(at), &value, sizeof value);
}

template <class T>
std::string with(std::string bytes, std::size_t at, const T& value) {
  put(bytes, at, value);
  return bytes;
}

/// The checksums as a writer of these bytes would have made them.
std::string resealed(std::string bytes) {
  WordHash hash;
  const auto add = [&](std::size_t begin, std::size_t end) {
    hash.add(std::span(bytes).subspan(begin, end - begin));
  };
  add(0, kHeader);
  add(kHeader, kTable - 8);
  put(bytes, kTable - 8, hash.value());
  add(kTable - 8, kTable);
  add(kTable, kFirst);
  for (const auto& [begin, closed] : {std::pair{kFirst, false}, std::pair{kSecond, true}}) {
    add(begin, begin + 4);
    add(begin + 4, begin + 12);
    if (closed) add(begin + 12, begin + 28);
  }
  add(kEnd, kEnd + 8);
  put(bytes, kEnd + 8, hash.value());
  return bytes;
}

TEST_F(Checkpoint, KeepsSumsAndCountsBitByBit) {
  const SpectralFilm film = filled();
  EXPECT_EQ(bytes_of(film).size(), kSize);
  EXPECT_EQ(resealed(bytes_of(film)), bytes_of(film));  // the tests below rely on it
  SpectralFilm copy = film_of();
  EXPECT_EQ(read_checkpoint(file_, copy, kFingerprint), 12u);
  for (uint32_t r = 0; r < 2; ++r) {
    for (uint32_t p = 0; p < 2; ++p) {
      const PixelSumsView a = film.pixel_sums(r, p), b = std::as_const(copy).pixel_sums(r, p);
      EXPECT_EQ(a.count, b.count);
      EXPECT_TRUE(std::ranges::equal(a.open, b.open));
      EXPECT_TRUE(std::ranges::equal(a.closed, b.closed));
      EXPECT_EQ(film.attempted(r, p), copy.attempted(r, p));
    }
  }
  const CheckpointOutline outline = checkpoint_outline(file_);
  EXPECT_EQ(outline.most_samples, 9u);
  EXPECT_EQ(outline.pixel_samples, 12u);
  EXPECT_EQ(outline.fingerprint, kFingerprint);
  EXPECT_EQ(checkpoint_replicates(file_), 2u);
  EXPECT_EQ(checkpoint_replicates(folder_ / "none"), std::nullopt);
}

TEST_F(Checkpoint, OfAnotherRenderIsRefused) {
  bytes_of(filled());
  const auto said = [&](SpectralFilm film, uint64_t fingerprint) {
    return test::error_of([&] { read_checkpoint(file_, film, fingerprint); });
  };
  const std::string name = "checkpoint " + file_.string();
  EXPECT_EQ(said(film_of(), kFingerprint + 1), name +
                                                   " belongs to another render: scene, channels, sampling, "
                                                   "size, instruction set or OpenCL device differ");
  EXPECT_EQ(said(film_of(3), kFingerprint),
            name + " belongs to another render: it has 2 replicates, this one 3");
}

TEST_F(Checkpoint, DamagedOrOfAnotherVersionIsRefused) {
  const std::string good = bytes_of(filled());
  EXPECT_EQ(said(good), "accepted");
  EXPECT_EQ(said(""), "is not a checkpoint or ends early");
  EXPECT_EQ(said(std::string(kSize, 'x')), "is not a checkpoint");
  EXPECT_EQ(
      said(with(good, 15, '1')),
      "has the format 1 of another version of kiloband; this one reads format 2: remove it to render anew");
  EXPECT_EQ(said(with(good, kHeader, '\x55')), "is damaged: the checksum of its header differs");
  for (const std::size_t at : {kTable, kFirst + 6, kSecond + 20, kEnd, kEnd + 8})
    EXPECT_NE(said(with(good, at, '\x02')), "accepted") << at;
  EXPECT_EQ(said(with(good, kSecond + 20, '\x02')), "is damaged: the checksum differs");
  for (const std::size_t size : {kHeader, kTable - 1, kTable + 3, kFirst, kSecond + 5, kSize - 1})
    EXPECT_EQ(said(good.substr(0, size)), "is not a checkpoint or ends early") << size;
  EXPECT_EQ(said(good + "xyz"), "is damaged: 3 bytes follow its end");
}

TEST_F(Checkpoint, SizesAreCheckedBeforeAnythingIsAllocated) {
  const std::string good = bytes_of(filled());
  const auto header = [&](std::size_t entry, uint64_t value) {
    return said(resealed(with(good, kHeader + 8 * entry, value)));
  };
  EXPECT_EQ(header(3, 0), "is damaged: the width is 0, must be from 1 to 16777216");
  EXPECT_EQ(header(5, ~uint64_t{0}),
            "is damaged: the number of channels is 18446744073709551615, must be from 1 to 4294967296");
  EXPECT_EQ(header(6, 4097), "is damaged: the number of replicates is 4097, must be from 1 to 4096");
  EXPECT_EQ(header(7, 2), "is damaged: the kind of sums is 2, must be from 0 to 1");
  // More than the file is long: pixels, channels.
  EXPECT_EQ(header(4, 1 << 24), "is not a checkpoint or ends early");
  EXPECT_EQ(header(5, uint64_t{1} << 32), "is not a checkpoint or ends early");
}

TEST_F(Checkpoint, ValuesThatNoRenderMakesAreRefused) {
  const std::string good = bytes_of(filled());
  const auto damaged = [&](std::size_t at, auto value) { return said(resealed(with(good, at, value))); };
  const std::string begin = "holds what no render makes: ";
  EXPECT_EQ(damaged(kFirst, uint32_t{4}), begin + "4 valid of 3 samples in pixel 31,0 of replicate 0");
  EXPECT_EQ(damaged(kFirst, uint32_t{0}), begin + "a sum of no samples in pixel 31,0 of replicate 0");
  EXPECT_EQ(damaged(kFirst + 4, std::numeric_limits<float>::quiet_NaN()),
            begin + "1 values that are not finite, 0 are stated");
  EXPECT_EQ(damaged(kSecond + 12, std::numeric_limits<double>::infinity()),
            begin + "1 values that are not finite, 0 are stated");
  EXPECT_EQ(damaged(kTable + 12, uint32_t{0xffffffffu}),
            begin + "4294967295 samples in block 1 of replicate 1, at most 2147483648");
}

/// A sum that overflowed is a fact of the render; it is stated, and comes back.
TEST_F(Checkpoint, OverflowedSumsAreStated) {
  SpectralFilm film = filled(), copy = film_of();
  film.pixel_sums(0, 0).open[0] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(said(bytes_of(film)), "accepted");
  read_checkpoint(file_, copy, kFingerprint);
  EXPECT_EQ(copy.pixel_sums(0, 0).open[0], std::numeric_limits<float>::infinity());
}

TEST_F(Checkpoint, OnlyRegularFilesAreOpened) {
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  EXPECT_EQ(test::error_of([&] { checkpoint_outline(file_); }),
            "checkpoint " + file_.string() + " is a named pipe: must be a regular file");
  EXPECT_EQ(test::error_of([&] { checkpoint_outline(folder_.path()); }),
            "checkpoint " + folder_.path().string() + " is a folder: must be a regular file");
  EXPECT_EQ(test::error_of([&] { checkpoint_outline("/dev/null"); }),
            "checkpoint /dev/null is a device: must be a regular file");
  EXPECT_EQ(test::error_of([&] { checkpoint_outline(folder_ / "none"); }),
            "checkpoint " + (folder_ / "none").string() + " cannot be opened: No such file or directory");
  for (const bool resume : {false, true}) {
    EXPECT_EQ(
        test::error_of([&] { check_checkpoint_file(file_, resume); }),
        "--checkpoint " + file_.string() + ": is a named pipe: must be a regular file, or not be there yet");
  }
  folder_.write("old.ck", "old");
  EXPECT_EQ(test::error_of([&] { check_checkpoint_file(folder_ / "old.ck", false); }),
            "--checkpoint " + (folder_ / "old.ck").string() +
                ": exists: --resume goes on from it; remove it to render anew");
  EXPECT_EQ(test::error_of([&] { check_checkpoint_file(folder_ / "old.ck", true); }), "accepted");
  EXPECT_THROW(check_checkpoint_file(folder_ / "none" / "new.ck", false), DeviceError);
}

}  // namespace
}  // namespace kiloband::checkpoint_test
