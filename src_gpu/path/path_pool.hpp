// The streaming pool: generates the paths of a round (kernels/path/paths.cl) and leaves them saved on the device.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "shared/pipeline.h"
#include "src_gpu/device/program.hpp"
#include "src_gpu/scene/device_scene.hpp"

namespace kiloband::opencl {

/// Capacities. Bytes of each: see path_pool_bytes().
struct PoolSize {
  uint32_t slots = 0;                         // paths in flight
  uint32_t arena_chunks = 0;                  // the method pt has one per slot
  uint32_t jobs = 0;                          // largest samples * padded_pixels of a round
  uint32_t pixels = 0;                        // largest padded_pixels of a round
  uint32_t tables = 0;                        // largest blocks * samples of a round
  uint32_t chunk_entries = KB_CHUNK_ENTRIES;  // vertices of a chunk
  bool dispersion = false;                    // the scene has boundaries whose index depends on wavelength
  bool gas = false;                           // the scene has gas
  bool instances = false;                     // the scene has instances
  uint32_t shading_keys = 0;                  // shading_keys()
};

uint64_t path_pool_bytes(const PoolSize& size);

/// Slots that a work-item of path generation takes (KB_SLOTS_PER_ITEM): CPU devices have groups of one work-item with a loop
/// (kernels/path/path.clh).
uint32_t slots_per_item(const DeviceInfo& device);

/// Kinds of material that GPUs shade one after the other, with a kind for rays that hit nothing (KB_SHADING_KEYS); 0: paths are shaded as
/// they stand in the queue, on CPU devices and in scenes of one kind.
uint32_t shading_keys(const DeviceInfo& device, const SceneFeatures& features);

/// Slots of a launch on the device, and how many work-items are enough for them.
struct LaunchQueue {
  QueueArguments::Of<BufferRef> slots;
  uint32_t most = 0;
};

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

/// Work-items of a group where nobody says otherwise: an H100 takes 1 to 5 % less time than with 64, or with 256.
inline constexpr uint32_t kPoolLocalSize = 128;

/// throws std::logic_error for what only a bug of ours can raise
void throw_for_bugs(const KbFaults& faults);

using PoolBuffers = PoolArguments::Of<DeviceBuffer>;

class PathPool {
 public:
  /// program  built with KB_SLOTS_PER_ITEM=slots_per_item(device); for the method pt with KB_METHOD_PT=1 (vertices stay in a slot's
  ///          own chunk for one bounce); group: work-items of a group, if the kernel can have as many; CPU devices have one
  PathPool(DeviceContext& context, DeviceMemory& memory, const Program& program, const DeviceScene& scene,
           const DeviceBvh& bvh, const DeviceSpectra& spectra, const PoolSize& size, uint32_t group);
  /// Waits: the device may be reading a round that was begun.
  ~PathPool() { context_.settle(); }
  PathPool(const PathPool&) = delete;
  PathPool& operator=(const PathPool&) = delete;

  const PoolSize& size() const { return size_; }

  /// Enqueues the round, of which copies are kept. pixels: [padded_pixels], those past round.pixels are not read. mu: by block and
  /// sample (shared wavelengths).
  void begin(const KbRound& round, std::span<const KbRoundPixel> pixels, std::span<const float> mu);
  /// Runs it to its end. after_bounce (pt): called with the queue once per iteration, when shadow rays are done.
  /// throws std::logic_error  faults that are bugs of ours
  ///        DeviceLost ...
  using AfterBounce = std::function<void(const LaunchQueue& queue)>;
  RoundOutcome run(const KbRound& round, const AfterBounce& after_bounce = {});
  /// Called between tracing and shading of every iteration (debugging, parity tests); the stages are launched one by one then.
  void observe_hits(AfterBounce observer) { on_hits_ = std::move(observer); }

  const PoolBuffers& buffers() const { return buffers_; }
  LaunchQueue queue() const {
    return {{.slots = queue_,
             .length = length_,
             .packed = packed_,
             .packed_length = packed_length_,
             .ordered = ordered_,
             .ordered_lengths = ordered_lengths_},
            count_};
  }

 private:
  void set_arguments(PathKernel& kernel, const DeviceScene& scene, const DeviceSpectra& spectra,
                     const DeviceBvh& bvh);
  void iterate(const AfterBounce& after_bounce);
  void iterate_until_packing(const AfterBounce& after_bounce);
  void launch(PathKernel& kernel, uint64_t more = 0);
  uint64_t open_places() const;
  void compact();
  bool look(RoundOutcome& outcome);
  uint32_t expected_iterations(double jobs_each) const;
  void learn(double jobs_each, uint32_t iterations, bool at_first_look);

  DeviceContext& context_;
  PoolSize size_;
  uint32_t group_;
  PoolBuffers buffers_;
  DeviceBuffer<uint32_t> queue_, length_, packed_, packed_length_, ordered_, ordered_lengths_;
  PathKernel reset_, generate_, closest_, shade_, any_, compact_, tallies_;
  std::optional<PathKernel> whole_;  // of CPU devices: the four of an iteration in one
  AfterBounce on_hits_;
  uint32_t count_ = 0;  // slots in the queue, at most
  // What the device may still be reading or writing.
  KbRound round_{};
  KbFaults faults_{};
  std::vector<KbRoundPixel> pixels_;
  std::vector<float> mu_;
  // Of rounds before: jobs of a slot, iterations that they took; rounds that were through at the first look.
  double known_jobs_ = 0;
  uint32_t known_iterations_ = 0, early_rounds_ = 0;
};

}  // namespace kiloband::opencl
