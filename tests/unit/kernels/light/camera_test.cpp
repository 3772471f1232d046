// Camera rays on the device against src_cpu/path/camera.cpp, which places film positions in double.
#include "src_cpu/path/camera.hpp"

#include "film/signed_filter.hpp"
#include "support.hpp"
#include "tests/support/one_path_lights.hpp"
#include "tests/unit/src_cpu/light/test_scene.hpp"

namespace kiloband::test::camera_test {

using namespace cpu;
namespace {

const char* const kSource = R"(
#include "path/camera.clh"
__kernel void camera(ARGS) {
  ITEM
  KbFloat4 u;
  u.x = in->f[0]; u.y = in->f[1]; u.z = in->f[2]; u.w = in->f[3];
  const CameraRay r = in->u[2] ? centre_camera_ray(&scene, in->u[0], in->u[1])
                               : sample_camera_ray(&scene, in->u[0], in->u[1], u);
  PUT3(0, r.origin); PUT3(3, r.direction); out->f[6] = r.t_min; out->f[7] = r.t_max;
  out->f[8] = r.sign;
}
__kernel void filter_offset(ARGS) {
  ITEM
  float sign = 1.0f;
  out->f[0] = sample_filter(&scene, in->f[0], &sign);
}
)";

OpenclProbe& probe() {
  static OpenclProbe instance(std::string("#include \"base/scene.clh\"\n") + kProbeHead + kSource);
  return instance;
}

KbCamera make_camera(uint32_t type, uint32_t filter, uint32_t width, uint32_t height, double fov_x) {
  KbCamera camera{};
  camera.type = type;
  camera.film_width = width;
  camera.film_height = height;
  camera.filter = filter;
  camera.filter_radius = filter == KB_FILTER_TABULATED  ? 3
                         : filter == KB_FILTER_GAUSSIAN ? 2
                         : filter == KB_FILTER_TENT     ? 1.3f
                                                        : 0.5f;
  camera.filter_stddev = 0.5f;
  camera.tan_half_fov_x = static_cast<float>(std::tan(fov_x / 2));
  camera.principal_x = 0.07f;
  camera.principal_y = -0.21f;
  camera.near_clip = 0.01f;
  camera.far_clip = 1000;
  camera.aperture_radius = 0.05f;
  camera.focus_distance = 3;
  set_matrix(camera.to_world, placed({1, -2, 3}, 0.9, {-1, 1, 1}));
  return camera;
}

std::vector<ItemIn> random_pixels(const KbCamera& camera, std::size_t count) {
  Random random(13);
  std::vector<ItemIn> in(count);
  for (ItemIn& item : in) {
    item = {{random.unit(), random.unit(), random.unit(), random.unit()},
            {random.index(camera.film_width), random.index(camera.film_height), random.index(8) == 0}};
  }
  in[0] = {{0, 0, 0, 0}, {0, 0, 0}};
  in[1] = {{KB_ONE_MINUS_EPSILON, KB_ONE_MINUS_EPSILON, 0.5f, 0.5f},
           {camera.film_width - 1, camera.film_height - 1, 0}};
  return in;
}

/// Directions agree to a few units of their last place, `tolerance`,
/// which on wide films is a fraction of a pixel.
void expect_rays(const KbCamera& camera, double tolerance) {
  FlatScene scene;
  scene.camera = camera;
  scene.filter_cells = make_signed_filter([](double x) { return lanczos(x, 3); }, 3).cells;
  const std::vector<ItemIn> in = random_pixels(camera, 5000);
  const std::vector<ItemOut> out = run_items(probe(), "camera", scene, in);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const KbFloat4 u{in[i].f[0], in[i].f[1], in[i].f[2], in[i].f[3]};
    const CameraRay expected =
        in[i].u[2] ? centre_camera_ray(camera, in[i].u[0], in[i].u[1])
                   : sample_camera_ray(camera, in[i].u[0], in[i].u[1], u, scene.filter_cells.data());
    ASSERT_LT(difference(get3(out[i], 0), expected.origin), 1e-6) << i;
    ASSERT_LT(difference(get3(out[i], 3), expected.direction), tolerance) << i;
    ASSERT_LT(relative(out[i].f[6], expected.t_min), 1e-6) << i;
    ASSERT_LT(relative(out[i].f[7], expected.t_max), 1e-6) << i;
    ASSERT_EQ(out[i].f[8], expected.weight) << i;
  }
}

