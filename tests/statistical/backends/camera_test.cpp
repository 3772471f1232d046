// A backend whose scene's camera was moved has the bits of one that was made for the scene with that camera.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "backend_images.hpp"
#include "scene/read/reader.hpp"
#include "src_cpu/cpu_backend.hpp"

namespace kiloband::test::camera_test {
namespace {

SamplingSettings settings() {
  SamplingSettings settings;
  settings.replicates = 2;
  settings.wavelengths = WavelengthMode::kPerPath;  // whose random numbers depend on the film's width
  return settings;
}

std::unique_ptr<Backend> backend_of(const std::string& name, std::shared_ptr<const FlatScene> scene) {
  if (name == "cpu") return cpu::make_backend(std::move(scene), {}, settings(), {});
  opencl::Options options{.specialised = false};
  options.method = opencl::find_method(name.substr(name.find(':') + 1)).value();
  return opencl::make_backend(std::move(scene), {}, settings(), options);
}

/// Nearer, turned, and with a smaller film.
Sensor moved(Sensor sensor) {
  sensor.to_world = sensor.to_world * glm::translate(Transform(1.0), glm::dvec3(0.1, 0.05, 0.3));
  sensor.to_world = glm::rotate(Transform(1.0), 0.05, glm::dvec3(0, 1, 0)) * sensor.to_world;
  sensor.film.width = sensor.film.height = sensor.film.crop_width = sensor.film.crop_height = 20;
  return sensor;
}

void expect_same_bits(const std::string& backend_name, const std::string& scene_name) {
  const ZooFolder folder;
  const ZooScene& zoo = zoo_scene(scene_name);
  SceneDescription description = read_scene_text(zoo.xml, zoo.name, folder.path());
  const CompileOptions options{parse_channels(kZooBands), {}, {}};
  const std::shared_ptr<FlatScene> scene = compile_scene_to_move(description, options);
  const auto backend = backend_of(backend_name, scene);
  const PixelRect rect{0, 0, 20, 20};
  const Image before = render_part(*backend, rect, 2, 3);
  description.sensor = moved(description.sensor);
  move_camera(*scene, description.sensor);
  backend->camera_moved();
  const Image after = render_part(*backend, rect, 2, 3);
  const auto fresh = backend_of(backend_name, compile_scene(description, options));
  const Image expected = render_part(*fresh, rect, 2, 3);
  EXPECT_EQ(after.means, expected.means) << scene_name << " on " << backend_name;
  EXPECT_NE(after.means, before.means) << scene_name << " on " << backend_name;
}

TEST(MovedCamera, HasTheBitsOfAFreshBackend) {
  for (const char* scene : {"diffuse_room", "gases", "delta_lights"}) {
    expect_same_bits("cpu", scene);
    for (const std::string& method : kOpenclMethods) expect_same_bits(method, scene);
  }
}

}  // namespace
}  // namespace kiloband::test::camera_test
