// Damaged files: whatever bytes change, reading ends with values or with an InputError.
#include <gtest/gtest.h>

#include "cube_support.hpp"
#include "tests/support/mutations.hpp"

namespace kiloband {
namespace {

using namespace test;

/// Opens and reads what a mutation left, row by row as long as a row stays small.
void read_mutant(const std::filesystem::path& file) {
  const auto reader = open_cube(file);
  const CubeInfo& info = reader->info();
  const std::size_t row = std::size_t{info.width} * std::max(info.bands.size(), info.aux.size());
  if (row > 10'000'000) return;
  std::vector<float> mean(info.width * info.bands.size()), variance(info.variance ? mean.size() : 0),
      aux(info.width * info.aux.size());
  for (uint32_t y = 0; y < std::min(info.height, 64u); ++y) {
    reader->read_rows(y, 1, mean, variance);
    reader->read_aux(y, 1, aux);
  }
}

/// Damages one file of a cube, the first `head` bytes of it above all.
void expect_robust_cube(const char* cube_name, const char* damaged, std::size_t head) {
  const TemporaryFolder folder;
  Cube cube = make_cube(9, 34, equal_bands(400, 500, 3), true, {"depth.Z"});
  cube.info.metadata = {{"seed", "1"}};
  write_cube_file(cube, folder / cube_name);
  expect_robust(folder.read(damaged), {.times = 1000, .head = head}, 0.01, [&](const std::string& mutant) {
    folder.write(damaged, mutant);
    read_mutant(folder / cube_name);
  });
}

TEST(Mutations, Exr) {
  expect_robust_cube("f.exr", "f.exr", 2200);
}

TEST(Mutations, EnviHeader) {
  expect_robust_cube("f.hdr", "f.hdr", 600);
}

TEST(Mutations, EnviVarianceHeader) {
  expect_robust_cube("f.hdr", "f.var.hdr", 300);
}

}  // namespace
}  // namespace kiloband
