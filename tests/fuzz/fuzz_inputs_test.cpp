// Every seed and every input that was a finding once, through the targets without libFuzzer.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "tests/fuzz/fuzz_target.hpp"

namespace kiloband::fuzz {

void PrintTo(const Target& target, std::ostream* out) {  // found by GoogleTest
  *out << target.name;
}

namespace {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(KILOBAND_SOURCE_DIR) / "tests/fuzz";

std::vector<fs::path> inputs(const fs::path& folder) {
  std::vector<fs::path> files;
  if (fs::exists(folder))
    for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

void run(const Target& target, const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  EXPECT_NO_THROW(target.run(bytes.str())) << file;
}

struct Inputs : testing::TestWithParam<Target> {};

/// A seed that its reader refuses leads nowhere: they must be accepted, also when a format has changed.
TEST_P(Inputs, Seeds) {
  const auto seeds = inputs(kFolder / "corpus" / GetParam().name);
  ASSERT_FALSE(seeds.empty());
  for (const fs::path& file : seeds) {
    const std::size_t before = accepted_uses();
    run(GetParam(), file);
    EXPECT_GT(accepted_uses(), before) << file << " is refused";
  }
}

TEST_P(Inputs, Regressions) {
  for (const fs::path& file : inputs(kFolder / "regressions" / GetParam().name)) run(GetParam(), file);
  run(GetParam(), "no file: no bytes");
}

INSTANTIATE_TEST_SUITE_P(Targets, Inputs, testing::ValuesIn(targets().begin(), targets().end()),
                         [](const auto& target) { return std::string(target.param.name); });

TEST(Folders, BelongToTargets) {
  for (const char* kind : {"corpus", "regressions"}) {
    for (const fs::path& folder : inputs(kFolder / kind)) {
      const std::string name = folder.filename().string();
      EXPECT_TRUE(std::any_of(targets().begin(), targets().end(), [&](const Target& t) {
        return t.name == name;
      })) << folder;
    }
  }
}

}  // namespace
}  // namespace kiloband::fuzz
