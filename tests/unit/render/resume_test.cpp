// Interrupted and resumed, extended and timed renders have the bits of one that was rendered at one go.
#include "render/checkpoint/checkpoint.hpp"
#include "tests/unit/render/session_fixture.hpp"

namespace kiloband::resume_test {
namespace {

TEST_F(SessionTest, InterruptedAndResumedHasTheBitsOfUninterrupted) {
  const RenderReport once = run(*backend(), "once.hdr");
  settings_.checkpoint = folder_ / "render.ck";
  settings_.resume = true;
  std::atomic<bool> stop{false};
  const RenderReport first =
      run(*backend(), "part.hdr", stop, [&](const Progress& p) { stop = p.fraction > 0.4; });
  EXPECT_TRUE(first.interrupted);
  EXPECT_LT(first.samples_per_pixel, 40u);
  EXPECT_EQ(open_cube(folder_ / "part.hdr")->info().samples_per_pixel, first.samples_per_pixel);
  const auto fresh = backend();
  const RenderReport second = run(*fresh, "resumed.hdr");
  EXPECT_FALSE(second.interrupted);
  EXPECT_GT(second.resumed_samples, 0u);
  EXPECT_EQ(second.resumed_samples + fresh->statistics().paths, std::size_t{kSize} * kSize * 40);
  EXPECT_EQ(second.samples_per_pixel, 40u);
  const test::Cube a = read("once.hdr"), b = read("resumed.hdr");
  expect_same(a.mean, b.mean, 0);
  expect_same(a.variance, b.variance, 0);
  EXPECT_EQ(once.image_mean, second.image_mean);
}

TEST_F(SessionTest, ResumeExtendsARender) {
  settings_.stop.samples_per_pixel = 96;
  run(*backend(), "once.hdr");
  settings_.stop.samples_per_pixel = 32;
  settings_.checkpoint = folder_ / "render.ck";
  run(*backend(), "short.hdr");
  settings_.resume = true;
  settings_.stop.samples_per_pixel = 96;
  const RenderReport extended = run(*backend(), "long.hdr");
  EXPECT_EQ(extended.resumed_samples, std::size_t{kSize} * kSize * 32);
  expect_same(read("once.hdr").mean, read("long.hdr").mean, 0);
  expect_same(read("once.hdr").variance, read("long.hdr").variance, 0);
}

// A time limit leaves replicates as even as it can; what they lack of --spp is rendered.
TEST_F(SessionTest, ATimedRenderExtendedHasTheBitsOfOneInOneGo) {
  settings_.stop.samples_per_pixel = 320;
  run(*backend(), "once.hdr");
  settings_.checkpoint = folder_ / "render.ck";
  settings_.stop = {};
  settings_.stop.seconds = 0.02;
  const RenderReport timed = run(*backend(), "timed.hdr");
  ASSERT_LT(timed.largest_samples_per_pixel, 320u);
  settings_.resume = true;
  settings_.stop = {};
  settings_.stop.samples_per_pixel = 320;
  EXPECT_GT(run(*backend(), "long.hdr").resumed_samples, 0u);
  expect_same(read("once.hdr").mean, read("long.hdr").mean, 0);
  expect_same(read("once.hdr").variance, read("long.hdr").variance, 0);
}

TEST_F(SessionTest, AnInterruptedTargetErrorEndsWhereItWouldHave) {
  settings_.stop = {};
  settings_.stop.relative_error = 0.01;
  const RenderReport once = run(*backend(), "once.hdr");
  ASSERT_GT(once.samples_per_pixel, 32u);
  settings_.checkpoint = folder_ / "render.ck";
  settings_.resume = true;
  const uint64_t pixels = std::size_t{kSize} * kSize;
  for (uint64_t part = 1; part <= 3; ++part) {  // in the middle of passes
    std::atomic<bool> stop{false};
    run(*backend(), "part.hdr", stop,
        [&](const Progress& p) { stop = p.pixel_samples > part * once.samples_per_pixel * pixels / 5; });
  }
  const RenderReport resumed = run(*backend(), "resumed.hdr");
  EXPECT_EQ(resumed.samples_per_pixel, once.samples_per_pixel);
  expect_same(read("once.hdr").mean, read("resumed.hdr").mean, 0);
  expect_same(read("once.hdr").variance, read("resumed.hdr").variance, 0);
}

/// Fewer samples than the checkpoint has, too few for its replicates even: all that it has is written.
TEST_F(SessionTest, FewerSamplesThanTheCheckpointHas) {
  settings_.stop.samples_per_pixel = 64;
  settings_.checkpoint = folder_ / "render.ck";
  const RenderReport once = run(*backend(), "once.hdr");
  settings_.resume = settings_.replicates_fixed = true;
  for (const uint64_t samples : {48u, 8u, 1u}) {
    settings_.stop.samples_per_pixel = samples;
    double most = 0;
    const RenderReport report =
        run(*backend(), "again.hdr", false, [&](const Progress& p) { most = std::max(most, p.fraction); });
    EXPECT_EQ(report.replicates, once.replicates);
    EXPECT_EQ(report.samples_per_pixel, 64u);
    EXPECT_LE(most, 1.0);
    expect_same(read("once.hdr").mean, read("again.hdr").mean, 0);
    expect_same(read("once.hdr").variance, read("again.hdr").variance, 0);
  }
}

/// In the first pass to a limit below what one replicate has already: no more than all is done.
TEST_F(SessionTest, ProgressEndsAtAll) {
  settings_.stop.samples_per_pixel = 640;
  settings_.checkpoint = folder_ / "render.ck";
  std::atomic<bool> stop{false};
  run(*backend(), "part.hdr", stop, [&](const Progress& p) { stop = p.fraction > 0.2; });
  settings_.resume = settings_.replicates_fixed = true;
  settings_.stop.samples_per_pixel = 64;
  double most = 0;
  run(*backend(), "rest.hdr", false, [&](const Progress& p) { most = std::max(most, p.fraction); });
  EXPECT_EQ(most, 1.0);
}

/// What is done already ends as it ended, with the limit of samples at no power of two of them.
TEST_F(SessionTest, ATargetErrorThatIsReachedStaysReached) {
  settings_.stop = {.samples_per_pixel = 96, .relative_error = 1e-9};
  settings_.checkpoint = folder_ / "render.ck";
  const RenderReport missed = run(*backend(), "once.hdr");
  EXPECT_EQ(missed.ended_by, StopReason::kSamples);
  settings_.resume = true;
  settings_.stop.relative_error = 1.001 * *missed.errors.worst;  // what 96 samples reach
  const RenderReport resumed = run(*backend(), "again.hdr");
  EXPECT_EQ(resumed.samples_per_pixel, 96u);
  EXPECT_EQ(resumed.ended_by, StopReason::kError);
}

// The folder goes while the render runs, and comes back: one warning, and the next checkpoint is written.
TEST_F(SessionTest, ACheckpointThatCannotBeWrittenIsAWarning) {
  settings_.stop.samples_per_pixel = 96;
  const std::filesystem::path gone = folder_ / "gone";
  settings_.checkpoint = gone / "render.ck";
  settings_.checkpoint_interval_seconds = 0.002;
  test::Messages messages;
  const std::vector<std::string>& said = messages.texts;
  settings_.sink = messages.lines();
  const RenderReport report = run(*backend(), "image.hdr");
  EXPECT_EQ(report.samples_per_pixel, 96u);
  const std::string reason = "warning: checkpoint: cannot write '" + settings_.checkpoint->string() +
                             "': No such file or directory: ";
  ASSERT_EQ(said.size(), 2u) << testing::PrintToString(said);
  EXPECT_EQ(said[0], reason + "the render goes on, the next attempt follows in 0.002 s");
  EXPECT_EQ(said[1], reason + "this render has none, only its image");
  messages.texts.clear();
  run(*backend(), "again.hdr", false, [&](const Progress& p) {
    if (p.fraction > 0.5) std::filesystem::create_directories(gone);
  });
  EXPECT_EQ(said.size(), 1u) << testing::PrintToString(said);
  EXPECT_EQ(checkpoint_outline(*settings_.checkpoint).pixel_samples, std::size_t{kSize} * kSize * 96);
  expect_same(read("image.hdr").mean, read("again.hdr").mean, 0);
}

}  // namespace
}  // namespace kiloband::resume_test
