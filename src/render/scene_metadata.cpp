#include "render/scene_metadata.hpp"

#include <fmt/format.h>

#include <glm/glm.hpp>

#include "cube/cube_text.hpp"

namespace kiloband {
namespace {

/// Area that a pixel of a parallel projection covers perpendicular to its rays: the film's unit square, on
/// which it is (2 / width)^2, becomes a parallelogram; with the rays' direction z its shadow is |det| / |z|.
double orthographic_pixel_area(const KbCamera& camera) {
  const auto column = [&](int c) {
    return glm::dvec3(camera.to_world[c], camera.to_world[4 + c], camera.to_world[8 + c]);
  };
  const glm::dvec3 z = column(2);
  const double edge = 2.0 / camera.film_width;
  return edge * edge * std::abs(glm::dot(glm::cross(column(0), column(1)), z)) / glm::length(z);
}

}  // namespace

CameraGeometry camera_geometry(const FlatScene& scene) {
  const KbCamera& camera = scene.camera;
  if (camera.type == KB_CAMERA_ORTHOGRAPHIC) {
    CameraGeometry geometry;
    geometry.orthographic = true;
    geometry.pixel_area_m2 = orthographic_pixel_area(camera);
    return geometry;
  }
  return {false,
          0,
          camera.film_width,
          camera.film_height,
          scene.film.crop_x,
          scene.film.crop_y,
          camera.tan_half_fov_x,
          camera.principal_x,
          camera.principal_y};
}

std::string object_names(const FlatScene& scene) {
  std::string text;
  for (std::size_t i = 0; i < scene.shape_names.size(); ++i) {
    const std::string& name = scene.shape_names[i];
    if (name == fmt::format("shape {}", i)) continue;  // without id
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", i, encode_text(name, ","));
  }
  return text;
}

}  // namespace kiloband
