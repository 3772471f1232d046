// Outputs that are no plain files: links are followed, pipes and devices are written to and never replaced.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <future>

#include "files/atomic_file.hpp"
#include "tests/support/special_files.hpp"
#include "tests/unit/cube/cube_support.hpp"

namespace kiloband {
namespace {

using namespace test;
using Names = std::vector<std::string>;

/// All that comes through a named pipe.
std::future<std::string> reader_of(const std::filesystem::path& pipe) {
  return std::async(std::launch::async, [pipe] { return read_file(pipe); });
}

TEST(SpecialOutput, LinksAreFollowedToTheirEnd) {
  const TemporaryFolder folder;
  folder.write("sub/real", "old");
  std::filesystem::create_symlink("sub/second", folder / "first");
  std::filesystem::create_symlink("../sub/real", folder / "sub" / "second");
  write_file_atomically(folder / "first", std::string("new"));
  EXPECT_EQ(folder.read("sub/real"), "new");
  for (const char* link : {"first", "sub/second"}) EXPECT_TRUE(std::filesystem::is_symlink(folder / link));
}

TEST(SpecialOutput, ALinkToNothingMakesTheFile) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("there", folder / "link");
  write_file_atomically(folder / "link", std::string("new"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(folder.read("there"), "new");
  std::filesystem::create_symlink("none/there", folder / "lost");
  EXPECT_EQ(error_of<DeviceError>([&] { check_writable(folder / "lost"); }),
            "cannot write '" + (folder / "lost").string() + "': No such file or directory");
}

TEST(SpecialOutput, LinksInACircleAreNamed) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("b", folder / "a");
  std::filesystem::create_symlink("a", folder / "b");
  EXPECT_EQ(error_of<DeviceError>([&] { check_writable(folder / "a"); }),
            "cannot write '" + (folder / "a").string() + "': Too many levels of symbolic links");
  EXPECT_EQ(folder.list(), (Names{"a", "b"}));
}

TEST(SpecialOutput, OneNameOfSeveralIsReplaced) {
  const TemporaryFolder folder;
  folder.write("a", "old");
  std::filesystem::create_hard_link(folder / "a", folder / "b");
  write_file_atomically(folder / "a", std::string("new"));
  EXPECT_EQ(folder.read("a"), "new");
  EXPECT_EQ(folder.read("b"), "old");
}

TEST(SpecialOutput, PipesAreWrittenTo) {
  const TemporaryFolder folder;
  make_pipe(folder / "pipe");
  std::filesystem::create_symlink("pipe", folder / "link");
  const std::string text(300'000, 'x');  // more than a pipe holds
  for (const char* name : {"pipe", "link"}) {
    check_writable(folder / name);  // without waiting for a reader
    auto reader = reader_of(folder / "pipe");
    write_file_atomically(folder / name, text);
    EXPECT_EQ(reader.get(), text);
    EXPECT_TRUE(std::filesystem::is_fifo(folder / "pipe"));
    EXPECT_EQ(folder.list(), (Names{"link", "pipe"}));
  }
}

TEST(SpecialOutput, AReaderThatGoesAwayIsAnError) {
  const TemporaryFolder folder;
  make_pipe(folder / "pipe");
  auto reader = std::async(std::launch::async, [&] { close(open((folder / "pipe").c_str(), O_RDONLY)); });
  EXPECT_EQ(error_of<DeviceError>([&] { write_file_atomically(folder / "pipe", std::string(300'000, 'x')); }),
            "cannot write '" + (folder / "pipe").string() + "': Broken pipe");
}

TEST(SpecialOutput, AFullDeviceIsAnErrorAndStays) {
  const TemporaryFolder folder;
  make_full_device(folder / "full");
  EXPECT_EQ(error_of<DeviceError>([&] { write_file_atomically(folder / "full", std::string("x")); }),
            "cannot write '" + (folder / "full").string() + "': No space left on device");
  EXPECT_TRUE(std::filesystem::is_character_file(folder / "full"));
  EXPECT_EQ(folder.list(), Names{"full"});
}

TEST(SpecialOutput, OpenDescriptorsGoOnWhereTheyAre) {
  const TemporaryFolder folder;
  const int descriptor = open((folder / "log").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  const std::string name = "/dev/fd/" + std::to_string(descriptor);
  ASSERT_EQ(write(descriptor, "before ", 7), 7);
  write_file_atomically(name, std::string("between"));
  ASSERT_EQ(write(descriptor, " after", 6), 6);
  close(descriptor);
  EXPECT_EQ(folder.read("log"), "before between after");
  EXPECT_EQ(folder.list(), Names{"log"});
  const int read_only = open((folder / "log").c_str(), O_RDONLY | O_CLOEXEC);
  const std::string second = "/dev/fd/" + std::to_string(read_only);
  EXPECT_EQ(error_of<DeviceError>([&] { check_writable(second); }),
            "cannot write '" + second + "': Bad file descriptor");
  close(read_only);
}

TEST(SpecialOutput, TheScratchFilesPlaceIsNamed) {
  const TemporaryFolder folder;
  make_pipe(folder / "pipe");
  const char* value = std::getenv("TMPDIR");
  const std::string before = value ? value : "";
  setenv("TMPDIR", (folder / "none").c_str(), 1);
  EXPECT_EQ(error_of<DeviceError>([&] { check_writable(folder / "pipe"); }),
            "cannot write '" + (folder / "pipe").string() + "': scratch file in '" +
                (folder / "none").string() + "': No such file or directory");
  before.empty() ? unsetenv("TMPDIR") : setenv("TMPDIR", before.c_str(), 1);
}

/// EXR files are not written from beginning to end, ENVI files neither: a pipe carries the same bytes.
TEST(SpecialOutput, CubesGoThroughPipes) {
  const TemporaryFolder folder;
  const Cube cube = make_cube(50, 70, equal_bands(400, 500, 5), true, {"depth.Z"});
  for (const auto& [output, data] : {std::pair{"cube.exr", "cube.exr"}, std::pair{"cube.hdr", "cube.img"}}) {
    write_cube_file(cube, folder / output);
    const std::string expected = folder.read(data);
    std::filesystem::remove(folder / data);
    make_pipe(folder / data);
    auto reader = reader_of(folder / data);
    write_cube_file(cube, folder / output);
    EXPECT_EQ(reader.get(), expected) << output;
    EXPECT_TRUE(std::filesystem::is_fifo(folder / data));
  }
  EXPECT_EQ(folder.list(), (Names{"cube.aux.hdr", "cube.aux.img", "cube.exr", "cube.hdr", "cube.img",
                                  "cube.var.hdr", "cube.var.img"}));
}

TEST(SpecialOutput, AHeaderThatIsAPipeOrALinkStays) {
  const TemporaryFolder folder;
  const Cube cube = make_cube(4, 4, equal_bands(400, 500, 2));
  write_cube_file(cube, folder / "plain.hdr");
  make_pipe(folder / "cube.hdr");
  auto reader = reader_of(folder / "cube.hdr");
  write_cube_file(cube, folder / "cube.hdr");
  EXPECT_EQ(reader.get(), folder.read("plain.hdr"));
  EXPECT_TRUE(std::filesystem::is_fifo(folder / "cube.hdr"));
  std::filesystem::create_directory(folder / "sub");
  std::filesystem::create_symlink("sub/far.hdr", folder / "linked.hdr");
  for (int time = 0; time < 2; ++time) {  // the second replaces the first
    write_cube_file(cube, folder / "linked.hdr");
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "linked.hdr"));
    EXPECT_EQ(folder.read("sub/far.hdr"), folder.read("plain.hdr"));
  }
}

TEST(OutputIdentity, SeesThroughLinks) {
  const TemporaryFolder folder;
  folder.write("file", "x");
  std::filesystem::create_symlink("file", folder / "link");
  std::filesystem::create_hard_link(folder / "file", folder / "name");
  std::filesystem::create_directory_symlink(".", folder / "here");
  folder.write("other", "x");
  const auto identity = output_identity(folder / "file");
  for (const char* name : {"link", "name", "here/link", "./here/here/file"})
    EXPECT_EQ(output_identity(folder / name), identity) << name;
  EXPECT_NE(output_identity(folder / "other"), identity);
}

TEST(OutputIdentity, OfFilesThatAreToBe) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("none", folder / "link");
  std::filesystem::create_directory_symlink(".", folder / "here");
  EXPECT_EQ(output_identity(folder / "link"), output_identity(folder / "none"));
  EXPECT_EQ(output_identity(folder / "here/none"), output_identity(folder / "none"));
  EXPECT_NE(output_identity(folder / "nothing"), output_identity(folder / "none"));
  make_pipe(folder / "pipe");
  EXPECT_FALSE(output_identity(folder / "pipe").has_value());
  EXPECT_FALSE(output_identity("/dev/stdout").has_value());
}

}  // namespace
}  // namespace kiloband
