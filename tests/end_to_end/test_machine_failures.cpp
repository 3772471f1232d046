// What the machine refuses ends with exit code 3 and leaves nothing behind,
// and what stood there before stays.
#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "tests/end_to_end/support/program.hpp"
#include "tests/support/effort.hpp"

namespace kiloband::test {
namespace {

using Names = std::vector<std::string>;

/// 64 x 64 pixels in 20 channels: 328 kB.
Names twenty_bands(const Names& more) {
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
  expect_failure(folder, twenty_bands({"-o", "none/a.exr"}), "cannot write 'none/a.exr'" + reason);
  expect_failure(folder, twenty_bands({"-o", "a.exr", "-o", "none/a.hdr"}),
                 "cannot write 'none/a.img'" + reason);
  // Before the render: not even the cube is written.
  expect_failure(folder, twenty_bands({"-o", "a.exr", "--preview", "none/a.png"}),
                 "cannot write 'none/a.png'" + reason);
  expect_failure(folder, twenty_bands({"-o", "a.exr", "--stats", "none/a.json"}),
                 "cannot write 'none/a.json'" + reason);
}

TEST(MachineFailure, OutputIsAFolder) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "a.exr");
  expect_failure(folder, twenty_bands({"-o", "a.exr"}), "cannot write 'a.exr': Is a directory");
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

constexpr const char* kRefusal =
    "the system starts no more (Resource temporarily unavailable): the limit of processes and threads of this "
    "user (ulimit -u: ";

/// The smallest limit under which the program starts at all (libraries that read images have threads); 0 where
/// that cannot be tried.
uint64_t least_process_limit(const TemporaryFolder& folder) {
  for (uint64_t limit = 1; limit <= 20; ++limit) {
    const Outcome outcome = run_program(folder, {"--version"}, {.process_limit = limit});
    if (outcome.code == 0) return limit;
    if (outcome.code == 126) return 0;  // no root, or a build folder that user 65533 cannot enter
    EXPECT_EQ(outcome.code, 3);
    EXPECT_EQ(outcome.err, std::string("kiloband: cannot start a thread: ") + kRefusal +
                               std::to_string(limit) + ") or of its container is reached\n");
  }
  return 0;
}

TEST(MachineFailure, NoThreads) {
  if (kAddressSanitizer || kThreadSanitizer) GTEST_SKIP() << "sanitizers start threads of their own";
  const TemporaryFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0777));
  const uint64_t least = least_process_limit(folder);
  if (least == 0) return;
  const auto render = [&](const std::string& threads, uint64_t limit) {
    return run_program(folder, twenty_bands({"-o", "a.exr", "--backend", "cpu", "--threads", threads}),
                       {.process_limit = limit});
  };
  // 3 of OpenMP beside the first, and as many of TBB, at least one per processor.
  const uint64_t processors = std::thread::hardware_concurrency();
  const uint64_t one = std::max<uint64_t>(1, processors - 1),
                 four = 3 + std::max<uint64_t>(3, processors - 1);
  for (const uint64_t limit : {least, least + four - 1}) {
    const Outcome outcome = render("4", limit);
    EXPECT_EQ(outcome.code, 3);
    EXPECT_EQ(outcome.err,
              "kiloband: cannot start " + std::to_string(four) + " threads for the CPU backend: " + kRefusal +
                  std::to_string(limit) +
                  ") or of its container is reached; raise it, end other programs, or give fewer "
                  "--threads\n");
  }
  EXPECT_EQ(folder.list(), Names{});
  EXPECT_EQ(render("1", least).code, 3);
  EXPECT_EQ(render("1", least + one).err, "");
  EXPECT_EQ(render("4", least + four).err, "");
}

/// A file size limit stands for a full disk: the system refuses the space in the same way,
/// with another reason.
TEST(MachineFailure, NoSpace) {
  if (kThreadSanitizer) GTEST_SKIP() << "ThreadSanitizer maps a file that such a limit cuts";
  const TemporaryFolder folder;
  folder.write("a.exr", "old");
  folder.write("a.hdr", "old");
  folder.write("a.img", "old");
  const Treatment treatment{.file_size_limit = 100'000};
  expect_failure(folder, twenty_bands({"-o", "a.exr"}), "cannot write 'a.exr': File too large", treatment);
  expect_failure(folder, twenty_bands({"-o", "a.hdr"}), "cannot write 'a.img': File too large", treatment);
  for (const char* name : {"a.exr", "a.hdr", "a.img"}) EXPECT_EQ(folder.read(name), "old") << name;
}

TEST(MachineFailure, NoSpaceForAConversion) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_program(folder, twenty_bands({"-o", "a.exr"})).code, 0);
  const Treatment treatment{.file_size_limit = 100'000};
  expect_failure(folder, {"convert", "a.exr", "b.hdr"}, "cannot write 'b.img': File too large", treatment);
  expect_failure(folder, {"convert", "a.exr", "b.exr"}, "cannot write 'b.exr': File too large", treatment);
  expect_failure(folder, {"convert", "a.exr", "none/b.csv", "--pixel", "1,1"},
                 "cannot write 'none/b.csv': No such file or directory");
}

}  // namespace
}  // namespace kiloband::test
