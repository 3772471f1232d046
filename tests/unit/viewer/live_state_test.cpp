// The render behind a page step by step, on this thread: what comes between two pieces of work is exactly known.
#include "viewer/live/live_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>
#include <utility>

#include "tests/unit/viewer/live_wall.hpp"

namespace kiloband::test::live_state_test {
namespace {

using namespace viewer;
using nlohmann::json;

class LiveStateTest : public testing::Test {
 protected:
  void start(LiveOptions options) { state_.emplace(std::move(options), interrupt_); }
  /// Until there is nothing left to do.
  void work(double most_s = 60) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(most_s);
    while (state_->work() && Clock::now() < end) {
    }
  }

  std::atomic<bool> interrupt_{false};
  std::optional<LiveState> state_;
};

TEST_F(LiveStateTest, TheCameraIsResetBeforeAChangeIsCompiled) {
  start(wall_options(4));
  work();
  for (const char* const change : {"settings", "spectrum"}) {
    state_->set_camera({{"origin", {1, 0, 4}}, {"target", {1, 0, 0}}});
    if (change == std::string("settings"))
      state_->set_settings({{"max_depth", 2}});
    else
      state_->set_spectrum({{"id", "s0"}, {"set", {{"constant", 0.25}}}});
    EXPECT_FALSE(state_->is_ready());
    state_->set_camera({{"reset", true}});
    work();
    EXPECT_EQ(state_->status().state, "done") << state_->status().message;
    const json camera = state_->scene_json()["camera"];
    EXPECT_EQ(camera["origin"], json({0.0, 0.0, 4.0})) << change;
    EXPECT_NEAR(camera["target"][2].get<double>(), 0, 1e-3) << "the wall in the middle";
  }
}

/// A page that was closed while it moved the camera tells nobody that the movement has ended.
TEST_F(LiveStateTest, ACameraThatIsLeftMovingIsSeenAtFullSize) {
  start(wall_options(5));
  work();
  const uint64_t before = state_->status().newest.revision;
  state_->set_camera({{"origin", {1, 0, 4}}, {"moving", true}});
  state_->work();
  EXPECT_EQ(state_->film()->width(), 20u);
  uint64_t most = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (state_->work() && std::chrono::steady_clock::now() < end)
    most = std::max(most, state_->status().newest.samples);
  EXPECT_LE(most, 5u) << "no more samples than were asked for";
  EXPECT_EQ(state_->film()->width(), 40u);
  EXPECT_EQ(state_->status().state, "done");
  EXPECT_EQ(state_->status().newest.samples, 5u);
  EXPECT_EQ(state_->status().newest.revision, before + 2) << "one of each size";
  EXPECT_EQ(state_->scene_json()["camera"]["origin"], json({1.0, 0.0, 4.0}));
}

}  // namespace
}  // namespace kiloband::test::live_state_test
