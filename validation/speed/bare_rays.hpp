// The ray queries that paths contain, alone: the rate of a tracer whose shading and random numbers cost nothing.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "src_cpu/block_worker.hpp"

namespace kiloband::speed {

/// A scene made ready for one thread.
struct BareScene {
  std::shared_ptr<const FlatScene> compiled;
  std::unique_ptr<cpu::EmbreeScene> embree;
  cpu::TracerTables tables;
  cpu::TracerScene tracer;
  std::vector<PixelRect> blocks;

  explicit BareScene(std::shared_ptr<const FlatScene> scene);
  BareScene(const BareScene&) = delete;  // tracer points to members

  std::size_t pixels() const { return std::size_t{compiled->film.crop_width} * compiled->film.crop_height; }
};

/// The rays of one sample of every pixel, path by path in the order of a scalar tracer (closest hit and shadow ray of each bounce), as single rays.
class BareSingles {
 public:
  explicit BareSingles(const BareScene& scene);
  /// Copies each ray (Embree answers in place) and asks for it. Returns how many hit.
  std::size_t query() const;
  std::size_t rays() const { return order_.size(); }

 private:
  void append(const cpu::Recording& recording);

  const BareScene& scene_;
  std::vector<cpu::TraceRay> closest_;
  std::vector<cpu::ShadowRay> shadow_;
  std::vector<uint32_t> order_;  // index << 1 | is_shadow
};

/// How the rays of a bounce are traced.
enum class BareWay {
  kPackets,  // by Embree: camera rays in coherent packets of 16, secondary rays in packets of 8, shadow rays 16
  kSorted,  // the same with secondary and shadow rays sorted (which query() does not do again) and coherent
  kFew      // against all triangles; the scene has few
};
/// In which the paths of the scene have theirs traced.
BareWay way_of_paths(const BareScene& scene);

/// The same rays bounce by bounce.
class BarePackets {
 public:
  /// throws std::logic_error  kFew, and the scene has more triangles
  BarePackets(const BareScene& scene, BareWay way);
  ~BarePackets();
  void query() const;

 private:
  struct Queue;
  void trace(const Queue& queue) const;
  void try_all(const Queue& queue) const;
  template <class Ray>
  void append(const std::vector<Ray>& rays, const std::vector<uint32_t>& path,
              const std::vector<std::size_t>& ends);

  const BareScene& scene_;
  BareWay way_;
  const cpu::PathKernels& kernels_;
  std::vector<Queue> queues_;
  std::unique_ptr<cpu::RayQueue> rays_;
  std::unique_ptr<cpu::ShadowQueue> shadows_;
};

}  // namespace kiloband::speed
