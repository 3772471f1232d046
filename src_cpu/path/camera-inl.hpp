// Camera rays. Conventions of Mitsuba 3: local +Z views, +X is the image's left, film position s in
// [0,1]^2, s_y down.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_CAMERA_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_CAMERA_INL
#undef KILOBAND_CAMERA_INL
#else
#define KILOBAND_CAMERA_INL
#endif

#include "film/filter_table.hpp"
#include "src_cpu/lanes/lane_access-inl.hpp"
#include "src_cpu/lanes/lane_sampler-inl.hpp"
#include "src_cpu/light/area-inl.hpp"
#include "src_cpu/path/camera.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// CameraRay in lanes.
struct CameraRays {
  V3 origin, direction;
  F t_min, t_max;
  F sign;  // of the reconstruction filter: 1 or -1
};

/// A distance along an axis from the pixel's centre, and the filter's sign there.
struct FilterSample {
  F offset;
  F sign;
};

/// gaussian_distance() of film/filter_table.hpp.
KB_INLINE F gaussian_distance(const KbFloat2* table, F w) {
  const F position = sqrt(w) * F(kFilterPieces);
  const F piece = min(floor(position), F(kFilterPieces - 1));
  const F t = position - piece;
  const V2 a = gather_pair(table, to_words(piece)), b = gather_pair(table + 1, to_words(piece));
  const F rise = b.x - a.x;
  const F c2 = F(3) * rise - F(2) * a.y - b.y, c3 = a.y + b.y - F(2) * rise;
  return a.x + t * (a.y + t * (c2 + t * c3));
}

/// For filters that no scene file has: without a table, one lane after another.
inline F exact_gaussian_distance(F w, float ratio) {
  FloatArray x(w);
  for (uint32_t i = 0; i < kLanes; ++i) x[i] = static_cast<float>(invert_gaussian_tail(x[i], ratio));
  return x;
}

/// film/signed_filter.hpp. u < 1/2 lies on one side, at the distribution's 1 - 2 u, the others on the other.
KB_INLINE FilterSample sample_tabulated_filter(float radius, const float* cells, F u) {
  const M left = u < F(0.5f);
  // Below 1, which no cell begins at.
  const F p = min(abs(F(1) - F(2) * u), F(KB_ONE_MINUS_EPSILON));
  const U cell = find_interval(cells, U(0u), U(kFilterPieces), p);
  const F low = gather(cells, cell), high = gather(cells + 1, cell);
  const F within = min(max((p - low) / (high - low), F(0)), F(1));
  const F distance = (to_floats(cell) + within) * F(radius / kFilterPieces);
  return {select(left, -distance, distance), gather(cells + kFilterPieces + 1, cell)};
}

/// Offset from the pixel's centre along one axis, in pixels.
KB_INLINE F sample_positive_filter(const KbCamera& camera, F u) {
  if (camera.filter == KB_FILTER_BOX) return u - F(0.5f);  // the pixel itself
  const M left = u < F(0.5f);
  const F w = select(left, F(2) * u, F(2) * (F(1) - u));  // probability to be farther away
  F distance;
  if (camera.filter == KB_FILTER_TENT) {
    distance = F(camera.filter_radius) * (F(1) - sqrt(w));  // the density is 1 - |x| on [-1, 1]
  } else {
    const float ratio = camera.filter_radius / camera.filter_stddev;
    const KbFloat2* table = gaussian_table(ratio);
    distance =
        F(camera.filter_stddev) * (table ? gaussian_distance(table, w) : exact_gaussian_distance(w, ratio));
  }
  return select(left, -distance, distance);
}

KB_INLINE FilterSample sample_filter(const KbCamera& camera, const float* cells, F u) {
  if (camera.filter == KB_FILTER_TABULATED) return sample_tabulated_filter(camera.filter_radius, cells, u);
  return {sample_positive_filter(camera, u), F(1)};
}

// ---- projections -------------------------------------------------------------------------------------

