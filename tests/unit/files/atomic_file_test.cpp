// Files appear whole or not at all.
#include "files/atomic_file.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tests/unit/cube/cube_support.hpp"

namespace kiloband {
namespace {

using namespace test;
using Names = std::vector<std::string>;

/// Lets no file grow beyond `bytes`: the nearest thing to a full disk that every machine has.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &old_);
    handler_ = signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_);
    signal(SIGXFSZ, handler_);
  }

 private:
  rlimit old_;
  sighandler_t handler_;
};

Cube small_cube() {
  return make_cube(20, 40, equal_bands(400, 500, 5), true, {"depth.Z"});
}

class Atomic : public testing::TestWithParam<const char*> {
 protected:
  std::filesystem::path file(const std::string& name = "cube") const { return folder / (name + GetParam()); }
  TemporaryFolder folder;
};

TEST_P(Atomic, NothingStandsUnderTheNamesBeforeTheEnd) {
  const Cube cube = small_cube();
  const auto writer = create_cube_writer(file(), cube.info, 32);
  write_rows_of(*writer, cube, 32);
  for (const std::string& name : folder.list()) EXPECT_TRUE(name.starts_with(".kiloband-")) << name;
  writer->finish();
  const bool exr = std::string(GetParam()) == ".exr";
  EXPECT_EQ(folder.list(), exr ? Names{"cube.exr"}
                               : (Names{"cube.aux.hdr", "cube.aux.img", "cube.hdr", "cube.img",
                                        "cube.var.hdr", "cube.var.img"}));
}

TEST_P(Atomic, ADestroyedWriterLeavesNothing) {
  const Cube cube = small_cube();
  create_cube_writer(file(), cube.info, 32)->write_rows(rows_of(cube, 0, 32));
  EXPECT_EQ(folder.list(), Names{});
  const auto interrupted = [&] {
    const auto writer = create_cube_writer(file(), cube.info, 32);
    writer->write_rows(rows_of(cube, 0, 32));
    throw std::runtime_error("interrupted");
  };
  EXPECT_THROW(interrupted(), std::runtime_error);
  EXPECT_EQ(folder.list(), Names{});
}

TEST_P(Atomic, AnOldCubeSurvivesAWriterThatFails) {
  const Cube cube = small_cube();
  write_cube_file(cube, file());
  const Names before = folder.list();
  create_cube_writer(file(), cube.info, 32)->write_rows(rows_of(cube, 0, 32));
  EXPECT_EQ(folder.list(), before);
  EXPECT_EQ(count_differences(read_cube(file()).aux, cube.aux), 0u);
}

TEST_P(Atomic, ANewCubeReplacesTheOldOneWithAllItsFiles) {
  write_cube_file(small_cube(), file());
  const Cube cube = make_cube(8, 8, equal_bands(600, 700, 2));
  write_cube_file(cube, file());
  EXPECT_EQ(read_cube(file()).info.bands.size(), 2u);
  for (const std::string& name : folder.list()) EXPECT_EQ(name.find("var"), std::string::npos) << name;
}

TEST_P(Atomic, AMissingFolderIsNamed) {
  const auto missing = folder.path() / "missing" / (std::string("cube") + GetParam());
  const auto data = std::string(GetParam()) == ".exr" ? missing : folder.path() / "missing" / "cube.img";
  EXPECT_EQ(error_of<DeviceError>([&] { create_cube_writer(missing, small_cube().info, 32); }),
            "cannot write '" + data.string() + "': No such file or directory");
}

TEST_P(Atomic, AReadOnlyFolderIsNamed) {
  if (geteuid() == 0) return;  // the superuser may write anywhere
  std::filesystem::permissions(folder.path(),
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const auto data = std::string(GetParam()) == ".exr" ? file() : folder / "cube.img";
  EXPECT_EQ(error_of<DeviceError>([&] { create_cube_writer(file(), small_cube().info, 32); }),
            "cannot write '" + data.string() + "': Permission denied");
}

TEST_P(Atomic, AFolderInTheWayIsFoundAtOnce) {
  std::filesystem::create_directory(file());
  EXPECT_EQ(error_of<DeviceError>([&] { create_cube_writer(file(), small_cube().info, 32); }),
            "cannot write '" + file().string() + "': Is a directory");
  EXPECT_EQ(folder.list().size(), 1u);
}

TEST_P(Atomic, AFullDiskShowsBeforeTheRender) {
  const FileSizeLimit limit(10'000);  // the values alone need 16,000 bytes
  const auto data = std::string(GetParam()) == ".exr" ? file() : folder / "cube.img";
  EXPECT_EQ(error_of<DeviceError>([&] { create_cube_writer(file(), small_cube().info, 32); }),
            "cannot write '" + data.string() + "': File too large");
  EXPECT_EQ(folder.list(), Names{});
}

INSTANTIATE_TEST_SUITE_P(Formats, Atomic, testing::Values(".exr", ".hdr"),
                         [](const auto& format) { return std::string(format.param + 1); });

TEST(AtomicExr, AFailureWhileWritingReachesTheCaller) {
  // The limit comes after the space was claimed, where only OpenEXR's own calls can meet it.
  const TemporaryFolder folder;
  const Cube cube = small_cube();
  const auto file = folder / "cube.exr";
  auto writer = create_cube_writer(file, cube.info, 32);
  {
    const FileSizeLimit limit(40'000);  // inside the first row of tiles
    EXPECT_EQ(error_of<DeviceError>([&] {
                write_rows_of(*writer, cube, 32);
                writer->finish();
              }),
              "cannot write '" + file.string() + "': File too large");
  }
  writer.reset();
  EXPECT_EQ(folder.list(), Names{});
}

TEST(AtomicFile, ForeignVarianceFilesStay) {
  const TemporaryFolder folder;
  folder.write("cube.var.hdr", "ENVI\nsamples = 1\n");
  folder.write("cube.var.img", "data");
  write_cube_file(make_cube(2, 2, equal_bands(400, 500, 2)), folder / "cube.hdr");
  EXPECT_EQ(folder.list(), (Names{"cube.hdr", "cube.img", "cube.var.hdr", "cube.var.img"}));
}

TEST(AtomicFile, LinksAreFollowed) {
  const TemporaryFolder folder;
  folder.write("real.exr", "old");
  std::filesystem::create_symlink("real.exr", folder / "link.exr");
  write_file_atomically(folder / "link.exr", std::string("new"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.exr"));
  EXPECT_EQ(read_file(folder / "real.exr"), "new");
}

TEST(AtomicFile, FilesBeyondFourGigabytes) {
  const TemporaryFolder folder;
  {
    AtomicFile file(folder / "big");
    file.write_at(5'000'000'000, std::string("end"));
    file.commit();
  }
  EXPECT_EQ(std::filesystem::file_size(folder / "big"), 5'000'000'003u);
}

}  // namespace
}  // namespace kiloband
