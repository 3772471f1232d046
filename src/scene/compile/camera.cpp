#include "scene/compile/camera.hpp"

#include <cmath>

#include "film/signed_filter.hpp"
#include "scene/compile/camera_media.hpp"
#include "scene/compile/place.hpp"
#include "scene/compile/record_vectors.hpp"

namespace kiloband {

namespace {

void set_filter(FlatScene& scene, const Film& film) {
  KbCamera& camera = scene.camera;
  camera.filter_radius = static_cast<float>(film.filter_radius);
  camera.filter_stddev = static_cast<float>(film.filter_stddev);
  switch (film.filter) {
    case FilterType::kBox:
      camera.filter = KB_FILTER_BOX;
      return;
    case FilterType::kTent:
      camera.filter = KB_FILTER_TENT;
      return;
    case FilterType::kGaussian:
      camera.filter = KB_FILTER_GAUSSIAN;
      return;
    case FilterType::kMitchell:
    case FilterType::kLanczos:
      break;
  }
  const bool cubic = film.filter == FilterType::kMitchell;
  SignedFilter filter = make_signed_filter(
      [&](double x) {
        return cubic ? mitchell(x, film.filter_b, film.filter_c) : lanczos(x, film.filter_radius);
      },
      film.filter_radius);
  camera.filter = KB_FILTER_TABULATED;
  scene.filter_cells = std::move(filter.cells);
  scene.filter_scale = filter.scale;
  scene.features.signed_filter = filter.negative;
}

/// All of the camera but its filter, and the media in which its rays begin.
void place_camera(FlatScene& scene, const Sensor& sensor) {
  KbCamera& camera = scene.camera;
  Sensor placed = sensor;
  placed.to_world = placed_at(scene.origin, sensor.to_world);
  camera.film_width = sensor.film.width;
  camera.film_height = sensor.film.height;
  camera.principal_x = static_cast<float>(sensor.principal_point_x);
  camera.principal_y = static_cast<float>(sensor.principal_point_y);
  camera.near_clip = static_cast<float>(sensor.near_clip);
  camera.far_clip = static_cast<float>(sensor.far_clip);
  store_transform(placed.to_world, camera.to_world);
  if (const auto* perspective = std::get_if<PerspectiveSensor>(&sensor.model)) {
    camera.type = KB_CAMERA_PERSPECTIVE;
    camera.tan_half_fov_x = static_cast<float>(std::tan(0.5 * perspective->fov_x));
  } else if (const auto* lens = std::get_if<ThinLensSensor>(&sensor.model)) {
    camera.type = KB_CAMERA_THINLENS;
    camera.tan_half_fov_x = static_cast<float>(std::tan(0.5 * lens->fov_x));
    camera.aperture_radius = static_cast<float>(lens->aperture_radius);
    camera.focus_distance = static_cast<float>(lens->focus_distance);
  } else {
    camera.type = KB_CAMERA_ORTHOGRAPHIC;
  }
  if (scene.features.gas) scene.camera_media = media_at_camera(scene, placed);
}

}  // namespace

void set_camera(FlatScene& scene, const Sensor& sensor) {
  set_filter(scene, sensor.film);
  place_camera(scene, sensor);
}

void move_camera(FlatScene& scene, const Sensor& sensor) {
  check_camera_place(sensor);
  place_camera(scene, sensor);
}

}  // namespace kiloband
