// Scenes of other people, unmodified, where the data folder is present.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tests/end_to_end/support/program.hpp"

namespace kiloband::test {
namespace {

std::filesystem::path data_folder() {
  const char* folder = std::getenv("KILOBAND_DATA");
  const std::filesystem::path path = folder ? folder : KILOBAND_SOURCE_DIR "/../shared/data";
  return std::filesystem::exists(path) ? path : std::filesystem::path();
}

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

}  // namespace
}  // namespace kiloband::test
