// What the machine refuses ends with exit code 3 and leaves nothing behind, and what stood there before
// stays.
#include <gtest/gtest.h>

#include "tests/end_to_end/support/program.hpp"

namespace kiloband::test {
namespace {

using Names = std::vector<std::string>;

/// 64 x 64 pixels in 20 channels: 328 kB.
Names box(const Names& more) {
  Names arguments{"--size", "64x64", "--bands", "400:700:20", "--spp", "1"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return quiet_render(cornell_box(), arguments);
}

void expect_failure(const TemporaryFolder& folder, const Names& arguments, const std::string& message,
                    const Treatment& treatment = {}) {
  const Names before = folder.list();
  const Outcome outcome = run_program(folder, arguments, treatment);
  EXPECT_EQ(outcome.code, 3) << message;
  EXPECT_EQ(outcome.signal, 0) << message;
  EXPECT_EQ(outcome.err, "kiloband: " + message + "\n");
  EXPECT_EQ(folder.list(), before) << message;
}

TEST(MachineFailure, MissingFolder) {
  const TemporaryFolder folder;
  const std::string reason = ": No such file or directory";
  expect_failure(folder, box({"-o", "none/a.exr"}), "cannot write 'none/a.exr'" + reason);
  expect_failure(folder, box({"-o", "a.exr", "-o", "none/a.hdr"}), "cannot write 'none/a.img'" + reason);
  // Before the render: not even the cube is written.
  expect_failure(folder, box({"-o", "a.exr", "--preview", "none/a.png"}),
                 "cannot write 'none/a.png'" + reason);
  expect_failure(folder, box({"-o", "a.exr", "--stats", "none/a.json"}),
                 "cannot write 'none/a.json'" + reason);
}

TEST(MachineFailure, OutputIsAFolder) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "a.exr");
  expect_failure(folder, box({"-o", "a.exr"}), "cannot write 'a.exr': Is a directory");
}

TEST(MachineFailure, ReadOnlyFolder) {
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene(""));
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0555));
  const Treatment treatment{.unprivileged = true};
  // A build folder that user 65534 cannot enter: nothing to be learnt.
  if (run_program(folder, {"--version"}, treatment).code != 0) return;
  for (const std::string file : {"a.exr", "a.img"}) {
    const std::string output = file == "a.img" ? "a.hdr" : file;
    expect_failure(folder, quiet_render("scene.xml", {"--spp", "1", "-o", output}),
                   "cannot write '" + file + "': Permission denied", treatment);
  }
}

/// A file size limit stands for a full disk: the system refuses the space in the same way, with another
/// reason.
TEST(MachineFailure, NoSpace) {
  const TemporaryFolder folder;
  folder.write("a.exr", "old");
  folder.write("a.hdr", "old");
  folder.write("a.img", "old");
  const Treatment treatment{.file_size_limit = 100'000};
  expect_failure(folder, box({"-o", "a.exr"}), "cannot write 'a.exr': File too large", treatment);
  expect_failure(folder, box({"-o", "a.hdr"}), "cannot write 'a.img': File too large", treatment);
  for (const char* name : {"a.exr", "a.hdr", "a.img"}) EXPECT_EQ(folder.read(name), "old") << name;
}

TEST(MachineFailure, NoSpaceForAConversion) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_program(folder, box({"-o", "a.exr"})).code, 0);
  const Treatment treatment{.file_size_limit = 100'000};
  expect_failure(folder, {"convert", "a.exr", "b.hdr"}, "cannot write 'b.img': File too large", treatment);
  expect_failure(folder, {"convert", "a.exr", "b.exr"}, "cannot write 'b.exr': File too large", treatment);
  expect_failure(folder, {"convert", "a.exr", "none/b.csv", "--pixel", "1,1"},
                 "cannot write 'none/b.csv': No such file or directory");
}

}  // namespace
}  // namespace kiloband::test
