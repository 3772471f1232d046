// Drivers, devices and program binaries that are missing, damaged or refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

#include "tests/end_to_end/support/program.hpp"
#include "tests/support/effort.hpp"

namespace kiloband::test {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;
using Environment = std::vector<std::pair<std::string, std::string>>;

const Names kRender{"render", cornell_box(), "--size", "8x8", "--bands", "400:700:8", "--spp",
                    "2",      "--backend",   "opencl", "-o",  "a.hdr",   "--quiet"};

Environment with_shim(const std::string& function, int code, bool repeat) {
  return {{"LD_PRELOAD", SHIM_LIBRARY},
          {"ASAN_OPTIONS", "verify_asan_link_order=0"},
          {"KILOBAND_SHIM_FUNCTION", function},
          {"KILOBAND_SHIM_CODE", std::to_string(code)},
          {"KILOBAND_SHIM_REPEAT", repeat ? "1" : "0"}};
}

void expect_failure(const Environment& environment, const std::string& message) {
  const TemporaryFolder folder;
  const Outcome outcome = run_program(folder, kRender, {.environment = environment});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_EQ(outcome.err.substr(0, message.size()), message);
  EXPECT_EQ(folder.list(), Names{});
}

TEST(OpenclProgram, NoPlatform) {
  const TemporaryFolder folder;
  const std::string message =
      "kiloband: no OpenCL platform: no OpenCL driver is installed (for processors: pocl-opencl-icd)\n";
  expect_failure({{"OCL_ICD_VENDORS", folder.path().string()}}, message);
  expect_failure(with_shim("clGetPlatformIDs", -1001, true), message);
}

TEST(OpenclProgram, NoDevice) {
  expect_failure({{"POCL_DEVICES", "none"}}, "kiloband: no OpenCL ");
}

TEST(OpenclProgram, AutoFallsBackToTheCpu) {
  const TemporaryFolder folder, empty;
  Names arguments = kRender;
  arguments[9] = "auto";
  arguments.insert(arguments.end(), {"--stats", "s.json"});
  const Outcome outcome =
      run_program(folder, arguments, {.environment = {{"OCL_ICD_VENDORS", empty.path().string()}}});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(read_json(folder, "s.json")["backend"], "cpu");
}

std::vector<float> floats_of(const std::string& bytes) {
  std::vector<float> values(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
  return values;
}

/// Largest difference over the value of `a`.
float relative_difference(const std::string& a, const std::string& b) {
  const std::vector<float> x = floats_of(a), y = floats_of(b);
  if (x.size() != y.size()) return INFINITY;
  float largest = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (x[i] != y[i]) largest = std::max(largest, std::abs(x[i] - y[i]) / std::abs(x[i]));
  return largest;
}

/// The kernels as GPUs get them, with a work-item for each slot, groups that evaluate together and paths shaded by kinds of material: on
/// processors, too, the bytes are those of the form for processors, by every method. Not where spectra of colours or Planck's law are
/// evaluated, which GPUs round otherwise. Each case builds its kernels twice: some are left to KILOBAND_THOROUGH.
TEST(OpenclProgram, TheFormForGpusGivesTheSameBytes) {
  const auto as = [](const std::string& type) -> Treatment {
    return {.environment = {{"LD_PRELOAD", SHIM_LIBRARY},
                            {"ASAN_OPTIONS", "verify_asan_link_order=0"},
                            {"KILOBAND_SHIM_TYPE", type}}};
  };
  expect_text(run_program(TemporaryFolder(), {"devices"}, as("gpu")).out, "  gpu  ");
  const std::string scenes = std::string(KILOBAND_SOURCE_DIR) + "/validation/scenes/";
  struct Scene {
    std::string file, bands;
    float tolerance;
    std::vector<std::string> methods;
  };
  const std::vector<std::string> batch{"dpept-batch"}, every{"dpept-batch", "dpept-path", "pt"};
  for (const Scene& scene : {Scene{cornell_box(), "400:700:20", 0, every},
                             {cornell_box(), "400:700:300", 0, {}},  // three vectors of a work-item, four
                             {cornell_box(), "400:700:515", 0, batch},
                             {scenes + "lens_and_glass.xml", "400:700:150", 0, {}},
                             {scenes + "metals_and_lamps.xml", "400:700:5", 1e-6f, {"pt"}},
                             {scenes + "hot_gas.xml", "3000:5000:9", 1e-6f, batch}}) {
    for (const std::string& method : thorough() ? every : scene.methods) {
      SCOPED_TRACE(scene.file + ", " + scene.bands + ", " + method);
      const TemporaryFolder folder;
      const auto image = [&](const std::string& type) {
        const Outcome outcome =
            run_program(folder,
                        {"render", scene.file, "--size", "40x40", "--bands", scene.bands, "--spp", "5",
                         "--backend", "opencl", "--method", method, "--device-memory", "256MiB",
                         "--replicates", "2", "--variance", "-o", "a.hdr"},
                        as(type));
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        // Differences between replicates have larger relative errors than their means.
        return folder.read("a.img") + (scene.tolerance == 0 ? folder.read("a.var.img") : "");
      };
      const std::string expected = image("");
      ASSERT_FALSE(expected.empty());
      EXPECT_LE(relative_difference(expected, image("gpu")), scene.tolerance);
    }
  }
}

/// OpenCL asks for no more than groups of one work-item.
TEST(OpenclProgram, SmallWorkGroupsGiveTheSameBytes) {
  for (const std::string type : {"", "gpu"}) {
    const TemporaryFolder folder;
    const auto image = [&](const std::string& group) {
      const Outcome outcome =
          run_program(folder,
                      {"render", cornell_box(), "--size", "20x20", "--bands", "400:700:9", "--spp", "5",
                       "--backend", "opencl", "--device-memory", "256MiB", "-o", "a.hdr", "--aov", "depth"},
                      {.environment = {{"LD_PRELOAD", SHIM_LIBRARY},
                                       {"ASAN_OPTIONS", "verify_asan_link_order=0"},
                                       {"KILOBAND_SHIM_TYPE", type},
                                       {"KILOBAND_SHIM_GROUP", group}}});
      EXPECT_EQ(outcome.code, 0) << outcome.err;
      return folder.read("a.img");
    };
    const std::string expected = image("0");
    ASSERT_FALSE(expected.empty());
    EXPECT_EQ(image("32"), expected) << type;
  }
}

/// A cache folder of its own, so that every program is built from source.
TEST(OpenclProgram, BuildError) {
  const TemporaryFolder cache;
  Environment environment = with_shim("clBuildProgram", -11, true);
  environment.emplace_back("XDG_CACHE_HOME", cache.path().string());
  expect_failure(environment, "kiloband: device '");
}

fs::path file_of_cache(const TemporaryFolder& cache, std::size_t index) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(cache / "kiloband/programs")) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files.at(index);
}

