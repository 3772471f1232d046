// The render behind a page step by step, on this thread: what comes between two pieces of work is exactly known.
#include "viewer/live/live_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "tests/support/messages.hpp"
#include "tests/unit/render/wrapped_backend.hpp"
#include "tests/unit/viewer/live_wall.hpp"
#include "viewer/api/selections.hpp"

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

/// Of a wall whose radiance grows within every channel, seen in one block of shared wavelengths.
Curve block_of_slopes(WavelengthMode wavelengths, uint64_t seed, const std::string& place) {
  std::string text = kWallScene;
  const std::string even = "<spectrum name='radiance' value='1'/>";
  text.replace(text.find(even), even.size(), "<spectrum name='radiance' value='500:0.1, 600:1'/>");
  LiveOptions options = wall_options(31, text);
  options.settings.sampling.wavelengths = wavelengths;
  options.settings.sampling.seed = seed;
  const std::atomic<bool> interrupt{false};
  LiveState state(std::move(options), interrupt);
  while (state.work()) {
  }
  return read_curves(*state.film(), parse_selections(place, 40, 36), 40, 36, 2).front();
}

/// Scatter over 10 seeds against the errors: where these are right, more than 2.5 times as much has a chance below 10^-8 per
/// channel (chi-squared, 9 degrees of freedom). With shared wavelengths, errors that are taken as independent are 3 to 4
/// times too small here, and up to 28 times where a scene has no other noise: there are none.
TEST_F(LiveStateTest, ErrorsOfRectanglesAreNotTooSmall) {
  constexpr uint64_t kSeeds = 10;
  std::vector<Curve> curves;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed)
    curves.push_back(block_of_slopes(WavelengthMode::kPerPath, seed, "0,0,31,31"));
  for (std::size_t k = 0; k < curves[0].mean.size(); ++k) {
    double mean = 0, scatter = 0, error = 0;
    for (const Curve& curve : curves) mean += curve.mean[k] / kSeeds;
    for (const Curve& curve : curves) {
      scatter += (curve.mean[k] - mean) * (curve.mean[k] - mean) / (kSeeds - 1);
      error += curve.standard_error[k] * curve.standard_error[k] / kSeeds;
    }
    EXPECT_LT(std::sqrt(scatter / error), 2.5) << "channel " << k;
  }
  const auto shared = [](const char* place) { return block_of_slopes(WavelengthMode::kShared, 1, place); };
  EXPECT_TRUE(std::isnan(shared("0,0,31,31").standard_error[0])) << "none rather than a wrong one";
  EXPECT_GT(shared("5,5").standard_error[0], 0) << "of one pixel";
}

/// As scene files are looked at: all of the data, whatever the channels are.
TEST_F(LiveStateTest, EditsAreRightForAllChannels) {
  LiveOptions options = wall_options(4);
  std::string text = kWallScene;
  const std::string paint = "<bsdf type='diffuse' id='paint'>";
  text.replace(
      text.find(paint), paint.size(),
      "<bsdf type='plastic' id='paint'/></shape><shape type='sphere'><bsdf type='dielectric' id='ball'/>"
      "</shape><shape type='sphere'><bsdf type='diffuse' id='grey'>");
  options.scene = read_scene_text(text, "wall.xml", ".");
  start(std::move(options));
  work();
  ASSERT_EQ(state_->status().state, "done") << state_->status().message;
  const auto refused = [&](const std::string& owner, const json& value) {
    std::string id;
    const json scene = state_->scene_json();
    for (const json& spectrum : scene["spectra"])
      if (spectrum["owner"] == owner) id = spectrum["id"];
    return error_of([&] { state_->set_spectrum({{"id", id}, {"set", value}}); });
  };
  EXPECT_EQ(refused("bsdf 'grey'", {{"file_text", "400 0.5\n700 0.5\n900 3.0\n"}}),
            "reflectance of bsdf 'grey': 0 to 3: must be from 0 to 1");
  EXPECT_EQ(refused("emitter 'sky'", {{"file_text", "400 0.5\n700 0.5\n900 -1\n"}}).substr(0, 32),
            "radiance of emitter 'sky': -1 to");
  EXPECT_EQ(refused("bsdf 'ball'", {{"file_text", "400 1.5\n700 1.5\n"}}), "accepted");
  work();
  const uint64_t revision = state_->status().newest.revision;
  EXPECT_EQ(
      error_of([&] {
        state_->set_settings({{"bands", "400:900:5"}});
      }),
      "index of refraction inside of bsdf 'ball': 0 to 1.5 over the channels: must be above 0 and below 100 "
      "(outside its data an index is 0)");
  EXPECT_EQ(state_->status().newest.revision, revision);
  EXPECT_EQ(state_->status().state, "done") << "nothing has changed";
  EXPECT_TRUE(state_->is_ready());
}

