// What a pixel of a cube covers: its solid angle or, for parallel projections, its area.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "cube/cube_io.hpp"

namespace kiloband {

/// The camera of a cube, as its metadata "camera" keep it.
/// Pinhole and thin-lens cameras alike project from one point.
struct CameraGeometry {
  bool orthographic = false;
  double pixel_area_m2 = 0;                  // orthographic: perpendicular to the line of sight
  uint32_t film_width = 0, film_height = 0;  // of the full film, pixels
  uint32_t crop_x = 0, crop_y = 0;           // where the cube begins in it
  double tan_half_fov_x = 0;                 // of the full film's width
  double principal_x = 0, principal_y = 0;   // offset, fractions of the film

  /// Solid angle (sr) that the pixel subtends at the camera, or its area (m^2) if orthographic. Pixels count
  /// from the cube's upper left corner. The plane at distance 1 is divided into squares of area a; one seen
  /// under the angle t from the axis subtends a cos^3 t, to a relative error of less than a.
  double pixel_weight(uint32_t x, uint32_t y) const;

  std::string to_text() const;
};

inline constexpr const char* kCameraKey = "camera";

/// The camera that a cube's metadata state; nothing if there is none.
/// throws InputError  `where`: text that to_text() cannot have written
std::optional<CameraGeometry> camera_of_cube(const CubeInfo& info, const std::string& where);

/// The cube's camera after it was cropped at (x0, y0): changes the metadata.
void crop_camera(CubeInfo& info, uint32_t x0, uint32_t y0);

}  // namespace kiloband
