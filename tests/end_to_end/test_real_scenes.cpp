// Scenes of other people, unmodified, where the data folder is present.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/end_to_end/support/program.hpp"
#include "tests/support/data_folder.hpp"

namespace kiloband::test {
namespace {

/// Renders a scene of the data folder at 24 x 18 pixels and expects finite values that are not all black.
void expect_renders(const std::string& scene, const std::vector<std::string>& more) {
  if (data_folder().empty() || !std::filesystem::exists(data_folder() / scene)) return;
  const TemporaryFolder folder;
  std::vector<std::string> options{"--size", "24x18", "--spp", "4",         "-o",
                                   "a.exr",  "-o",    "a.hdr", "--preview", "a.png"};
  options.insert(options.end(), more.begin(), more.end());
  const Outcome outcome = run_program(folder, quiet_render((data_folder() / scene).string(), options));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("error"), std::string::npos) << outcome.err;
  const Cube cube = read_cube(folder / "a.hdr");
  double sum = 0;
  for (const float value : cube.mean) sum += value;
  EXPECT_TRUE(std::isfinite(sum)) << scene;
  EXPECT_GT(sum, 0) << scene;
}

TEST(RealScenes, SpectralCornellBox) {
  expect_renders("scenes/mitsuba/cbox/cbox-spectral.xml", {"--bands", "400:700:100"});
}

TEST(RealScenes, MaterialPreview) {
  expect_renders("scenes/mitsuba/matpreview/matpreview.xml", {});
}

TEST(RealScenes, MultipleImportanceSampling) {
  expect_renders("scenes/veach_mi/mi.xml", {});
}

/// Meshes, environments and measured spectra of other people in scenes of ours, in 200 channels and more.
class RealInputs : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, RealInputs,
                         testing::Values("f16", "conference", "dragon", "buddha", "lucy", "suzanne"),
                         [](const auto& scene) { return scene.param; });

TEST_P(RealInputs, RenderOnBothBackends) {
  if (data_folder().empty()) GTEST_SKIP() << "no folder of public data";
  const TemporaryFolder folder;
  const std::string scene = KILOBAND_SOURCE_DIR "/validation/scenes/real/" + std::string(GetParam()) + ".xml";
  for (const std::string backend : {"cpu", "opencl"}) {
    SCOPED_TRACE(backend);
    const Outcome outcome = run_program(
        folder, quiet_render(scene, {"-D", "data=" + data_folder().string(), "--backend", backend, "--size",
                                     "24x18", "--spp", "4", "-o", "a.hdr", "--stats", "a.json"}));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Cube cube = read_cube(folder / "a.hdr");
    EXPECT_GE(cube.info.bands.size(), 200u);
    EXPECT_EQ(read_json(folder, "a.json")["invalid_samples"], 0);
    double sum = 0;
    for (const float value : cube.mean) sum += value;
    EXPECT_TRUE(std::isfinite(sum));
    EXPECT_GT(sum, 0);
  }
}

}  // namespace
}  // namespace kiloband::test
