// The beginning of a wave: camera rays, and the states of the paths.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_START_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_START_INL
#undef KILOBAND_START_INL
#else
#define KILOBAND_START_INL
#endif

#include <algorithm>

#include "film/spectral_film.hpp"
#include "src_cpu/path/camera-inl.hpp"
#include "src_cpu/path/wave.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// A block of kBlockSize, as far as the film reaches; `asked` is the part of it whose paths have a pixel.
struct WaveBlock {
  uint32_t x0, y0, width, height;
  PixelRect asked;
};

/// The pixel's number in the part that is asked for, or KB_NONE. column, row: in the block
KB_INLINE U pixel_numbers(const WaveBlock& block, F column, F row) {
  const F x = column - F(static_cast<float>(block.asked.x0 - block.x0));
  const F y = row - F(static_cast<float>(block.asked.y0 - block.y0));
  const F width(static_cast<float>(block.asked.width)), height(static_cast<float>(block.asked.height));
  const M inside = (x >= F(0)) & (x < width) & (y >= F(0)) & (y < height);
  return select(inside, to_words(y * width + x), U(KB_NONE));
}

KB_INLINE void store_rays(const CameraRays& ray, U path, RayQueue& rays, uint32_t first) {
  store(ray.origin.x, rays.ox + first);
  store(ray.origin.y, rays.oy + first);
  store(ray.origin.z, rays.oz + first);
  store(ray.direction.x, rays.dx + first);
  store(ray.direction.y, rays.dy + first);
  store(ray.direction.z, rays.dz + first);
  store(ray.t_min, rays.t_min + first);
  store(ray.t_max, rays.t_max + first);
  store(path, rays.path + first);
}

/// Paths `first` .. of the wave, row by row of the block.
/// common: what all paths begin with
KB_INLINE void start_lanes(const Bounce& bounce, const WaveBlock& block, const PathState& common, Wave& wave,
                           uint32_t first) {
  const KbCamera& camera = bounce.scene.camera;
  const U path = lane_numbers() + U(first);
  const F number = to_floats(path), width(static_cast<float>(block.width));
  // Halves are farther from whole numbers than the product is wrong.
  const F row = floor((number + F(0.5f)) * F(1 / static_cast<float>(block.width)));
  const F column = number - row * width;
  const U x = U(block.x0) + to_words(column), y = U(block.y0) + to_words(row);
  const SamplerKeys keys = sampler_keys(bounce.settings.seed, y * U(camera.film_width) + x, bounce.id.sample,
                                        bounce.id.replicate, bounce.id.index);
  const F4 u = sampler_block(bounce.sampler(), bounce.settings.seed, keys, U(KB_BLOCK_CAMERA));
  const CameraRays ray = sample_camera_rays(camera, bounce.scene.filter_cells.data(), x, y, u);
  store_rays(ray, path, wave.rays(), first);
  const V3Array origin(ray.origin);
  const uint32_t negative = bits_of(ray.sign < F(0));
  const WordArray pixel(pixel_numbers(block, column, row)), film_pixel(keys.pixel), key0(keys.key0),
      key1(keys.key1);
  each_lane(first_lanes(wave.rays().count - first), [&](uint32_t i) KB_LAMBDA {
    PathState& state = wave.paths[first + i];
    state = common;
    state.previous_point[0] = origin.x[i];
    state.previous_point[1] = origin.y[i];
    state.previous_point[2] = origin.z[i];
    state.pixel = pixel[i];
    state.flags = negative >> i & 1 ? kNegativePath : 0;
    state.film_pixel = film_pixel[i];
    state.key0 = key0[i];
    state.key1 = key1[i];
  });
}

/// The paths of the whole block of the film in which `asked` lies; outside of `asked` they have no pixel.
inline void start_wave(const Bounce& bounce, const PixelRect& asked, Wave& wave) {
  const KbCamera& camera = bounce.scene.camera;
  WaveBlock block{asked.x0 / kBlockSize * kBlockSize, asked.y0 / kBlockSize * kBlockSize, 0, 0, asked};
  block.width = std::min(kBlockSize, camera.film_width - block.x0);
  block.height = std::min(kBlockSize, camera.film_height - block.y0);
  PathState common = kNoPath;
  common.magnitude = 1;
  common.previous_delta = 1;
  RayQueue& rays = wave.rays();
  rays.count = block.width * block.height;
  for (uint32_t first = 0; first < rays.count; first += kLanes)
    start_lanes(bounce, block, common, wave, first);
  end_lanes();
  wave.path_count = rays.count;
  wave.paths[kWavePaths] = kNoPath;
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
