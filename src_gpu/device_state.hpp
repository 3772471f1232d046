// Everything of a render that lives on one device; made anew after the device was lost.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/backend.hpp"
#include "scene/description/derived_channels.hpp"
#include "src_gpu/evaluate/device_replicates.hpp"
#include "src_gpu/evaluate/evaluation.hpp"
#include "src_gpu/path/path_pool.hpp"
#include "src_gpu/path/round_plan.hpp"
#include "src_gpu/scene/device_scene.hpp"
#include "src_gpu/tuning/tuning.hpp"

namespace kiloband::opencl {

/// What is prepared on the host, once per render.
struct HostScene {
  HostScene(std::shared_ptr<const FlatScene> flat, const DerivedChannels& derived_channels);

  /// Film unit in W m^-2 sr^-1, channels then derived ones.
  std::vector<double> film_scale() const;

  std::shared_ptr<const FlatScene> kept;
  const FlatScene& scene;
  DerivedChannels derived;
  ChannelTables spectra;
  Bvh bvh;
};

struct DeviceSettings {
  Method method = Method::kDpeptBatch;
  bool shared_wavelengths = true;
  bool specialised = true;
  bool program_cache = true;
  std::optional<uint64_t> memory_budget;
  Tuning tuning;  // of work-groups
};

class DeviceState {
 public:
  /// throws DeviceOutOfMemory  the scene alone does not fit; DeviceLost, DeviceError
  DeviceState(DeviceContext& device_context, const HostScene& host, const DeviceSettings& device_settings);

  /// Memory of a round and the film of `film_pixels` pixels.
  /// throws DeviceOutOfMemory
  void make_pool(const PoolSize& size, uint64_t film_pixels, FilmForm form);
  void release_pool();
  /// The host's scene has another camera.
  void camera_moved();
  bool has_pool() const { return pool_.has_value(); }

  /// Bytes that a film pixel, a dense table of spectra, a slot (beside the pool's own) take.
  uint64_t film_bytes_per_pixel(FilmForm form) const;
  uint64_t table_bytes() const;
  uint64_t slot_bytes() const;
  bool has_dispersion() const { return host_.scene.features.dispersion; }
  uint32_t chunk_entries() const { return opencl::chunk_entries(method, host_.scene.features); }
  uint32_t derived_channels() const { return host_.spectra.layout.derived; }
  bool has_gas() const { return host_.scene.features.gas; }
  bool has_instances() const { return host_.scene.features.instances; }
  const SceneFeatures& features() const { return host_.scene.features; }

  /// Resident as long as there is a pool.
  DeviceFilm& film() { return *film_; }
  /// If the film's form has moments.
  DeviceReplicates& replicates() { return *replicates_; }
  /// Traces the round's paths; with the method pt it also evaluates them. film_pixel: where the round's
  /// pixels begin in the film. Waits, once or twice: what was enqueued before is then done, too.
  RoundOutcome generate(const KbRound& round, std::span<const KbRoundPixel> pixels, std::span<const float> mu,
                        uint64_t film_pixel);
  /// Evaluates what generate() saved. Enqueued: the next generate() waits for it, or what brings the film to the host.
  void evaluate(const KbRound& round, uint64_t film_pixel);

  /// What the rays of a round find and the vertices that are saved, by job. hits: without, nothing is said of rays, and the stages
  /// are launched as for an image.
  std::vector<TracedPath> trace(const KbRound& round, std::span<const KbRoundPixel> pixels,
                                std::span<const float> mu, bool hits);

  std::vector<AuxiliaryPixel> auxiliary(const PixelRect& rect);

  DeviceContext& context;
  DeviceMemory memory;
  const Method method;

 private:
  std::vector<KbPathVertex> saved_entries(const KbSavedPath& saved, const std::vector<KbPathVertex>& arena,
                                          const std::vector<uint32_t>& chunk_next) const;
  const HostScene& host_;
  DeviceSettings settings_;
  EvaluationShape shape_;
  Program paths_;
  DeviceScene scene_;
  DeviceBvh bvh_;
  DeviceSpectra spectra_;
  std::optional<PathPool> pool_;
  std::optional<DeviceFilm> film_;
  std::optional<DeviceReplicates> replicates_;
  std::optional<Evaluation> evaluation_;
};

/// On PoCL the fastest at every number of channels that was measured, 8 to 1024 (validation/README.md).
/// The DPEPT paper finds dpept-path ahead below 16 channels on GPUs with 16-wide SIMD; no GPU has been
/// measured here.
inline constexpr Method kDefaultMethod = Method::kDpeptBatch;

}  // namespace kiloband::opencl