TEST(GpuCamera, EveryTypeAndFilter) {
  for (const uint32_t type : {KB_CAMERA_PERSPECTIVE, KB_CAMERA_THINLENS, KB_CAMERA_ORTHOGRAPHIC}) {
    for (const uint32_t filter : {KB_FILTER_BOX, KB_FILTER_TENT, KB_FILTER_GAUSSIAN, KB_FILTER_TABULATED}) {
      expect_rays(make_camera(type, filter, 301, 200, 0.8), 3e-7);
      expect_rays(make_camera(type, filter, 1, 1, 2.5), 3e-7);
    }
  }
}

/// A narrow view on a film of 16384 pixels: a pixel is 6e-7 wide. The image plane's coordinates agree to 2e-7
/// of half the film times the view's half width 5e-3, 2e-3 of a pixel;
/// what is left is the rounding of unit vectors.
TEST(GpuCamera, WideFilms) {
  KbCamera camera = make_camera(KB_CAMERA_PERSPECTIVE, KB_FILTER_GAUSSIAN, 16384, 9001, 0.01);
  expect_rays(camera, 2e-7);
  set_matrix(camera.to_world, identity());
  camera.principal_x = camera.principal_y = 0;
  FlatScene scene;
  scene.camera = camera;
  const std::vector<ItemIn> in = random_pixels(camera, 20000);
  const std::vector<ItemOut> out = run_items(probe(), "camera", scene, in);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const CameraRay expected = in[i].u[2]
                                   ? centre_camera_ray(camera, in[i].u[0], in[i].u[1])
                                   : sample_camera_ray(camera, in[i].u[0], in[i].u[1],
                                                       {in[i].f[0], in[i].f[1], in[i].f[2], in[i].f[3]});
    // The first two coordinates are small here: they keep their relative precision.
    ASSERT_LT(std::fabs(out[i].f[3] - expected.direction.x), 4e-7 * std::fabs(expected.direction.x) + 1e-12)
        << i;
    ASSERT_LT(std::fabs(out[i].f[4] - expected.direction.y), 4e-7 * std::fabs(expected.direction.y) + 1e-12)
        << i;
  }
}

/// Any ratio of radius and standard deviation: the table against the exact inverse that the CPU uses.
TEST(GpuCamera, GaussiansOfOtherRatios) {
  for (const double ratio : {0.5, 1.0, 2.5, 4.0}) {
    FlatScene scene;
    scene.camera = make_camera(KB_CAMERA_ORTHOGRAPHIC, KB_FILTER_GAUSSIAN, 100, 100, 1);
    scene.camera.filter_stddev = 0.5f;
    scene.camera.filter_radius = static_cast<float>(0.5 * ratio);
    Random random(14);
    std::vector<ItemIn> in(20000);
    for (ItemIn& item : in) item.f[0] = random.unit();
    in[0].f[0] = 0;
    const std::vector<ItemOut> out = run_items(probe(), "filter_offset", scene, in);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const float u = in[i].f[0];
      const double exact = 0.5 * invert_gaussian_tail(2.0 * std::min(double(u), 1.0 - u), ratio);
      ASSERT_NEAR(out[i].f[0], u < 0.5f ? -exact : exact, 3e-7 * scene.camera.filter_radius) << u;
    }
  }
}

}  // namespace
}  // namespace kiloband::test::camera_test
