// Camera rays. Conventions of Mitsuba 3: local +Z views, +X is the image's left, film position s in [0,1]^2,
// s_y down.
#include "src_cpu/camera.hpp"

#include <array>
#include <cmath>

#include "src_cpu/shape_geometry_affine.hpp"
#include "src_cpu/shape_geometry_warp.hpp"

namespace kiloband {
namespace {

// ---- the truncated Gaussian
// ---------------------------------------------------------------------------------------- Mitsuba's filter
// is f(x) = exp(-x^2/2) - exp(-r^2/2) on |x| < r (x and r in standard deviations). With G(x) = integral of f
// from x to r, the tail probability is w = G(x) / G(0), and x is found from w = 2 min(u, 1-u).

constexpr double kUsualRatio = 4;  // Mitsuba's radius / stddev

double gaussian_tail(double x, double r) {
  const double root_half_pi = 1.2533141373155003;
  const double sqrt_half = 0.70710678118654752;
  return root_half_pi * (std::erfc(x * sqrt_half) - std::erfc(r * sqrt_half)) -
         (r - x) * std::exp(-0.5 * r * r);
}

double gaussian_density(double x, double r) {
  return std::exp(-0.5 * x * x) - std::exp(-0.5 * r * r);
}

/// x in [0, r] with G(x) = w G(0), by Newton's method kept inside a bracket; |error| < 1e-12 r.
double invert_gaussian_tail(double w, double r) {
  const double target = w * gaussian_tail(0, r);
  double low = 0, high = r;
  double x = 0.5 * r;
  for (int i = 0; i < 100 && high - low > 1e-13 * r; ++i) {
    const double excess = gaussian_tail(x, r) - target;
    (excess > 0 ? low : high) = x;
    const double next = x + excess / gaussian_density(x, r);
    const bool inside = next > low && next < high;  // false for NaN too
    const double step = inside ? next - x : 0.5 * (low + high) - x;
    x += step;
    if (inside && std::fabs(step) < 1e-13 * r) break;
  }
  return x;
}

/// x(q), q = sqrt(w), for the usual ratio: cubic Hermite pieces. In q the inverse is smooth up to the end of
/// the support, where f falls to 0 linearly and w quadratically. The error is below 1e-7 r (tests measure
/// it).
class GaussianTable {
 public:
  GaussianTable() {
    const double total = gaussian_tail(0, kUsualRatio);
    for (int i = 0; i <= kPieces; ++i) {
      const double q = static_cast<double>(i) / kPieces;
      const double x = invert_gaussian_tail(q * q, kUsualRatio);
      // dx/dq = -2 q G(0) / f(x); at the end of the support f = r e^(-r^2/2) (r - x), w G(0) = r e^(-r^2/2)
      // (r - x)^2 / 2.
      const double edge = kUsualRatio * std::exp(-0.5 * kUsualRatio * kUsualRatio);
      const double slope =
          i == 0 ? -std::sqrt(2 * total / edge) : -2 * q * total / gaussian_density(x, kUsualRatio);
      nodes_[i] = {static_cast<float>(x), static_cast<float>(slope / kPieces)};
    }
  }

  /// Distance from the centre in standard deviations for the tail probability w in [0, 1].
  float operator()(float w) const {
    const float position = std::sqrt(w) * kPieces;
    const int i = std::min(static_cast<int>(position), kPieces - 1);
    const float t = position - static_cast<float>(i);
    const Node& a = nodes_[i];
    const Node& b = nodes_[i + 1];
    const float rise = b.value - a.value;
    const float c2 = 3 * rise - 2 * a.slope - b.slope, c3 = a.slope + b.slope - 2 * rise;
    return a.value + t * (a.slope + t * (c2 + t * c3));
  }