/// So that an image that was changed does not pass as the scene file's.
/// A wall of reflectance 0.5 under 1 W m^-2 sr^-1 nm^-1 is 0.5 times a response's integral over the channels.
TEST_F(LiveStateTest, ResponsesOfAFilmAreShown) {
  LiveOptions options = wall_options(16);
  const Spectrum box = Spectrum::tabulated({520, 560}, {0.25, 0.25});
  options.derived = {{"box"}, {resample(box, 500, 600)}, {{520, 560, "box"}}};
  start(std::move(options));
  work();
  ASSERT_EQ(state_->status().state, "done") << state_->status().message;
  const json channels = state_->scene_json()["channels"];
  ASSERT_EQ(channels.size(), 5u);
  EXPECT_EQ(channels[4]["name"], "box");
  EXPECT_EQ(channels[4]["derived"], true);
  const Curve curve = read_curves(*state_->film(), {{"", 0, 0, 39, 35}}, 40, 36, 2).front();
  EXPECT_NEAR(curve.mean[0], 0.5, 5 * curve.standard_error[0]);
  EXPECT_NEAR(curve.mean[4], 0.5 * 0.25 * 40, 5 * curve.standard_error[4]);
  EXPECT_LT(curve.standard_error[4], 0.1);
  state_->set_settings({{"bands", "500:600:4"}});
  work();
  EXPECT_EQ(state_->scene_json()["channels"].size(), 4u) << "as with --bands";
}

