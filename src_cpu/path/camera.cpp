// Camera rays. Conventions of Mitsuba 3: local +Z views, +X is the image's left,
// film position s in [0,1]^2, s_y down.
#include "src_cpu/path/camera.hpp"

#include <cmath>
#include <vector>

#include "film/filter_table.hpp"
#include "src_cpu/geometry/shape_geometry_affine.hpp"
#include "src_cpu/geometry/shape_geometry_warp.hpp"

namespace kiloband::cpu {
namespace {

constexpr float kUsualRatio = 4;  // Mitsuba's radius / stddev

float sample_gaussian(float u, float radius, float stddev) {
  static const std::vector<KbFloat2> table = make_gaussian_filter_table(kUsualRatio);  // on first use
  const float w = u < 0.5f ? 2 * u : 2 * (1 - u);
  const float ratio = radius / stddev;
  const bool usual = std::fabs(ratio - kUsualRatio) < 1e-6f;
  const float x = usual ? gaussian_distance(table, w) : static_cast<float>(invert_gaussian_tail(w, ratio));
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

// ---- projections -------------------------------------------------------------------------------------

/// Film position (0 = left / top, 1 = right / bottom) to the image plane: x in [-1, 1] leftwards, y upwards,
/// y scaled by the film's height / width. Double, so that sub-pixel positions of large films stay exact.
glm::vec2 image_plane(const KbCamera& camera, glm::dvec2 s) {
  const double height_over_width = static_cast<double>(camera.film_height) / camera.film_width;
  return {static_cast<float>(1 - 2 * s.x), static_cast<float>((1 - 2 * s.y) * height_over_width)};
}

/// The ray is the plane's normal; to_world scales the film. As in Mitsuba the near plane lies at
/// local z = near_clip, and far_clip - near_clip is measured in the world.
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

}  // namespace kiloband::cpu