 private:
  struct Node {
    float value, slope;  // slope per piece
  };
  static constexpr int kPieces = 1024;
  std::array<Node, kPieces + 1> nodes_;
};

float sample_gaussian(float u, float radius, float stddev) {
  static const GaussianTable table;  // built once, on first use
  const float w = u < 0.5f ? 2 * u : 2 * (1 - u);
  const float ratio = radius / stddev;
  const bool usual = std::fabs(ratio - static_cast<float>(kUsualRatio)) < 1e-6f;
  const float x = usual ? table(w) : static_cast<float>(invert_gaussian_tail(w, ratio));
  return stddev * (u < 0.5f ? -x : x);
}

// Tent 1 - |x| on [-1, 1]: the inverse of its distribution function.
float sample_tent(float u) {
  return u < 0.5f ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 * (1 - u));
}

/// Offset from the pixel's centre along one axis, in pixels.
float sample_filter(const KbCamera& camera, float u) {
  switch (camera.filter) {
    case KB_FILTER_TENT:
      return camera.filter_radius * sample_tent(u);
    case KB_FILTER_GAUSSIAN:
      return sample_gaussian(u, camera.filter_radius, camera.filter_stddev);
    default:
      return u - 0.5f;  // box: the pixel itself
  }
}

// ---- projections
// ---------------------------------------------------------------------------------------------------

/// Film position (0 = left / top, 1 = right / bottom) to the image plane: x in [-1, 1] leftwards, y upwards,
/// y scaled by the film's height / width. Double, so that sub-pixel positions of large films stay exact.
glm::vec2 image_plane(const KbCamera& camera, glm::dvec2 s) {
  const double height_over_width = static_cast<double>(camera.film_height) / camera.film_width;
  return {static_cast<float>(1 - 2 * s.x), static_cast<float>((1 - 2 * s.y) * height_over_width)};
}

/// The ray is the plane's normal; to_world scales the film. As in Mitsuba the near plane lies at local z =
/// near_clip, and far_clip - near_clip is measured in the world.
CameraRay orthographic_ray(const KbCamera& camera, glm::dvec2 s) {
  const glm::vec2 plane = image_plane(camera, s);
  const glm::vec3 axis = affine_column<float>(camera.to_world, 2);
  const float scale = glm::length(axis);
  const float t_min = camera.near_clip * scale;
  return {transform_point(camera.to_world, glm::vec3(plane, 0)), axis / scale, t_min,
          t_min + (camera.far_clip - camera.near_clip)};
}

/// Pinhole (lens = 0) or thin lens: all rays of a film position meet on the plane z = focus_distance.
CameraRay perspective_ray(const KbCamera& camera, glm::dvec2 s, glm::vec2 lens) {
  const glm::dvec2 shifted = s + glm::dvec2(camera.principal_x, camera.principal_y);
  const glm::vec3 pinhole(image_plane(camera, shifted) * camera.tan_half_fov_x, 1);
  const bool thin_lens = camera.type == KB_CAMERA_THINLENS;
  const glm::vec3 local = thin_lens ? camera.focus_distance * pinhole - glm::vec3(lens, 0) : pinhole;
  const float per_depth = glm::length(local) / local.z;  // distance along the ray per unit of depth
  return {transform_point(camera.to_world, glm::vec3(lens, 0)),
          glm::normalize(transform_vector(camera.to_world, local)), camera.near_clip * per_depth,
          camera.far_clip * per_depth};
}

CameraRay ray_through(const KbCamera& camera, glm::dvec2 pixels, glm::vec2 lens) {
  const glm::dvec2 s = pixels / glm::dvec2(camera.film_width, camera.film_height);
  return camera.type == KB_CAMERA_ORTHOGRAPHIC ? orthographic_ray(camera, s)
                                               : perspective_ray(camera, s, lens);
}

}  // namespace

CameraRay sample_camera_ray(const KbCamera& camera, uint32_t x, uint32_t y, const KbFloat4& u) {
  const glm::dvec2 offset(sample_filter(camera, u.x), sample_filter(camera, u.y));
  glm::vec2 lens(0);
  if (camera.type == KB_CAMERA_THINLENS) {
    lens = camera.aperture_radius * warp_concentric_disk({u.z, u.w});
  }
  return ray_through(camera, glm::dvec2(x, y) + 0.5 + offset, lens);
}

CameraRay centre_camera_ray(const KbCamera& camera, uint32_t x, uint32_t y) {
  return ray_through(camera, glm::dvec2(x, y) + 0.5, glm::vec2(0));
}

}  // namespace kiloband
