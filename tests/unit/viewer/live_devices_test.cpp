// A render that is looked at, on two devices: what is seen is what one of them shows, bit by bit.
#include <gtest/gtest.h>

#include <cstring>
#include <thread>

#include "render/devices/device_group.hpp"
#include "scene/read/reader.hpp"
#include "src_cpu/cpu_backend.hpp"
#include "tests/unit/render/devices/faulty_backend.hpp"
#include "viewer/api/selections.hpp"
#include "viewer/live/live_render.hpp"

namespace kiloband::test {
namespace {

using namespace viewer;

/// A ball before a wall: four blocks that are not alike.
const char* const kBall = R"(<scene version='3.0.0'>
<sensor type='perspective'><float name='fov' value='40'/>
 <transform name='to_world'><lookat origin='0,0,4' target='0,0,0' up='0,1,0'/></transform>
 <film type='hdrfilm'><integer name='width' value='52'/><integer name='height' value='36'/></film>
</sensor>
<shape type='sphere'><bsdf type='diffuse'/></shape>
<emitter type='point'><point name='position' x='2' y='3' z='4'/></emitter></scene>)";

using Maker = decltype(BackendProvider::make);

std::unique_ptr<ViewedImage> start(Maker make) {
  LiveOptions live;
  live.scene = read_scene_text(kBall, "ball.xml", ".");
  live.channels = parse_channels("500:600:4");
  live.scene_name = "ball.xml";
  live.settings.backend = "cpu";
  live.settings.method = "dpept-batch";
  live.backends.choices = {{"cpu", "this one", {}, {"dpept-batch"}}};
  live.backends.make = std::move(make);
  live.samples = 24;
  live.threads = 1;
  return start_live_render(std::move(live));
}

std::unique_ptr<ViewedImage> start(std::size_t devices) {
  return start([devices](const LiveSettings& settings, std::shared_ptr<const FlatScene> scene,
                         const DerivedChannels&) {
    std::vector<std::unique_ptr<Backend>> backends;
    for (std::size_t d = 0; d < devices; ++d)
      backends.push_back(cpu::make_backend(scene, {}, settings.sampling, {cpu::Isa::kAuto, 1}));
    return make_device_group(std::move(backends), {});
  });
}

/// The curve of every pixel, once all samples are there.
std::vector<Curve> curves(ViewedImage& image) {
  for (int i = 0; i < 3000 && image.status().state != "done"; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(image.status().state, "done") << image.status().message;
  std::vector<Curve> all;
  image.read([&](const ImageView& seen) {
    std::vector<Selection> pixels;
    for (uint32_t i = 0; i < seen.full_width * seen.full_height; ++i) {
      const uint32_t x = i % seen.full_width, y = i / seen.full_width;
      pixels.push_back({"", x, y, x, y});
    }
    all = read_curves(seen.pixels, pixels, seen.full_width, seen.full_height, 2);
  });
  return all;
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

void expect_same(const std::vector<Curve>& a, const std::vector<Curve>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(same_bits(a[i].mean, b[i].mean)) << i;
    EXPECT_TRUE(same_bits(a[i].standard_error, b[i].standard_error)) << i;
  }
}

TEST(LiveDevices, ShowWhatOneShows) {
  const auto one = start(1), two = start(2);
  expect_same(curves(*one), curves(*two));
  for (ViewedImage* image : {one.get(), two.get()})
    image->controls()->set_camera({{"origin", {1, 0, 4}}, {"target", {0, 0, 0}}, {"up", {0, 1, 0}}});
  expect_same(curves(*one), curves(*two));
}

/// What is lost with a device is had again once there is one: by a backend of its own.
TEST(LiveDevices, AFailedRenderIsRestarted) {
  int made = 0;
  const auto image = start(
      [&](const LiveSettings& settings, std::shared_ptr<const FlatScene> scene, const DerivedChannels&) {
        Fault fault;
        if (++made == 1) fault = {Fault::Kind::kDevice, 2, 0, true};
        return std::make_unique<FaultyBackend>(
            cpu::make_backend(std::move(scene), {}, settings.sampling, {cpu::Isa::kAuto, 1}), fault);
      });
  for (int i = 0; i < 3000 && image->status().state != "failed"; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(image->status().state, "failed");
  image->controls()->restart();
  expect_same(curves(*image), curves(*start(1)));
  EXPECT_EQ(image->status().message, "") << "what failed is over";
  EXPECT_EQ(made, 2);
}

}  // namespace
}  // namespace kiloband::test