/// On a driver that calls itself otherwise than PoCL, whose programs are not kept twice.
class CachedPrograms : public ::testing::Test {
 protected:
  void SetUp() override {
    image_ = render({});
    ASSERT_FALSE(image_.empty());
    ASSERT_EQ(render({}), image_);
  }
  /// Bytes of the image; empty after a failure.
  std::string render(Environment environment, const std::string& warning = "") const {
    const TemporaryFolder folder;
    environment.emplace_back("LD_PRELOAD", SHIM_LIBRARY);
    environment.emplace_back("ASAN_OPTIONS", "verify_asan_link_order=0");
    environment.emplace_back("KILOBAND_SHIM_PLATFORM", "Some driver");
    environment.emplace_back("XDG_CACHE_HOME", cache_.path().string());
    const Outcome outcome = run_program(folder, kRender, {.environment = environment});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, warning);
    return outcome.code == 0 ? folder.read("a.img") : "";
  }
  void write(const fs::path& file, const std::string& bytes) const {
    std::ofstream(file, std::ios::binary) << bytes;
  }

  TemporaryFolder cache_;
  std::string image_;
};

/// Built from source instead, and mended: the file is another one, and good enough for the next render to
/// leave it alone. (It need not be the first one: drivers put into a binary what they have compiled by then.)
TEST_F(CachedPrograms, DamagedFilesAreReplaced) {
  const fs::path file = file_of_cache(cache_, 0), other = file_of_cache(cache_, 1);
  const std::string whole = read_file(file);
  std::string flipped = whole;
  flipped[whole.size() / 2] ^= 1;
  for (const std::string& bytes : {std::string(), std::string("x"), whole.substr(0, whole.size() / 2),
                                   flipped, whole + "x", read_file(other)}) {
    write(file, bytes);
    EXPECT_EQ(render({}), image_) << bytes.size();
    const std::string mended = read_file(file);
    EXPECT_NE(mended, bytes);
    EXPECT_GT(mended.size(), whole.size() / 2);
    EXPECT_EQ(render({}), image_);
    EXPECT_EQ(read_file(file), mended);
  }
}

