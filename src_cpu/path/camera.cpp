// Camera rays one at a time: camera-inl.hpp for one lane.
#include "src_cpu/path/camera.hpp"

#include <cmath>
#include <vector>

#include "src_cpu/lanes/one_lane_glm.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/path/camera-inl.hpp"

namespace kiloband::cpu {
namespace {

constexpr float kUsualRatio = 4;  // Mitsuba's radius / stddev

}  // namespace

const KbFloat2* gaussian_table(float ratio) {
  static const std::vector<KbFloat2> table = make_gaussian_filter_table(kUsualRatio);  // on first use
  return std::fabs(ratio - kUsualRatio) < 1e-6f ? table.data() : nullptr;
}

CameraRay centre_camera_ray(const KbCamera& camera, uint32_t x, uint32_t y) {
  const one_lane::V2 centre{0.0f, 0.0f};
  const one_lane::CameraRays ray = one_lane::rays_through(camera, x, y, centre, centre);
  return {to_glm(ray.origin), to_glm(ray.direction), ray.t_min.v, ray.t_max.v, ray.sign.v};
}

}  // namespace kiloband::cpu
