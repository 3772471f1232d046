// The scenes of scenes/analytic, rendered as a user renders them and compared
// with the closed forms that they state.
//
// Each scene's comment names its channels and the expected channel values. The mean over the image is
// compared by a t-test over the means of the 16 replicates, which are independent. All comparisons together
// raise a false alarm with probability 1e-4 at most; each detects a bias of 3 % with probability 0.9
// (checked), most a far smaller one. Fixed seed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/end_to_end/support/program.hpp"
#include "tests/support/render_harness.hpp"
#include "validation/suite/case.hpp"

namespace kiloband::test {
namespace {

namespace fs = std::filesystem;

constexpr double kErrorRate = 1e-4, kLargestBias = 0.03, kRounding = 2e-5;
constexpr std::size_t kComparisons = 60;

std::vector<fs::path> analytic_scenes() {
  std::vector<fs::path> scenes;
  for (const auto& entry : fs::directory_iterator(KILOBAND_SOURCE_DIR "/scenes/analytic")) {
    if (entry.path().extension() == ".xml") scenes.push_back(entry.path());
  }
  std::sort(scenes.begin(), scenes.end());
  return scenes;
}

/// Mean over the image of every channel.
std::vector<double> image_means(const fs::path& file) {
  const Cube cube = read_cube(file);
  std::vector<double> means;
  for (std::size_t band = 0; band < cube.info.bands.size(); ++band) {
    double sum = 0;
    for (std::size_t pixel = 0; pixel < cube.pixels(); ++pixel)
      sum += cube.mean[pixel * cube.info.bands.size() + band];
    means.push_back(sum / static_cast<double>(cube.pixels()));
  }
  return means;
}

/// samples: of one channel, a value per replicate.
void expect_mean_of(const std::vector<double>& samples, double expected) {
  const auto count = static_cast<double>(samples.size());
  double mean = 0, squares = 0;
  for (const double s : samples) mean += s / count;
  for (const double s : samples) squares += (s - mean) * (s - mean);
  const double error = std::sqrt(squares / (count - 1) / count);
  const auto replicates = static_cast<uint32_t>(samples.size());
  const double limit = critical_t(kErrorRate, kComparisons, replicates),
               power = critical_t(0.2, 1, replicates);
  EXPECT_LE(std::fabs(mean - expected), limit * error + kRounding * expected)
      << mean << " instead of " << expected;
  EXPECT_LE((limit + power) * error, kLargestBias * expected) << "the test would not see a bias of 3 %";
}

TEST(AnalyticScenes, ShowWhatTheyState) {
  std::size_t comparisons = 0;
  for (const fs::path& scene : analytic_scenes()) {
    SCOPED_TRACE(scene.filename().string());
    const TemporaryFolder folder;
    const Outcome outcome = run_program(
        folder, quiet_render(scene.string(),
                             {"-o", "a.hdr", "--keep-replicates", "--seed", "7", "--stats", "a.json"}));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(read_json(folder, "a.json")["invalid_samples"], 0);
    const std::size_t channels = read_cube(folder / "a.hdr").info.bands.size();
    const std::vector<double> expected = validation::read_closed_form(scene, channels).values;
    std::vector<std::vector<double>> samples(expected.size());
    for (const std::string& name : folder.list()) {
      if (!name.starts_with("a.r") || !name.ends_with(".hdr")) continue;
      const std::vector<double> means = image_means(folder / name);
      ASSERT_EQ(means.size(), expected.size()) << "channels and expected values do not match";
      for (std::size_t c = 0; c < means.size(); ++c) samples[c].push_back(means[c]);
    }
    for (std::size_t c = 0; c < expected.size(); ++c, ++comparisons) {
      SCOPED_TRACE("channel " + std::to_string(c));
      ASSERT_EQ(samples[c].size(), 16u);
      expect_mean_of(samples[c], expected[c]);
    }
  }
  EXPECT_GE(comparisons, 27u);
  EXPECT_LE(comparisons, kComparisons);
}

}  // namespace
}  // namespace kiloband::test
