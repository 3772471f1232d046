// Camera rays against closed forms, film positions against the reconstruction filters.
#include "src_cpu/path/camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "film/signed_filter.hpp"
#include "test_scene.hpp"
#include "tests/support/chi_square.hpp"
#include "tests/support/one_path_lights.hpp"

namespace kiloband::test::camera_test {

using namespace cpu;
namespace {

constexpr double kPi = 3.141592653589793238463;

KbCamera make_camera(uint32_t type, uint32_t width, uint32_t height, double fov_x) {
  KbCamera camera{};
  camera.type = type;
  camera.film_width = width;
  camera.film_height = height;
  camera.filter = KB_FILTER_BOX;
  camera.filter_radius = 0.5f;
  camera.tan_half_fov_x = static_cast<float>(std::tan(fov_x / 2));
  camera.near_clip = 0.5f;
  camera.far_clip = 100;
  set_matrix(camera.to_world, identity());
  return camera;
}

void expect_vector(glm::vec3 actual, glm::dvec3 expected, double tolerance = 1e-6) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(actual[i], expected[i], tolerance) << "axis " << i;
}

TEST(Perspective, CornersAndCentreForEachFovAxis) {
  // Mitsuba's rules for a 3:2 film and a field of view of 40 degrees along x, y and the diagonal.
  const double fov = 40 * kPi / 180, aspect = 1.5;
  const double along_y = 2 * std::atan(std::tan(fov / 2) * aspect);
  const double diagonal = 2 * std::atan(std::tan(fov / 2) / std::sqrt(1 + 1 / (aspect * aspect)));
  for (const double fov_x : {fov, along_y, diagonal}) {
    const KbCamera camera = make_camera(KB_CAMERA_PERSPECTIVE, 300, 200, fov_x);
    const double t = std::tan(fov_x / 2);
    // u = 0: the upper left corner of the pixel. Left is +X, up is +Y.
    const CameraRay corner = sample_camera_ray(camera, 0, 0, {0, 0, 0, 0});
    const glm::dvec3 d(t, t / aspect, 1);
    expect_vector(corner.direction, glm::normalize(d));
    expect_vector(corner.origin, {0, 0, 0});
    // Clip planes are measured along the axis.
    EXPECT_NEAR(corner.t_min, 0.5 * glm::length(d), 1e-6);
    EXPECT_NEAR(corner.t_max, 100 * glm::length(d), 1e-4);
    expect_vector(sample_camera_ray(camera, 150, 100, {0, 0, 0, 0}).direction, {0, 0, 1});
    const glm::dvec3 last(-t * (1 - 1.0 / 300), -t / aspect * (1 - 1.0 / 200), 1);
    expect_vector(centre_camera_ray(camera, 299, 199).direction, glm::normalize(last));
  }
  // The angle between the corner rays of the diagonal camera is the field of view itself.
  const KbCamera camera = make_camera(KB_CAMERA_PERSPECTIVE, 300, 200, diagonal);
  const glm::vec3 a = sample_camera_ray(camera, 0, 0, {0, 0, 0, 0}).direction;
  const glm::vec3 b = sample_camera_ray(camera, 300, 200, {0, 0, 0, 0}).direction;
  EXPECT_NEAR(std::acos(glm::dot(a, b)), fov, 1e-6);
}

TEST(Perspective, PlacedWithPrincipalPoint) {
  KbCamera camera = make_camera(KB_CAMERA_PERSPECTIVE, 100, 50, kPi / 2);
  camera.principal_x = 0.1f;
  camera.principal_y = -0.2f;
  const glm::dmat4 to_world = placed({1, 2, 3}, 0.9, {-1, 1, 1});  // mirrored, as old scenes do
  set_matrix(camera.to_world, to_world);
  const CameraRay ray = sample_camera_ray(camera, 30, 20, {0.25f, 0.75f, 0, 0});
  const double s_x = 30.25 / 100 + 0.1, s_y = 20.75 / 50 - 0.2;
  const glm::dvec3 local = glm::normalize(glm::dvec3(1 - 2 * s_x, (1 - 2 * s_y) / 2, 1));
  expect_vector(ray.direction, glm::dmat3(to_world) * local);
  expect_vector(ray.origin, {1, 2, 3});
}

TEST(ThinLens, RaysMeetAtTheFocusAndFillTheLens) {
  KbCamera camera = make_camera(KB_CAMERA_THINLENS, 100, 100, 1);
  camera.aperture_radius = 0.2f;
  camera.focus_distance = 7;
  const glm::dvec3 focus =
      7.0 * glm::dvec3((1 - 2 * 0.205) * std::tan(0.5), (1 - 2 * 0.805) * std::tan(0.5), 1);
  Uniform uniform(1);
  // Uniform on the disk: (r / R)^2 uniform. 16 x 16 bins of 390 expected: an RMS deviation of 4.5 % is found.
  SquareCounts counts(16);
  for (int i = 0; i < 100000; ++i) {
    const glm::vec2 lens = uniform.pair();
    const CameraRay ray = sample_camera_ray(camera, 20, 80, {0.5f, 0.5f, lens.x, lens.y});
    const double t = 7 / ray.direction.z;
    expect_vector(ray.origin + static_cast<float>(t) * ray.direction, focus, 5e-6);
    EXPECT_NEAR(ray.t_min * ray.direction.z, 0.5, 1e-6);
    const double r2 = (ray.origin.x * ray.origin.x + ray.origin.y * ray.origin.y) / 0.04;
    counts.add(r2, std::atan2(ray.origin.y, ray.origin.x) / (2 * kPi) + 0.5);
  }
  EXPECT_GT(counts.p_value(), kTestLevel);
  expect_vector(centre_camera_ray(camera, 20, 80).origin, {0, 0, 0});
}

TEST(Orthographic, FilmAndClipPlanes) {
  KbCamera camera = make_camera(KB_CAMERA_ORTHOGRAPHIC, 200, 100, 1);
  set_matrix(camera.to_world,
             glm::scale(glm::translate(identity(), glm::dvec3(1, 2, 3)), glm::dvec3(10, 10, 2)));
  const CameraRay corner = sample_camera_ray(camera, 0, 0, {0, 0, 0, 0});
  expect_vector(corner.origin, {11, 7, 3});  // x covers [-1, 1] * 10, y half of it
  expect_vector(corner.direction, {0, 0, 1});
  EXPECT_FLOAT_EQ(corner.t_min, 1);  // local z = 0.5, scaled
  EXPECT_FLOAT_EQ(corner.t_max, 1 + 99.5f);
  expect_vector(centre_camera_ray(camera, 199, 99).origin, {1 - 9.95, 2 - 4.95, 3}, 2e-6);
}

/// Offset from the centre of pixel (7, 2) in pixels, read off an orthographic camera's origin.
glm::dvec2 film_offset(const KbCamera& camera, float u, float v, const float* cells = nullptr) {
  const CameraRay ray = sample_camera_ray(camera, 7, 2, {u, v, 0, 0}, cells);
  return {(1 - ray.origin.x) / 2 * camera.film_width - 7.5,
          (1 - ray.origin.y) / 2 * camera.film_height - 2.5};
}

/// Distribution function of a filter at x (pixels).
double tent_cdf(double x, double r) {
  const double a = std::fabs(x) / r;
  return x < 0 ? 0.5 * (1 - a) * (1 - a) : 1 - 0.5 * (1 - a) * (1 - a);
}
double gaussian_cdf(double x, double r, double s) {
  const double floor = std::exp(-r * r / (2 * s * s));
  const auto half = [&](double y) {
    return s * std::sqrt(kPi / 2) * std::erf(y / (s * std::sqrt(2.0))) - floor * y;
  };
  return 0.5 + 0.5 * half(x) / half(r);
}

/// 200 000 film positions against the product of the axes' distributions on 20 x 20 bins (500 expected on
/// average). Error rate 1e-5; an RMS deviation of 2.9 % over all bins is found with probability 0.95.
template <typename Cdf>
void expect_filter(const KbCamera& camera, double radius, const Cdf& cdf, uint32_t seed,
                   const float* cells = nullptr) {
  constexpr int kBins = 20, kCount = 200000;
  std::vector<double> observed(kBins * kBins), expected(kBins * kBins);
  Uniform uniform(seed);
  const auto bin = [&](double x) {
    return std::clamp(static_cast<int>((x / radius + 1) / 2 * kBins), 0, kBins - 1);
  };
  for (int i = 0; i < kCount; ++i) {
    const glm::vec2 u = uniform.pair();
    const glm::dvec2 x = film_offset(camera, u.x, u.y, cells);
    EXPECT_LE(std::fabs(x.x), radius * (1 + 1e-5));
    EXPECT_LE(std::fabs(x.y), radius * (1 + 1e-5));
    ++observed[bin(x.x) * kBins + bin(x.y)];
  }
  const auto mass = [&](int i) {
    return cdf(radius * (2.0 * (i + 1) / kBins - 1)) - cdf(radius * (2.0 * i / kBins - 1));
  };
  for (int i = 0; i < kBins * kBins; ++i) expected[i] = kCount * mass(i / kBins) * mass(i % kBins);
  EXPECT_GT(chi_square(observed, expected).p_value, kTestLevel);
}

KbCamera filter_camera(uint32_t filter, float radius, float stddev) {
  KbCamera camera = make_camera(KB_CAMERA_ORTHOGRAPHIC, 16, 16, 1);
  camera.filter = filter;
  camera.filter_radius = radius;
  camera.filter_stddev = stddev;
  return camera;
}

TEST(Filter, Box) {
  expect_filter(
      filter_camera(KB_FILTER_BOX, 0.5f, 0), 0.5, [](double x) { return x + 0.5; }, 2);
}

TEST(Filter, Tent) {
  expect_filter(
      filter_camera(KB_FILTER_TENT, 1.5f, 0), 1.5, [](double x) { return tent_cdf(x, 1.5); }, 3);
}

TEST(Filter, GaussianOfFourStandardDeviations) {
  expect_filter(
      filter_camera(KB_FILTER_GAUSSIAN, 2, 0.5f), 2, [](double x) { return gaussian_cdf(x, 2, 0.5); }, 4);
}

TEST(Filter, GaussianOfAnotherRadius) {
  expect_filter(
      filter_camera(KB_FILTER_GAUSSIAN, 1, 0.5f), 1, [](double x) { return gaussian_cdf(x, 1, 0.5); }, 5);
}

/// Offsets from the filter's modulus, with its sign.
TEST(Filter, CatmullRomWithSigns) {
  const auto f = [](double x) { return mitchell(std::fabs(x), 0, 0.5); };
  const SignedFilter filter = make_signed_filter(f, 2);
  const KbCamera camera = filter_camera(KB_FILTER_TABULATED, 2, 0);
  // Integrals of |f|: (x^4 3/8 - x^3 5/6 + x) to 1, which is 13/24; then 1/24 in all.
  const auto half = [](double x) {
    if (x < 1) return ((3.0 / 8 * x - 5.0 / 6) * x * x + 1) * x;
    const double beyond = (((-x / 8 + 5.0 / 6) * x - 2) * x + 2) * x;
    return 13.0 / 24 - (beyond - 17.0 / 24);
  };
  const auto cdf = [&](double x) { return 0.5 + std::copysign(half(std::fabs(x)) / (2 * half(2)), x); };
  expect_filter(camera, 2, cdf, 6, filter.cells.data());
  Uniform uniform(7);
  for (int i = 0; i < 20000; ++i) {
    const glm::vec2 u = uniform.pair();
    const glm::dvec2 x = film_offset(camera, u.x, u.y, filter.cells.data());
    const double value = f(x.x) * f(x.y);
    if (std::fabs(value) < 1e-3) continue;  // the cell's sign
    ASSERT_EQ(sample_camera_ray(camera, 7, 2, {u.x, u.y, 0, 0}, filter.cells.data()).weight,
              value < 0 ? -1 : 1);
  }
  for (const float u : {0.0f, 0.5f, KB_ONE_MINUS_EPSILON})
    EXPECT_LE(std::fabs(film_offset(camera, u, u, filter.cells.data()).x), 2 + 1e-5);
}

TEST(Filter, GaussianInverseIsAccurate) {
  // The inverse against its own distribution function: error in x = error of the distribution / density,
  // checked where the density carries it. The film position itself is read back from floats, to 2e-6 pixels.
  const KbCamera camera = filter_camera(KB_FILTER_GAUSSIAN, 2, 0.5f);
  for (int i = 1; i < 20000; ++i) {
    const float u = static_cast<float>(i) / 20000;
    const double x = film_offset(camera, u, 0.5f).x;
    const double density = (std::exp(-2 * x * x) - std::exp(-8.0)) / 1.2533 / 1.0;
    EXPECT_NEAR((gaussian_cdf(x, 2, 0.5) - u) / density, 0, 4e-6) << u;
  }
  EXPECT_NEAR(film_offset(camera, 0, 0).x, -2, 2e-6);
  EXPECT_NEAR(film_offset(camera, 0.5f, 0.5f).x, 0, 2e-6);
}

TEST(Filter, LargeFilmsKeepSubPixelPositions) {
  // 60 000 pixels: the difference of two rays of a pixel is exact to 1e-3 pixels.
  const KbCamera camera = make_camera(KB_CAMERA_PERSPECTIVE, 60000, 60000, 0.01);
  const float a = sample_camera_ray(camera, 30000, 30000, {0.25f, 0, 0, 0}).direction.x;
  const float b = sample_camera_ray(camera, 30000, 30000, {0.75f, 0, 0, 0}).direction.x;
  EXPECT_NEAR((a - b) / (2 * std::tan(0.005) / 60000), 0.5, 1e-3);
}

TEST(Filter, PositionsOfLargeFilmsAreThoseOfDoublePrecision) {
  // The image plane's coordinates are rounded once, and once more by each of the projection's few steps.
  KbCamera camera = make_camera(KB_CAMERA_PERSPECTIVE, 60001, 40000, 1);
  camera.principal_x = 0.125f;
  camera.principal_y = -0.25f;
  Uniform uniform(6);
  for (int i = 0; i < 20000; ++i) {
    const auto x = static_cast<uint32_t>(uniform() * 60001), y = static_cast<uint32_t>(uniform() * 40000);
    const glm::vec2 u = uniform.pair();
    const glm::dvec3 d(sample_camera_ray(camera, x, y, {u.x, u.y, 0, 0}).direction);
    const double s_x = (x + double{u.x}) / 60001 + 0.125, s_y = (y + double{u.y}) / 40000 - 0.25;
    const double plane_x = (1 - 2 * s_x) * camera.tan_half_fov_x;
    const double plane_y = (1 - 2 * s_y) * 40000 / 60001 * camera.tan_half_fov_x;
    ASSERT_NEAR(d.x / d.z, plane_x, 4e-7 * std::fabs(plane_x) + 1e-12) << x << " " << u.x;
    ASSERT_NEAR(d.y / d.z, plane_y, 4e-7 * std::fabs(plane_y) + 1e-12) << y << " " << u.y;
  }
}

}  // namespace
}  // namespace kiloband::test::camera_test
