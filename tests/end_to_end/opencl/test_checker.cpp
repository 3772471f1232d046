// The kernels under Oclgrind, an interpreter of OpenCL that reports every access outside a buffer and every
// data race between work-items. It is slow, so 4 x 4 pixels with 2 samples are rendered;
// scripts/check_kernels.sh runs all scenes of the zoo (KILOBAND_CHECK_ALL=1), ctest the first few.
//
// Its search for uninitialised values is not used: Oclgrind 21.10 does not know LLVM's `freeze` there and
// reports what was copied by struct. Kernels are built without inlining,
// as it knows no noalias scopes either.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/end_to_end/support/program.hpp"
#include "tests/support/effort.hpp"
#include "tests/support/zoo/scene_zoo.hpp"

namespace kiloband::test {
namespace {

struct Check {
  std::string scene;
  std::vector<std::string> options;
};

std::vector<Check> checks() {
  std::vector<Check> all{{"plastics", {"--method", "dpept-batch"}},
                         {"hidden_emitters", {"--method", "dpept-path", "--wavelengths", "per-path"}},
                         {"prism", {"--method", "pt"}}};
  if (!std::getenv("KILOBAND_CHECK_ALL")) return all;
  const std::vector<std::vector<std::string>> variants{
      {"--method", "dpept-batch", "--wavelengths", "per-path"},
      {"--method", "dpept-path"},
      {"--method", "pt"},
      {"--method", "dpept-batch"}};
  std::size_t variant = 0;
  for (const ZooScene& scene : scene_zoo()) {
    if (scene.name == "crop_window") continue;  // takes no --size, and has no kernel code of its own
    all.push_back({scene.name, variants[variant++ % variants.size()]});
  }
  return all;
}

TEST(Checker, NoReports) {
  if (kAddressSanitizer || kThreadSanitizer)
    GTEST_SKIP() << "Oclgrind is preloaded: the sanitizer comes first";
  const ZooFolder zoo;
  for (const Check& check : checks()) {
    const TemporaryFolder folder;  // also for the programs: Oclgrind's are not those of other devices
    std::filesystem::copy(zoo.path(), folder.path(), std::filesystem::copy_options::recursive);
    folder.write("scene.xml", zoo_scene(check.scene).xml);
    folder.write("camera.csv", "wavelength_nm,wide,narrow\n450,0.2,0\n550,1,0.5\n650,0.3,0\n");
    std::vector<std::string> arguments{
        "render",     "scene.xml", "--quiet",      "--bands", "450:650:5",   "--spp", "2",
        "--backend",  "opencl",    "--size",       "4x4",     "--max-depth", "5",     "--response",
        "camera.csv", "--aov",     "depth,normal", "-o",      "a.exr"};
    arguments.insert(arguments.end(), check.options.begin(), check.options.end());
    const Outcome outcome =
        run_program(folder, arguments,
                    {.environment = {{"XDG_CACHE_HOME", folder.path().string()}},
                     .under = {"oclgrind", "--data-races", "--build-options",
                               "-DKB_UNDER_OCLGRIND=1 -fno-inline", "--log", (folder / "reports").string()}});
    EXPECT_EQ(outcome.code, 0) << check.scene << "\n" << outcome.err;
    EXPECT_EQ(folder.read("reports"), "") << check.scene;
    EXPECT_TRUE(std::filesystem::exists(folder / "a.exr")) << check.scene;
  }
}

}  // namespace
}  // namespace kiloband::test
