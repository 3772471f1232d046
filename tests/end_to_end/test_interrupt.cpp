// Ctrl-C and SIGTERM: the samples in flight are finished and what there is is written, exit code 130.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <cmath>

#include "tests/end_to_end/support/program.hpp"
#include "tests/support/effort.hpp"
#include "tests/support/special_files.hpp"

namespace kiloband::test {
namespace {

/// The signals are caught from the moment when this is printed.
constexpr const char* kRendering = "backend cpu";
/// Seconds in which a few samples are rendered; threads that are watched take twenty times as long.
constexpr double kSomeSamples = kThreadSanitizer ? 10 : 0.5;

std::size_t pixels_of_nan(const Cube& cube) {
  std::size_t count = 0;
  const std::size_t bands = cube.info.bands.size();
  for (std::size_t pixel = 0; pixel < cube.pixels(); ++pixel) {
    std::size_t missing = 0;
    for (std::size_t band = 0; band < bands; ++band) missing += std::isnan(cube.mean[pixel * bands + band]);
    EXPECT_TRUE(missing == 0 || missing == bands) << "pixel " << pixel;
    count += missing > 0;
  }
  return count;
}

void expect_warning(const Outcome& outcome, std::size_t missing) {
  const std::string warning = "warning: " + std::to_string(missing) + " pixels have no sample: NaN\n";
  EXPECT_EQ(outcome.err.find(warning) != std::string::npos, missing > 0) << outcome.err;
}

/// 64 x 64 pixels with far more samples than the test waits for.
Outcome interrupted_box(const TemporaryFolder& folder, int signal, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"render",    cornell_box(), "--size",    "64x64", "--bands",
                                     "400:700:3", "-o",          "a.exr",     "-o",    "a.hdr",
                                     "--stats",   "a.json",      "--variance"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(folder, arguments,
                     {.signal = signal, .after_text = kRendering, .after_seconds = kSomeSamples});
}

TEST(Interrupt, FilesAreCompleteWithFewerSamples) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const TemporaryFolder folder;
    const Outcome outcome = interrupted_box(folder, signal, {"--spp", "100000000", "--replicates", "4"});
    EXPECT_EQ(outcome.code, 130) << outcome.err;
    EXPECT_EQ(outcome.signal, 0);
    EXPECT_EQ(folder.list(),
              (std::vector<std::string>{"a.exr", "a.hdr", "a.img", "a.json", "a.var.hdr", "a.var.img"}));
    const nlohmann::json stats = read_json(folder, "a.json");
    EXPECT_EQ(stats["interrupted"], true);
    EXPECT_LT(stats["spp"].get<uint64_t>(), 100000000u);
    EXPECT_GT(stats["paths"].get<uint64_t>(), 0u);
    const Cube exr = read_cube(folder / "a.exr");
    const Cube envi = read_cube(folder / "a.hdr");
    const std::size_t missing = pixels_of_nan(envi);
    EXPECT_EQ(pixels_of_nan(exr), missing);
    EXPECT_LT(missing, envi.pixels());
    expect_warning(outcome, missing);
  }
}

/// The first replicate has millions of samples, but no block waits until another has had them all.
TEST(Interrupt, LongReplicateReachesEveryPixel) {
  const TemporaryFolder folder;
  const Outcome outcome = interrupted_box(folder, SIGINT, {"--spp", "100000000", "--threads", "1"});
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  const std::size_t missing = pixels_of_nan(read_cube(folder / "a.hdr"));
  EXPECT_EQ(missing, 0u);
  expect_warning(outcome, missing);
}

/// Beyond the budget of 1 GiB strips are streamed. A response of 700 points makes 699 sub-channels, 3 GB for
/// 1024 x 1024 pixels, but only one band on disk.
std::string streamed_scene() {
  std::string response;
  for (int i = 0; i < 700; ++i)
    response += std::to_string(400 + 0.4 * i) + ":" + (i % 2 == 0 ? "0.5 " : "1 ");
  return scene_text(R"(<sensor type="perspective"><film type="specfilm">
<integer name="width" value="1024"/><integer name="height" value="1024"/>
<spectrum name="comb" value=")" +
                    response + R"("/></film></sensor><emitter type="constant"/>)");
}

/// What was not reached is NaN.
TEST(Interrupt, StreamedRender) {
  const TemporaryFolder folder;
  folder.write("scene.xml", streamed_scene());
  const Outcome outcome =
      run_program(folder, {"render", "scene.xml", "--spp", "100000", "-o", "a.hdr", "--stats", "a.json"},
                  {.signal = SIGINT, .after_text = kRendering, .after_seconds = kSomeSamples});
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_EQ(folder.list(), (std::vector<std::string>{"a.hdr", "a.img", "a.json", "scene.xml"}));
  const nlohmann::json stats = read_json(folder, "a.json");
  EXPECT_EQ(stats["streamed"], true);
  EXPECT_EQ(stats["interrupted"], true);
  EXPECT_LT(stats["output_seconds"].get<double>(), 10);
  const Cube cube = read_cube(folder / "a.hdr");
  ASSERT_EQ(cube.info.bands.size(), 1u);
  const std::size_t missing = pixels_of_nan(cube);
  EXPECT_GT(missing, cube.pixels() / 2);
  EXPECT_LT(missing, cube.pixels());
  expect_warning(outcome, missing);
}

/// The first Ctrl-C stops the render, which then waits for somebody to read the pipe that it is to write to.
TEST(Interrupt, TheSecondEndsAtOnceAndLeavesNothing) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const TemporaryFolder folder;
    folder.write("b.exr", "old");
    make_pipe(folder / "a.exr");
    const Outcome outcome = run_program(
        folder,
        {"render", cornell_box(), "--size", "64x64", "--bands", "400:700:3", "--spp", "100000000", "-o",
         "a.exr", "-o", "b.exr", "-o", "c.hdr", "--variance"},
        {.signal = signal, .after_text = kRendering, .after_seconds = 0.2, .again_after_seconds = 1});
    EXPECT_EQ(outcome.signal, signal) << outcome.code << outcome.err;
    EXPECT_EQ(folder.list(), (std::vector<std::string>{"a.exr", "b.exr"}));
    EXPECT_TRUE(std::filesystem::is_fifo(folder / "a.exr"));
    EXPECT_EQ(folder.read("b.exr"), "old");
  }
}

/// Files have no name before they are complete, where the file system can do that.
TEST(Interrupt, AKillLeavesNothing) {
  const TemporaryFolder folder;
  const int nameless = open(folder.path().c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
  if (nameless < 0) return;
  close(nameless);
  folder.write("scene.xml", streamed_scene());  // whose outputs are open during the render
  const Outcome outcome =
      run_program(folder, {"render", "scene.xml", "--spp", "100000", "-o", "a.hdr", "-o", "a.exr"},
                  {.signal = SIGKILL, .after_text = kRendering, .after_seconds = 0.3});
  EXPECT_EQ(outcome.signal, SIGKILL) << outcome.code << outcome.err;
  EXPECT_EQ(folder.list(), std::vector<std::string>{"scene.xml"});
}

}  // namespace
}  // namespace kiloband::test