/// A position on the film of `size` pixels along an axis, s = (pixel + 1/2 + offset) / size + principal, to the image plane,
/// (1 - 2 s) size / film_width: x in [-1, 1] leftwards, y upwards in the same unit. In double up to the last rounding, so
/// that sub-pixel positions of large films stay exact. Films of up to 2^24 pixels along an axis.
KB_INLINE F image_plane(uint32_t size, U pixel, F offset, double principal, uint32_t film_width) {
  const D beyond_first = to_doubles(to_floats(pixel)) + to_doubles(offset);
  const D from_middle = to_doubles(size - 1.0 - 2 * principal * size) - to_doubles(2.0) * beyond_first;
  return to_floats(from_middle * to_doubles(1.0 / film_width));
}

/// The ray is the plane's normal; to_world scales the film. As in Mitsuba the near plane lies at
/// local z = near_clip, and far_clip - near_clip is measured in the world.
KB_INLINE CameraRays orthographic_rays(const KbCamera& camera, V2 plane) {
  const V3 axis{F(camera.to_world[2]), F(camera.to_world[6]), F(camera.to_world[10])};
  const F scale = length(axis);
  const F t_min = F(camera.near_clip) * scale;
  return {transform_point(camera.to_world, {plane.x, plane.y, F(0)}), axis / scale, t_min,
          t_min + F(camera.far_clip - camera.near_clip), F(1)};
}

/// Pinhole (lens = 0) or thin lens: all rays of a film position meet on the plane z = focus_distance.
KB_INLINE CameraRays perspective_rays(const KbCamera& camera, V2 plane, V2 lens) {
  const F half_width(camera.tan_half_fov_x);
  V3 local{plane.x * half_width, plane.y * half_width, F(1)};
  if (camera.type == KB_CAMERA_THINLENS) local = local * F(camera.focus_distance) - V3{lens.x, lens.y, F(0)};
  const F per_depth = length(local) / local.z;  // distance along the ray per unit of depth
  return {transform_point(camera.to_world, {lens.x, lens.y, F(0)}),
          normalize(transform_vector(camera.to_world, local)), F(camera.near_clip) * per_depth,
          F(camera.far_clip) * per_depth, F(1)};
}

/// offset: from the pixel's centre, in pixels
KB_INLINE CameraRays rays_through(const KbCamera& camera, U x, U y, V2 offset, V2 lens) {
  const bool orthographic = camera.type == KB_CAMERA_ORTHOGRAPHIC;  // has no principal point
  const double principal_x = orthographic ? 0 : camera.principal_x;
  const double principal_y = orthographic ? 0 : camera.principal_y;
  const V2 plane{image_plane(camera.film_width, x, offset.x, principal_x, camera.film_width),
                 image_plane(camera.film_height, y, offset.y, principal_y, camera.film_width)};
  return orthographic ? orthographic_rays(camera, plane) : perspective_rays(camera, plane, lens);
}

/// Through pixels (x, y) of the full film. Filter importance sampling: film positions are drawn from the reconstruction
/// filter's modulus around the pixel's centre, so every sample has weight 1 or -1 (FlatScene::filter_scale is the film's).
/// u  film position, lens; filter_cells: FlatScene's
KB_INLINE CameraRays sample_camera_rays(const KbCamera& camera, const float* filter_cells, U x, U y,
                                        const F4& u) {
  const FilterSample across = sample_filter(camera, filter_cells, u.x),
                     down = sample_filter(camera, filter_cells, u.y);
  V2 lens{F(0), F(0)};
  if (camera.type == KB_CAMERA_THINLENS) {
    const V2 disk = concentric_disk(u.z, u.w);
    lens = {F(camera.aperture_radius) * disk.x, F(camera.aperture_radius) * disk.y};
  }
  CameraRays rays = rays_through(camera, x, y, {across.offset, down.offset}, lens);
  rays.sign = across.sign * down.sign;
  return rays;
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