TEST_F(LiveStateTest, ASavedCubeSaysWhatItIsOf) {
  start(wall_options(4));
  work();
  EXPECT_FALSE(state_->metadata().contains("edited"));
  EXPECT_EQ(state_->metadata()["max_depth"], "3");
  EXPECT_EQ(state_->metadata()["method"], "dpept-batch");
  EXPECT_EQ(state_->metadata()["software"].substr(0, 9), "kiloband ");
  state_->set_spectrum({{"id", "s0"}, {"set", {{"constant", 0.25}}}});
  state_->set_spectrum({{"id", "s1"}, {"set", {{"scale", 3}}}});
  state_->set_settings({{"max_depth", 2}});
  work();
  EXPECT_EQ(state_->metadata()["edited"],
            "reflectance of bsdf 'paint' = 0.25; radiance of emitter 'sky' x 3");
  EXPECT_EQ(state_->metadata()["max_depth"], "2");
  state_->set_spectrum({{"id", "s1"}, {"set", {{"file_text", "400 1\n700 1\n"}}}});
  state_->set_spectrum({{"id", "s0"}, {"set", {{"reset", true}}}});
  EXPECT_EQ(state_->metadata()["edited"], "radiance of emitter 'sky': a table");
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

/// It could be neither saved nor seen whole until the render went on.
TEST_F(LiveStateTest, APausedCameraThatIsLeftMovingGetsItsFullSize) {
  start(wall_options(5));
  work();
  state_->pause(true);
  state_->set_camera({{"origin", {1, 0, 4}}, {"moving", true}});
  EXPECT_EQ(state_->film()->width(), 20u);
  work();
  EXPECT_EQ(state_->film()->width(), 40u);
  EXPECT_EQ(state_->status().state, "paused");
  EXPECT_TRUE(state_->status().blank);
  state_->pause(false);
  work();
  EXPECT_EQ(state_->status().newest.samples, 5u);
}

/// A backend that is interrupted as soon as it has rendered all that it was given, from some call on.
class LateInterrupt final : public WrappedBackend {
 public:
  LateInterrupt(std::unique_ptr<Backend> backend, std::atomic<bool>& interrupt)
      : WrappedBackend(std::move(backend)), interrupt_(interrupt) {}

  void render(SpectralFilm& film, const SampleRange& range, const std::vector<uint32_t>& blocks,
              const std::atomic<bool>& stop, const std::function<void(uint64_t)>& progress) override {
    WrappedBackend::render(film, range, blocks, stop, progress);
    interrupt_ = true;
  }

 private:
  std::atomic<bool>& interrupt_;
};

/// The small film was shown in its place, without a word that it is another image.
TEST_F(LiveStateTest, ARefusedStepOfAMovingCameraLeavesTheImage) {
  start(wall_options(5));
  work();
  const ViewStatus before = state_->status();
  EXPECT_THROW(state_->set_camera({{"origin", {2e9, 0, 0}}, {"target", {0, 0, 0}}, {"moving", true}}),
               InputError);
  EXPECT_EQ(state_->film()->width(), 40u);
  EXPECT_FALSE(state_->work()) << "it was done";
  EXPECT_EQ(state_->status().newest.revision, before.newest.revision);
  EXPECT_EQ(state_->status().newest.samples, before.newest.samples);
  EXPECT_EQ(state_->scene_json()["camera"]["origin"], json({0.0, 0.0, 4.0}));
}

/// A change that is refused may be on its way whenever a pass ends.
TEST_F(LiveStateTest, EveryWholePassIsAFrame) {
  LiveOptions options = wall_options(6);
  options.backends.make = [this, make = options.backends.make](const LiveSettings& settings,
                                                               std::shared_ptr<const FlatScene> scene,
                                                               const DerivedChannels& derived) {
    return std::make_unique<LateInterrupt>(make(settings, std::move(scene), derived), interrupt_);
  };
  start(std::move(options));
  for (bool works = true; works;) {
    works = state_->work();
    interrupt_ = false;  // as the change does that is refused
  }
  EXPECT_EQ(state_->status().state, "done");
  EXPECT_EQ(state_->film()->passes(), 6u);
  EXPECT_EQ(state_->status().newest.samples, 6u);
  EXPECT_EQ(state_->status().newest.frame, 6u);
  EXPECT_TRUE(state_->status().error) << "of the last sample";
}

/// A backend whose device is lost as the camera moves, and cannot be set up again.
class LostInMotion final : public WrappedBackend {
 public:
  using WrappedBackend::WrappedBackend;

  void camera_moved() override {
    lost_ = true;
    throw DeviceError("the device is lost");
  }
  void render(SpectralFilm& film, const SampleRange& range, const std::vector<uint32_t>& blocks,
              const std::atomic<bool>& stop, const std::function<void(uint64_t)>& progress) override {
    EXPECT_FALSE(lost_) << "there is no device";
    WrappedBackend::render(film, range, blocks, stop, progress);
  }

 private:
  bool lost_ = false;
};

TEST_F(LiveStateTest, ADeviceThatIsLostAsTheCameraMovesEndsTheRender) {
  LiveOptions options = wall_options(4);
  int made = 0;
  options.backends.make = [&made, make = options.backends.make](const LiveSettings& settings,
                                                                std::shared_ptr<const FlatScene> scene,
                                                                const DerivedChannels& derived) {
    auto backend = make(settings, std::move(scene), derived);
    return made++ > 0 ? std::move(backend) : std::make_unique<LostInMotion>(std::move(backend));
  };
  start(std::move(options));
  work();
  const json moved{{"origin", {1, 0, 4}}, {"target", {1, 0, 0}}};
  EXPECT_EQ(error_of<DeviceError>([&] { state_->set_camera(moved); }), "the device is lost");
  EXPECT_EQ(state_->status().state, "failed");
  EXPECT_EQ(state_->status().message, "the device is lost");
  EXPECT_FALSE(state_->work());
  EXPECT_EQ(error_of([&] { state_->set_camera(moved); }), "there is no render: the device is lost");
  state_->restart();
  work();
  EXPECT_EQ(made, 2) << "a backend of its own";
  EXPECT_EQ(state_->status().state, "done") << state_->status().message;
  EXPECT_EQ(state_->scene_json()["camera"]["origin"], json({1.0, 0.0, 4.0})) << "where it was to be";
}

}  // namespace
}  // namespace kiloband::test::live_state_test
