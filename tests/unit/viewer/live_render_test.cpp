// A render that is looked at, on the CPU backend.
#include "viewer/live/live_render.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "base/temporary_folder.hpp"
#include "scene/read/reader.hpp"
#include "tests/support/messages.hpp"
#include "tests/unit/viewer/live_wall.hpp"
#include "tests/unit/viewer/test_requests.hpp"
#include "viewer/api/api.hpp"
#include "viewer/api/selections.hpp"
#include "viewer/live/camera_view.hpp"
#include "viewer/live/scene_spectra.hpp"

namespace kiloband::test {
namespace {

using namespace viewer;
using nlohmann::json;

class LiveWall : public testing::Test {
 protected:
  explicit LiveWall(uint64_t samples = 40) : image_(start_live_render(wall_options(samples))) {}

  void wait_for(const std::string& state) {
    for (int i = 0; i < 3000 && image_->status().state != state; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_EQ(image_->status().state, state) << image_->status().message;
  }
  /// The densities in the middle.
  Curve middle() {
    Curve curve;
    image_->read([&](const ImageView& seen) {
      curve = read_curves(seen.pixels, {{"", 8, 8, 31, 27}}, seen.full_width, seen.full_height, 2).front();
    });
    return curve;
  }

  /// In five standard errors of a mean of 19200 samples: a false alarm in 10^6 tests. The error itself is to be small enough to
  /// tell the values of these tests apart.
  void expect_radiance(double expected) {
    const Curve curve = middle();
    EXPECT_LT(curve.standard_error[0], 0.01 * expected);
    EXPECT_NEAR(curve.mean[0], expected, 5 * curve.standard_error[0]);
  }

  std::unique_ptr<ViewedImage> image_;
};

TEST_F(LiveWall, RefinesUntilItIsDone) {
  wait_for("done");
  EXPECT_EQ(image_->status().newest.samples, 40u);
  EXPECT_GE(image_->status().newest.frame, 40u);
  ASSERT_TRUE(image_->status().error) << "of the last sample, however short the render was";
  EXPECT_GT(*image_->status().error, 0);
  EXPECT_LT(*image_->status().error, 0.5);
  const Curve curve = middle();
  EXPECT_EQ(curve.pixels, 24u * 20u);
  expect_radiance(0.5);
  EXPECT_EQ(image_->scene()["width"], 40);
  EXPECT_EQ(image_->scene()["camera"]["type"], "perspective");
  EXPECT_NEAR(image_->scene()["camera"]["target"][2].get<double>(), 0, 1e-3) << "the wall in the middle";
}

TEST_F(LiveWall, SpectraAreReplacedAndReset) {
  wait_for("done");
  RenderControls& controls = *image_->controls();
  const json spectra = image_->scene()["spectra"];
  ASSERT_EQ(spectra.size(), 2u);
  EXPECT_EQ(spectra[0]["owner"], "bsdf 'paint'");
  EXPECT_EQ(spectra[1]["owner"], "emitter 'sky'");
  controls.set_spectrum({{"id", "s0"}, {"set", {{"constant", 0.25}}}});
  wait_for("done");
  expect_radiance(0.25);
  controls.set_spectrum({{"id", "s1"}, {"set", {{"scale", 3}}}});
  wait_for("done");
  expect_radiance(0.75);
  EXPECT_EQ(image_->scene()["spectra"][1]["edited"], true);
  controls.set_spectrum({{"id", "s0"}, {"set", {{"file_text", "400 0.1\n800 0.1\n"}}}});
  wait_for("done");
  expect_radiance(0.3);
  controls.set_spectrum({{"id", "s0"}, {"set", {{"reset", true}}}});
  controls.set_spectrum({{"id", "s1"}, {"set", {{"reset", true}}}});
  wait_for("done");
  expect_radiance(0.5);
}

/// Member "name" of the wall's metal or glass.
json material_name(const std::string& bsdf) {
  std::string text = kWallScene;
  const std::string paint =
      "<bsdf type='diffuse' id='paint'><spectrum name='reflectance' value='0.5'/></bsdf>";
  text.replace(text.find(paint), paint.size(), "<bsdf " + bsdf + "</bsdf>");
  return SpectrumEdits().list(read_scene_text(text, "wall.xml", "."), {500, 600})[0]["name"];
}

TEST(SpectraOfAScene, MaterialsHaveTheNamesOfTheSceneFile) {
  EXPECT_EQ(material_name("type='conductor'><string name='metal' value='Ag'/>"), "Ag");
  EXPECT_EQ(material_name("type='roughconductor'><string name='material' value='Cu'/>"), "Cu");
  EXPECT_EQ(material_name("type='conductor'>"), nullptr);
  EXPECT_EQ(material_name("type='dielectric'><string name='int_ior' value='water'/>"), "water");
  EXPECT_EQ(material_name("type='dielectric'><string name='int_material' value='N-SF11'/>"), "N-SF11");
  EXPECT_EQ(material_name("type='dielectric'><float name='int_ior' value='1.4'/>"), nullptr);
  const ScratchFolder folder;
  const std::string file = folder.write("own glass.csv", "300, 1.5\n900, 1.4\n").string();
  EXPECT_EQ(material_name("type='dielectric'><string name='int_material' value='" + file + "'/>"),
            "own glass.csv");
}

TEST_F(LiveWall, RefusedEditsChangeNothing) {
  wait_for("done");
  RenderControls& controls = *image_->controls();
  const uint64_t revision = image_->status().newest.revision;
  const auto refused = [&](const char* id, const json& value) {
    return error_of([&] { controls.set_spectrum({{"id", id}, {"set", value}}); });
  };
  EXPECT_EQ(refused("s7", {{"constant", 1}}), "the scene has no spectrum 's7'");
  EXPECT_EQ(refused("s0", {{"constant", 1.5}}),
            "reflectance of bsdf 'paint': 1.5 to 1.5: must be from 0 to 1");
  EXPECT_EQ(refused("s0", {{"metal", "Au"}}), "reflectance of bsdf 'paint' cannot be a metal");
  EXPECT_EQ(refused("s0", {{"file_text", "x"}}).substr(0, 12), "spectrum.txt");
  EXPECT_EQ(refused("s1", {{"temperature_k", -1}}),
            "temperature_k: -1: must be above 0 and at most 100000 K");
  EXPECT_EQ(error_of([&] {
              controls.set_settings({{"backend", "abacus"}});
            }),
            "backend: there is no such backend on this machine");
  EXPECT_EQ(error_of([&] {
              controls.set_settings({{"max_depth", 1.5}});
            }),
            "max_depth: must be a whole number from -1 to 1000000");
  EXPECT_EQ(error_of([&] {
              controls.set_camera({{"origin", {0, 0, 1}}, {"target", {0, 0, 1}}});
            }),
            "camera: origin and target must differ");
  EXPECT_EQ(error_of([&] {
              controls.set_camera({{"up", {0, 0, 1}}, {"target", {0, 0, 0}}, {"origin", {0, 0, 4}}});
            }),
            "camera: up must not be along the view");
  EXPECT_EQ(error_of([&] { controls.set_camera({{"fov_deg", 180}}); }), "fov_deg: must be from 0.01 to 175");
  EXPECT_NE(error_of([&] {
              controls.set_camera({{"origin", {1e12, 0, 0}}});
            }).find("sensor: x = 1e+12 m"),
            std::string::npos);
  EXPECT_EQ(image_->status().newest.revision, revision);
  expect_radiance(0.5);
}

TEST_F(LiveWall, TheCameraMovesAtAReducedSizeFirst) {
  wait_for("done");
  RenderControls& controls = *image_->controls();
  const uint64_t revision = image_->status().newest.revision, frame = image_->status().newest.frame;
  controls.set_camera({{"origin", {1, 0, 4}}, {"target", {1, 0, 0}}, {"up", {0, 1, 0}}, {"moving", true}});
  ASSERT_TRUE(image_->wait_for_frame(frame, std::chrono::seconds(20)));
  image_->read([&](const ImageView& seen) {
    EXPECT_EQ(seen.pixels.width(), 20u);
    EXPECT_EQ(seen.full_width, 40u);
  });
  EXPECT_GT(image_->status().newest.revision, revision);
  controls.set_camera({{"moving", false}});
  wait_for("done");
  image_->read([&](const ImageView& seen) { EXPECT_EQ(seen.pixels.width(), 40u); });
  EXPECT_EQ(image_->scene()["camera"]["origin"], json({1.0, 0.0, 4.0}));
  controls.set_camera({{"reset", true}});
  EXPECT_EQ(image_->scene()["camera"]["origin"], json({0.0, 0.0, 4.0}));
}

/// What is pasted into a scene file is the camera that is looked through.
TEST_F(LiveWall, TheCameraAsXmlIsTheCamera) {
  wait_for("done");
  image_->controls()->set_camera(
      {{"origin", {1, 2, 4}}, {"target", {0, 0.5, 0}}, {"up", {0.1, 1, 0}}, {"fov_deg", 33}});
  const std::string xml = "<scene version='3.0.0'>" + image_->controls()->camera_xml() +
                          "<shape type='sphere'/><emitter type='constant'/></scene>";
  const Sensor sensor = read_scene_text(xml, "camera.xml", ".").sensor;
  const json camera = camera_json(sensor, 1, 1), expected = image_->scene()["camera"];
  EXPECT_NEAR(camera["fov_deg"].get<double>(), 33, 1e-12);
  EXPECT_EQ(camera["origin"], expected["origin"]);
  EXPECT_EQ(camera["up"], expected["up"]);
}

TEST_F(LiveWall, ChannelsAreChosenAnew) {
  wait_for("done");
  image_->controls()->set_settings({{"bands", "400:500:3"}, {"max_depth", 1}});
  wait_for("done");
  EXPECT_EQ(image_->scene()["channels"].size(), 3u);
  EXPECT_NEAR(middle().mean[2], 0, 1e-6) << "a wall that nothing lights: depth 1 is emission alone";
}

class EndlessWall : public LiveWall {
 protected:
  EndlessWall() : LiveWall(kMostLiveSamples) {}
};

TEST_F(EndlessWall, PausesAndGoesOn) {
  ASSERT_TRUE(image_->wait_for_frame(2, std::chrono::seconds(20)));
  image_->controls()->pause();
  const ViewStatus paused = image_->status();
  EXPECT_EQ(paused.state, "paused");
  EXPECT_FALSE(image_->wait_for_frame(paused.newest.frame, std::chrono::milliseconds(300)));
  const auto nobody = [](const ImageView&) { FAIL() << "there is no newer frame"; };
  EXPECT_FALSE(image_->read_newer(paused.newest.frame, std::chrono::milliseconds(50), nobody));
  uint64_t seen = 0;
  const auto look = [&seen](const ImageView& view) { seen = view.stamp.frame; };
  EXPECT_TRUE(image_->read_newer(paused.newest.frame - 1, std::chrono::seconds(20), look));
  EXPECT_EQ(seen, paused.newest.frame);
  image_->controls()->resume();
  EXPECT_TRUE(image_->wait_for_frame(paused.newest.frame, std::chrono::seconds(20)));
  EXPECT_EQ(image_->status().newest.revision, paused.newest.revision) << "samples are kept";
}

/// It would be an image of NaN.
TEST_F(EndlessWall, NothingIsSavedBeforeTheFirstSample) {
  const TemporaryFolder folder;
  ApiSettings settings;
  settings.output_dir = folder.path();
  Api api(*image_, settings);
  const auto save = [&](const std::string& format) {
    return api.answer(post_request("/api/save", R"({"name": "wall", "format": ")" + format + "\"}"),
                      [] { return true; });
  };
  ASSERT_TRUE(image_->wait_for_frame(2, std::chrono::seconds(20)));
  image_->controls()->pause();
  EXPECT_EQ(save("exr").status, 200);
  std::filesystem::remove(folder / "wall.exr");
  image_->controls()->restart();
  for (const char* const format : {"exr", "envi", "png"}) {
    const Response refused = save(format);
    EXPECT_EQ(refused.status, 400) << format;
    EXPECT_NE(refused.body.find("there is no image yet"), std::string::npos) << refused.body;
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  image_->controls()->resume();
  ASSERT_TRUE(image_->wait_for_frame(image_->status().newest.frame, std::chrono::seconds(20)));
  EXPECT_EQ(save("png").status, 200);
}

}  // namespace
}  // namespace kiloband::test
