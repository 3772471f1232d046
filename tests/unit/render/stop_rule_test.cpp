// What ends a render: samples, time, a target error, and which came first.
#include "tests/unit/render/session_fixture.hpp"

namespace kiloband::stop_rule_test {
namespace {

TEST_F(SessionTest, TargetErrorIsReached) {
  settings_.stop = {};
  settings_.stop.relative_error = 0.005;
  std::vector<double> fractions;
  const RenderReport report =
      run(*backend(), "error.hdr", false, [&](const Progress& p) { fractions.push_back(p.fraction); });
  EXPECT_LE(*report.errors.worst, 0.005);
  EXPECT_GT(*report.errors.worst, 0.0005);  // and not by rendering for ever
  EXPECT_EQ(report.ended_by, StopReason::kError);
  // The progress is an estimate on the way, and whole at the end alone.
  EXPECT_EQ(fractions.front(), 0);
  EXPECT_EQ(fractions.back(), 1);
  fractions.pop_back();
  EXPECT_LE(*std::ranges::max_element(fractions), 0.99);
  EXPECT_GT(std::ranges::count_if(fractions, [](double f) { return f > 0.1 && f < 0.9; }), 0)
      << ::testing::PrintToString(fractions);
}

TEST_F(SessionTest, TargetErrorGivesUpOnABlackImage) {
  scene_.camera.to_world[11] = 1e6f;  // far behind everything; the constant light goes too
  for (SpectrumRow& row : scene_.spectra) {
    for (double& value : row.table.values) value = 0;
  }
  settings_.stop = {};
  settings_.stop.relative_error = 0.02;
  const RenderReport report = run(*backend(), "black.hdr");
  EXPECT_FALSE(report.errors.worst);
  EXPECT_LE(report.samples_per_pixel, 2048u);
  EXPECT_EQ(report.ended_by, StopReason::kDark);
  EXPECT_EQ(report.errors.dark_bands, 5u);
}

/// 37 samples are dealt to 16 replicates as without a target: 5 of 3, 11 of 2, whatever ends the render.
TEST_F(SessionTest, SamplesAndTimeLimitATargetError) {
  settings_.stop = {.samples_per_pixel = 37, .relative_error = 1e-9};
  const RenderReport capped = run(*backend(), "capped.hdr");
  EXPECT_EQ(capped.ended_by, StopReason::kSamples);
  EXPECT_EQ(capped.samples_per_pixel, 37u);
  EXPECT_EQ(capped.replicates, 16u);
  EXPECT_GT(*capped.errors.worst, 1e-9);
  settings_.stop = {.samples_per_pixel = 37};
  const RenderReport fixed = run(*backend(), "fixed.hdr");
  EXPECT_EQ(fixed.ended_by, StopReason::kSamples);
  EXPECT_NEAR(*capped.errors.worst, *fixed.errors.worst, 1e-5 * *fixed.errors.worst);
  EXPECT_EQ(capped.errors.worst_band, fixed.errors.worst_band);
  expect_same(read("fixed.hdr").mean, read("capped.hdr").mean, 5e-7);
  settings_.stop = {.seconds = 0.2, .relative_error = 1e-9};
  settings_.variance = false;
  const RenderReport timed = run(*backend(), "timed.hdr");
  EXPECT_EQ(timed.ended_by, StopReason::kTime);
  EXPECT_TRUE(timed.errors.worst) << "that of the end, not of the last whole pass";
  settings_.stop = {.samples_per_pixel = 1u << 20, .seconds = 3600, .relative_error = 0.05};
  EXPECT_EQ(run(*backend(), "error.hdr").ended_by, StopReason::kError);
}

/// A channel without light ends no render and holds none up; one of little light counts like any other.
TEST_F(SessionTest, DarkChannelsAreLeftOutOfTheError) {
  for (SpectrumRow& row : scene_.spectra) {
    if (!row.is_emission) continue;
    row.table = {400, 60, {1, 1, 0, 0, 1, 1}};
    row.table.values[5] = 1e-9;
  }
  settings_.stop = {.samples_per_pixel = 4096, .relative_error = 0.05};
  const RenderReport report = run(*backend(), "dark.hdr");
  EXPECT_EQ(report.ended_by, StopReason::kError);
  EXPECT_EQ(report.errors.dark_bands, 1u);
  EXPECT_NE(report.errors.worst_band, 2u);
}

TEST_F(SessionTest, TimeLimitIsKept) {
  settings_.stop = {};
  settings_.stop.seconds = 0.3;
  const RenderReport report = run(*backend(), "time.hdr");
  EXPECT_GE(report.sampling_seconds, 0.29);
  EXPECT_GE(report.samples_per_pixel, 1u);
  EXPECT_FALSE(report.interrupted);
}

}  // namespace
}  // namespace kiloband::stop_rule_test
