// The streaming pool: generates the paths of a round (kernels/path/paths.cl) and leaves them saved on the device.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "shared/pipeline.h"
#include "src_gpu/device/program.hpp"
#include "src_gpu/scene/device_scene.hpp"

namespace kiloband::gpu {

/// Capacities. Bytes of each: see path_pool_bytes().
struct PoolSize {
  uint32_t slots = 0;                     // paths in flight
  uint32_t arena_chunks = 0;              // the method pt has one per slot
  uint32_t jobs = 0;                      // largest samples * padded_pixels of a round
  uint32_t pixels = 0;                    // largest padded_pixels of a round
  uint32_t tables = 0;                    // largest blocks * samples of a round
  uint32_t chunk_slots = KB_CHUNK_SLOTS;  // vertices of a chunk
  bool dispersion = false;                // the scene has boundaries whose index depends on wavelength
  bool gas = false;                       // the scene has gas
};

uint64_t path_pool_bytes(const PoolSize& size);

/// What a round came to.
struct RoundOutcome {
  bool arena_full = false;  // nothing of it counts: repeat it with fewer paths
  uint64_t rays = 0, vertices = 0;
  uint32_t chunks = 0;  // of the arena that were used
  uint32_t iterations = 0;
  uint64_t invalid = 0;                // paths that leave the mean
  std::vector<uint32_t> invalid_jobs;  // the first of them, ascending
  double longest_launch_seconds = 0;   // of the kernels that run over slots
};

/// throws std::logic_error for what only a bug of ours can raise
void throw_for_bugs(const KbFaults& faults);

class PathPool {
 public:
  /// method_pt  the program was built with KB_METHOD_PT=1: vertices stay in a slot's own chunk for one bounce
  PathPool(DeviceContext& context, DeviceMemory& memory, const Program& program, const DeviceScene& scene,
           const DeviceBvh& bvh, const DeviceSpectra& spectra, const PoolSize& size);

  const PoolSize& size() const { return size_; }

  /// Uploads the round. pixels: [padded_pixels], those past round.pixels are not read. mu: by block and
  /// sample (shared wavelengths).
  void begin(const KbRound& round, std::span<const KbRoundPixel> pixels, std::span<const float> mu);
  /// Runs it to its end. after_bounce (pt): called with queue and count once per iteration,
  /// when shadow rays are done.
  /// throws std::logic_error  faults that are bugs of ours
  ///        DeviceLost ...
  using AfterBounce = std::function<void(const DeviceBuffer<uint32_t>& queue, uint32_t count)>;
  RoundOutcome run(const KbRound& round, const AfterBounce& after_bounce = {});
  /// Called between tracing and shading of every iteration (debugging, parity tests).
  void observe_hits(AfterBounce observer) { on_hits_ = std::move(observer); }

  const DeviceBuffer<KbRound>& round() const { return round_; }
  const DeviceBuffer<KbRoundPixel>& pixels() const { return pixels_; }
  const DeviceBuffer<float>& mu() const { return mu_; }
  const DeviceBuffer<KbPathState>& states() const { return states_; }
  const DeviceBuffer<KbPathVertex>& arena() const { return arena_; }
  const DeviceBuffer<uint32_t>& chunk_next() const { return chunk_next_; }
  const DeviceBuffer<KbSavedPath>& saved() const { return saved_; }
  const DeviceBuffer<KbHit>& hits() const { return hits_; }
  const DeviceBuffer<KbRay>& rays() const { return rays_; }

 private:
  void bind(const DeviceScene& scene, const DeviceBvh& bvh, const DeviceSpectra& spectra);
  void iterate(const AfterBounce& after_bounce);
  void launch(Kernel& kernel, uint32_t queue_argument);
  bool compact();
  void add_tallies(uint32_t slots, RoundOutcome& outcome) const;

  DeviceContext& context_;
  PoolSize size_;
  DeviceBuffer<KbRound> round_;
  DeviceBuffer<KbRoundPixel> pixels_;
  DeviceBuffer<float> mu_;
  DeviceBuffer<KbPathState> states_;
  DeviceBuffer<KbRay> rays_;
  DeviceBuffer<KbHit> hits_;
  DeviceBuffer<KbShadowRay> shadows_;
  DeviceBuffer<KbPathVertex> arena_;
  DeviceBuffer<uint32_t> chunk_next_;
  DeviceBuffer<KbSavedPath> saved_;
  DeviceBuffer<KbFaults> faults_;
  DeviceBuffer<KbDispersionState> dispersion_;  // by slot
  DeviceBuffer<KbGasState> gas_;
  DeviceBuffer<uint64_t> tallies_;  // by slot: rays in the low word, vertices in the high one
  DeviceBuffer<uint32_t> queue_, packed_;
  Kernel reset_, generate_, closest_, shade_, any_, compact_;
  AfterBounce on_hits_;
  uint32_t count_ = 0;  // slots in the queue
};

}  // namespace kiloband::gpu
