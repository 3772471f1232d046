// The one place that knows Embree (3.13; 4 behind compile guards, untested).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "scene/flat_scene.hpp"

namespace kiloband {

inline constexpr std::size_t kPacketSize = 16;

/// Rays in structure-of-arrays form, padded to whole packets. direction need not be unit; hits lie in (t_min, t_max).
struct RayQueue {
  std::vector<float> ox, oy, oz, dx, dy, dz, t_min, t_max;
  std::size_t size = 0;

  void reserve(std::size_t count);  // rounds up to whole packets
  void clear() { size = 0; }
  void push(const float (&origin)[3], const float (&direction)[3], float near_t, float far_t);
};

/// Nearest hits of the rays of a queue. shape is KB_NONE for a miss; primitive is the triangle within the shape.
struct HitQueue {
  std::vector<float> t, u, v;
  std::vector<uint32_t> shape, primitive;

  void resize(std::size_t count);
};

/// Whether rays go to Embree in packets of 16 or one by one.
enum class RayMode { kPackets, kSingle };

class EmbreeScene {
 public:
  /// isa: "sse4.2", "avx2" or "avx512": Embree's own code path, whose hits differ in their last bits.
  /// throws DeviceError naming Embree's error
  EmbreeScene(const FlatScene& scene, const std::string& isa, int threads);
  ~EmbreeScene();

  void closest_hits(const RayQueue& rays, HitQueue& hits, RayMode mode) const;
  /// occluded[i] = 1 if anything lies in (t_min, t_max) of ray i.
  void occlusions(const RayQueue& rays, std::vector<uint8_t>& occluded) const;
  /// Benchmarks: sends rays one by one in the given order (index << 1 | is_shadow) and returns the number of hits.
  std::size_t bare_queries(const RayQueue& closest, const RayQueue& shadow, std::span<const uint32_t> order) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kiloband
