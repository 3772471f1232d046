// The camera rays of auxiliary images. camera-inl.hpp has those of paths.
#pragma once

#include <glm/glm.hpp>

#include "shared/records.h"

namespace kiloband::cpu {

struct CameraRay {
  glm::vec3 origin;     // world, m: the eye, not the near plane
  glm::vec3 direction;  // world, unit
  float t_min, t_max;   // m along direction: near and far clip planes
  float weight;         // 1, or -1 where the filter is negative
};

/// The table of gaussian_distance() (film/filter_table.hpp) for a gaussian filter of this radius / standard deviation; null
/// unless it is Mitsuba's, 4.
const KbFloat2* gaussian_table(float ratio);
/// The ray through the pixel's centre and the lens's centre, for auxiliary images.
CameraRay centre_camera_ray(const KbCamera& camera, uint32_t x, uint32_t y);

}  // namespace kiloband::cpu