TEST_F(CachedPrograms, RefusedByTheDriver) {
  EXPECT_EQ(render(with_shim("clCreateProgramWithBinary", -42, true)), image_);  // CL_INVALID_BINARY
  EXPECT_EQ(render(with_shim("clBuildProgram", -11, false)), image_);            // the first build only
}

TEST_F(CachedPrograms, FolderThatIsNone) {
  fs::remove_all(cache_ / "kiloband");
  cache_.write("kiloband", "a file");
  EXPECT_EQ(
      render({}, "warning: cannot write '" + (cache_ / "kiloband/programs").string() +
                     "': Not a directory: compiled kernels are not kept, and every run compiles anew\n"),
      image_);
}

/// What it compiles it keeps itself, and binaries cost it as much again.
TEST(OpenclProgram, PoclKeepsItsOwnPrograms) {
  const TemporaryFolder folder, cache;
  const Outcome outcome =
      run_program(folder, kRender, {.environment = {{"XDG_CACHE_HOME", cache.path().string()}}});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_FALSE(fs::exists(cache / "kiloband"));
}

/// PoCL has no device where its folder cannot be written: it gets another one, which is removed.
TEST_F(CachedPrograms, FolderOfTheDriverThatIsNone) {
  const TemporaryFolder folder, temporary;
  const Outcome outcome = run_program(
      folder, kRender,
      {.environment = {{"POCL_CACHE_DIR", "/dev/null/x"}, {"TMPDIR", temporary.path().string()}}});
  EXPECT_EQ(outcome.code, 0);
  const std::string first =
      "warning: PoCL's folder for compiled kernels '/dev/null/x' cannot be written (Not a directory): '" +
      (temporary / "kiloband_pocl_").string();
  ASSERT_EQ(outcome.err.substr(0, first.size()), first);
  EXPECT_EQ(outcome.err.substr(std::min(first.size() + 6, outcome.err.size())),
            "' is used until this program ends, and every run compiles anew; set POCL_CACHE_DIR to a folder "
            "that can be written\n");
  EXPECT_EQ(folder.read("a.img"), image_);
  EXPECT_EQ(temporary.list(), Names{});
}

TEST(OpenclProgram, NoFolderForTheDriver) {
  expect_failure(
      {{"POCL_CACHE_DIR", "/dev/null/x"}, {"TMPDIR", "/dev/null"}},
      "kiloband: no OpenCL device: the OpenCL drivers here have none; PoCL's folder for compiled "
      "kernels '/dev/null/x' cannot be written (Not a directory), and neither can a folder of temporary "
      "files: set POCL_CACHE_DIR to one that can\n");
}

/// PoCL's linker looks there first for a library that its own scripts name. Relative names of the driver's folder
/// still mean the user's.
TEST(OpenclProgram, NothingIsTakenFromTheCurrentFolder) {
  const TemporaryFolder folder;
  folder.write("libgcc_s.so.1", "this is not the library");
  std::filesystem::create_directory(folder / "cache");
  const Outcome outcome = run_program(
      folder, kRender,
      {.environment = {{"POCL_CACHE_DIR", "cache"}, {"XDG_CACHE_HOME", (folder / "own").string()}}});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err, "");
  EXPECT_FALSE(std::filesystem::is_empty(folder / "cache"));
}

}  // namespace
}  // namespace kiloband::test
