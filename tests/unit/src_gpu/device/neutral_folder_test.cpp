// The current folder while drivers build, of several threads.
#include "src_gpu/device/neutral_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <thread>
#include <vector>

namespace kiloband::opencl::test {
namespace {

namespace fs = std::filesystem;

TEST(NeutralFolder, IsRootUntilTheLastOneEnds) {
  const fs::path here = fs::current_path();
  ASSERT_NE(here, "/");
  std::optional<NeutralFolder> first, second;
  first.emplace();
  EXPECT_EQ(fs::current_path(), "/");
  second.emplace();
  first.reset();
  EXPECT_EQ(fs::current_path(), "/");
  second.reset();
  EXPECT_EQ(fs::current_path(), here);
}

TEST(NeutralFolder, IsLeftForActionsOfTheOnlyOne) {
  const fs::path here = fs::current_path();
  {
    const NeutralFolder neutral;
    fs::path seen;
    neutral.from_outside([&] { seen = fs::current_path(); });
    EXPECT_EQ(seen, here);
    EXPECT_EQ(fs::current_path(), "/");
    const NeutralFolder another;
    neutral.from_outside([&] { seen = fs::current_path(); });
    EXPECT_EQ(seen, "/");
  }
  EXPECT_EQ(fs::current_path(), here);
}

TEST(NeutralFolder, OfManyThreadsReturnsWhereTheyBegan) {
  const fs::path here = fs::current_path();
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([] {
        for (int i = 0; i < 500; ++i) {
          const NeutralFolder neutral;
          neutral.from_outside([] { std::this_thread::yield(); });
          EXPECT_EQ(fs::current_path(), "/");
        }
      });
    }
  }
  EXPECT_EQ(fs::current_path(), here);
}

}  // namespace
}  // namespace kiloband::opencl::test
