// Damaged files: whatever bytes change, reading ends with values or with an InputError.
#include <gtest/gtest.h>

#include <random>

#include "cube_support.hpp"

namespace kiloband {
namespace {

using namespace test;

constexpr int kMutations = 1000;

/// Changes a few bytes, or cuts or lengthens the file; half of the changes are in the first `head` bytes.
std::string mutate(std::string bytes, std::size_t head, std::mt19937& random) {
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  const std::size_t changes = 1 + below(4);
  for (std::size_t i = 0; i < changes; ++i) {
    const std::size_t at = below(below(2) == 0 ? std::min(head, bytes.size()) : bytes.size());
    switch (below(4)) {
      case 0:
        bytes[at] = static_cast<char>(below(256));
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 2:
        bytes[at] = static_cast<char>(0xFF);
        break;
      default:
        bytes[at] = 0;
    }
  }
  if (below(16) == 0) bytes.resize(below(bytes.size()) + 1);
  if (below(16) == 0) bytes.insert(below(bytes.size()), bytes.substr(0, below(64)));
  return bytes;
}

/// Opens and reads what a mutation left, row by row as long as a row stays small. True if it could be read.
bool read_mutant(const std::filesystem::path& file) {
  try {
    const auto reader = open_cube(file);
    const CubeInfo& info = reader->info();
    const std::size_t row = std::size_t{info.width} * std::max(info.bands.size(), info.aux.size());
    if (row > 10'000'000) return true;
    std::vector<float> mean(info.width * info.bands.size()), variance(info.variance ? mean.size() : 0),
        aux(info.width * info.aux.size());
    for (uint32_t y = 0; y < std::min(info.height, 64u); ++y) {
      reader->read_rows(y, 1, mean, variance);
      reader->read_aux(y, 1, aux);
    }
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// Both outcomes must occur, or the mutations would not test what they claim to.
void expect_robust(const std::filesystem::path& opened, const std::filesystem::path& damaged,
                   std::size_t head) {
  const std::string good = read_file(damaged);
  std::mt19937 random(20210301);
  int readable = 0;
  for (int i = 0; i < kMutations; ++i) {
    write_file(damaged, mutate(good, head, random));
    readable += read_mutant(opened);
  }
  EXPECT_GT(readable, kMutations / 100);
  EXPECT_LT(readable, kMutations * 99 / 100);
}

Cube small_cube() {
  Cube cube = make_cube(9, 34, equal_bands(400, 500, 3), true, {"depth.Z"});
  cube.info.metadata = {{"seed", "1"}};
  return cube;
}

TEST(Mutations, Exr) {
  const TemporaryFolder folder;
  write_cube_file(small_cube(), folder / "f.exr");
  expect_robust(folder / "f.exr", folder / "f.exr", 2200);
}

TEST(Mutations, EnviHeader) {
  const TemporaryFolder folder;
  write_cube_file(small_cube(), folder / "f.hdr");
  expect_robust(folder / "f.hdr", folder / "f.hdr", 600);
}

TEST(Mutations, EnviVarianceHeader) {
  const TemporaryFolder folder;
  write_cube_file(small_cube(), folder / "f.hdr");
  expect_robust(folder / "f.hdr", folder / "f.var.hdr", 300);
}

}  // namespace
}  // namespace kiloband
