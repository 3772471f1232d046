// The render session: whole, streamed and held renders are the same render; when it stops.
#include <algorithm>

#include "post/replicated_cube.hpp"
#include "tests/unit/render/session_fixture.hpp"
#include "tests/unit/render/wrapped_backend.hpp"

namespace kiloband::session_test {
namespace {

TEST_F(SessionTest, StreamedStripsGiveTheBitsOfTheWholeImage) {
  const RenderReport whole = run(*backend(), "whole.hdr");
  EXPECT_FALSE(whole.streamed);
  settings_.memory_budget_bytes = 100000;
  const RenderReport strips = run(*backend(), "strips.hdr");
  EXPECT_TRUE(strips.streamed);
  const test::Cube a = read("whole.hdr"), b = read("strips.hdr");
  expect_same(a.mean, b.mean, 0);
  expect_same(a.variance, b.variance, 0);
  EXPECT_EQ(whole.image_mean.size(), 5u);
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_NEAR(strips.image_mean[k], whole.image_mean[k], 1e-6 * whole.image_mean[k]);
  EXPECT_NEAR(*whole.errors.worst, *strips.errors.worst, 1e-9);
}

// Replicates of more than 16 samples come in parts: 25 here.
TEST_F(SessionTest, StripsGiveTheBitsOfTheWholeImageWithReplicatesInParts) {
  settings_.stop.samples_per_pixel = 50;
  settings_.replicates = 2;
  EXPECT_FALSE(run(*backend(), "whole.hdr").streamed);
  settings_.memory_budget_bytes = 100000;
  EXPECT_TRUE(run(*backend(), "strips.hdr").streamed);
  const test::Cube a = read("whole.hdr"), b = read("strips.hdr");
  expect_same(a.mean, b.mean, 0);
  expect_same(a.variance, b.variance, 0);
  settings_.keep_replicates = true;  // held, in the same parts
  run(*backend(), "kept.hdr");
  expect_same(a.mean, read("kept.hdr").mean, 0);
  // With a checkpoint the parts follow its clock.
  settings_.memory_budget_bytes = std::size_t{1} << 30;
  settings_.checkpoint = folder_ / "render.ck";
  run(*backend(), "held.hdr");
  expect_same(a.mean, read("held.hdr").mean, 0);
  expect_same(a.variance, read("held.hdr").variance, 0);
}

// Blocks are apart by one part at most. The image's mean from 30 % of the samples agrees within 1 %: fixed
// seed; of 5184 x 100 samples whose standard deviation is below their mean that is > 7 standard errors, so
// the error rate is below 1e-11, and a bias of 1.7 % would be seen with the same certainty.
TEST_F(SessionTest, InterruptedLongReplicateLeavesNoPixelWithoutSample) {
  settings_.stop.samples_per_pixel = 400;
  settings_.replicates = 2;
  const RenderReport whole = run(*backend(), "whole.hdr");
  std::atomic<bool> stop{false};
  const RenderReport part =
      run(*backend(), "part.hdr", stop, [&](const Progress& p) { stop = p.fraction > 0.3; });
  EXPECT_TRUE(part.interrupted);
  EXPECT_EQ(part.pixels_without_sample, 0u);
  EXPECT_GE(part.samples_per_pixel, 100u);
  EXPECT_LE(part.largest_samples_per_pixel, part.samples_per_pixel + 16);
  for (const float value : read("part.hdr").mean) ASSERT_TRUE(std::isfinite(value));
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_NEAR(part.image_mean[k], whole.image_mean[k], 0.01 * whole.image_mean[k]);
}

TEST_F(SessionTest, HeldReplicatesInAScratchFileChangeNothing) {
  settings_.checkpoint = folder_ / "memory.ck";
  run(*backend(), "memory.hdr");
  settings_.memory_budget_bytes = 1000;
  settings_.checkpoint = folder_ / "scratch.ck";
  run(*backend(), "scratch.hdr");
  const test::Cube a = read("memory.hdr"), b = read("scratch.hdr");
  expect_same(a.mean, b.mean, 0);
  expect_same(a.variance, b.variance, 0);
}

/// What the header says of replicates is what stands behind each of its variances: here two, of 32 that were wanted.
TEST_F(SessionTest, InterruptedRendersStateTheReplicatesThatTheyHave) {
  settings_.stop.samples_per_pixel = 2048;
  settings_.replicates = 32;
  for (const bool held : {false, true}) {
    settings_.keep_replicates = held;
    std::atomic<bool> stop{false};
    const RenderReport report =
        run(*backend(), "part.hdr", stop, [&](const Progress& p) { stop = p.fraction > 1.5 / 32; });
    ASSERT_GT(report.samples_per_pixel, 64u);
    ASSERT_LT(report.largest_samples_per_pixel, 128u);
    const CubeInfo info = open_cube(folder_ / "part.hdr")->info();
    EXPECT_EQ(info.samples_per_pixel, report.samples_per_pixel);
    EXPECT_EQ(info.replicates, 2u) << held;
  }
}

/// A replicate that has a tenth of the samples has a tenth of the weight.
TEST_F(SessionTest, InterruptedReplicatesAreWeightedByTheirSamples) {
  settings_.stop.samples_per_pixel = 1024;
  settings_.replicates = 3;
  settings_.keep_replicates = true;
  for (const char* name : {"part.hdr", "part.exr"}) {
    std::atomic<bool> stop{false};
    const RenderReport report =
        run(*backend(), name, stop, [&](const Progress& p) { stop = p.fraction > 0.35; });
    ASSERT_GT(report.samples_per_pixel, 342u);
    const ReplicatedCube cube = open_replicated_cube(folder_ / name);
    EXPECT_EQ(cube.samples,
              (std::vector<double>{342, static_cast<double>(report.samples_per_pixel - 342), 0}));
    const test::Cube mean = test::read_cube(*cube.mean);
    const std::vector<double> variances_samples(cube.samples.begin(), cube.samples.begin() + 2);
    const test::Cube a = test::read_cube(*cube.replicates[0]), b = test::read_cube(*cube.replicates[1]);
    EXPECT_EQ(a.info.samples_per_pixel, 342u);
    std::size_t exact = 0;  // pixels of blocks that the last part did not reach: all numbers are as stated
    for (std::size_t i = 0; i < mean.mean.size(); ++i) {
      const double n = cube.samples[1], pooled = (342 * a.mean[i] + n * b.mean[i]) / (342 + n);
      exact += std::abs(pooled - mean.mean[i]) <= 1e-5 * mean.mean[i];
      const double error =
          replicate_error(std::vector<double>{a.mean[i], b.mean[i], std::nan("")}, cube.samples);
      const double alone = replicate_error(std::vector<double>{a.mean[i], b.mean[i]}, variances_samples);
      ASSERT_EQ(error, alone);
    }
    EXPECT_GT(exact, mean.mean.size() / 10);
  }
}

/// Strips are written before it is known that others will not be rendered.
TEST_F(SessionTest, InterruptedStripsStateWhatTheyHave) {
  settings_.stop.samples_per_pixel = 200;
  settings_.replicates = 2;
  settings_.memory_budget_bytes = 100000;
  settings_.keep_replicates = true;
  for (const char* name : {"part.hdr", "part.exr"}) {
    std::atomic<bool> stop{false};
    const RenderReport report =
        run(*backend(), name, stop, [&](const Progress& p) { stop = p.fraction > 0.4; });
    EXPECT_TRUE(report.streamed);
    EXPECT_EQ(report.samples_per_pixel, 0u);
    const CubeInfo info = open_cube(folder_ / name)->info();
    EXPECT_EQ(info.samples_per_pixel, 0u);
    EXPECT_EQ(info.replicates, 2u);
    EXPECT_EQ(info.replicate_samples.size(), 2u);
    EXPECT_GT(info.replicate_samples[0], 0u);
    EXPECT_TRUE(open_replicated_cube(folder_ / name).has_errors());
    EXPECT_EQ(read(name).mean.size(), kSize * kSize * 5u);
  }
  const RenderReport all = run(*backend(), "all.exr");
  EXPECT_TRUE(all.streamed);
  const CubeInfo info = open_cube(folder_ / "all.exr")->info();
  EXPECT_EQ(info.samples_per_pixel, 200u);
  EXPECT_EQ(info.replicate_samples, (std::vector<uint64_t>{100, 100}));
}

TEST_F(SessionTest, InterruptedStripsBecomeNan) {
  settings_.memory_budget_bytes = 100000;
  std::atomic<bool> stop{false};
  const RenderReport report =
      run(*backend(), "part.hdr", stop, [&](const Progress& p) { stop = p.fraction > 0.5; });
  EXPECT_TRUE(report.interrupted);
  EXPECT_GT(report.pixels_without_sample, 0u);
  const test::Cube values = read("part.hdr");
  EXPECT_TRUE(std::isfinite(values.mean.front()));
  EXPECT_TRUE(std::isnan(values.mean.back()));
  const auto missing = std::ranges::count_if(values.mean, [](float v) { return std::isnan(v); });
  EXPECT_EQ(static_cast<uint64_t>(missing), 5 * report.pixels_without_sample);
}

/// Asks for a stop as soon as something is written: auxiliary images are rendered then.
class StopAtWriting final : public test::WrappedBackend {
 public:
  StopAtWriting(std::unique_ptr<Backend> backend, std::atomic<bool>& stop)
      : WrappedBackend(std::move(backend)), stop_(stop) {}
  std::vector<AuxiliaryPixel> auxiliary(const PixelRect& rect) override {
    stop_ = true;
    return WrappedBackend::auxiliary(rect);
  }

 private:
  std::atomic<bool>& stop_;
};

TEST_F(SessionTest, ARenderThatIsCompleteIsNotInterruptedAsItIsWritten) {
  settings_.aux = {"depth"};
  std::atomic<bool> stop{false};
  StopAtWriting renderer(backend(), stop);
  const RenderReport whole = run(renderer, "whole.hdr", stop);
  EXPECT_TRUE(stop);
  EXPECT_FALSE(whole.interrupted);
  EXPECT_EQ(whole.ended_by, StopReason::kSamples);

  settings_.memory_budget_bytes = 100000;
  stop = false;
  const RenderReport strips = run(renderer, "strips.hdr", stop);
  EXPECT_TRUE(strips.streamed);
  EXPECT_TRUE(strips.interrupted) << "the strips after the first are missing";
  EXPECT_EQ(strips.ended_by, StopReason::kInterrupt);
  EXPECT_GT(strips.pixels_without_sample, 0u);
}

}  // namespace
}  // namespace kiloband::session_test
