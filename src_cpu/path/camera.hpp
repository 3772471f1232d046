// Camera rays. camera-inl.hpp has them over lanes, this is one lane.
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

/// One ray through pixel (x, y) of the full film. Filter importance sampling: the film position is drawn from
/// the reconstruction filter's modulus around the pixel's centre, so every sample has weight 1 or -1
/// (FlatScene::filter_scale is the film's).
/// u  x, y: film position; z, w: lens; uniform in [0,1)
/// filter_cells  FlatScene's; other filters than KB_FILTER_TABULATED need none
CameraRay sample_camera_ray(const KbCamera& camera, uint32_t x, uint32_t y, const KbFloat4& u,
                            const float* filter_cells = nullptr);
/// The table of gaussian_distance() (film/filter_table.hpp) for a gaussian filter of this radius / standard deviation; null
/// unless it is Mitsuba's, 4.
const KbFloat2* gaussian_table(float ratio);
/// The ray through the pixel's centre and the lens's centre, for auxiliary images.
CameraRay centre_camera_ray(const KbCamera& camera, uint32_t x, uint32_t y);

}  // namespace kiloband::cpu
