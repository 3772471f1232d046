// Evaluation of paths into the film on the device: the kernels of evaluate.cl, pt.cl and resample.cl.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/compile/scene_features.hpp"
#include "src_gpu/device/program.hpp"
#include "src_gpu/evaluate/device_film.hpp"
#include "src_gpu/path/path_pool.hpp"
#include "src_gpu/path/round_plan.hpp"
#include "src_gpu/scene/device_scene.hpp"

namespace kiloband::opencl {

/// What the vertices of a scene refer to, at most: the less, the fewer registers evaluation takes.
enum class VertexSpectra {
  kOneReflectance,  // besides light samples and emission: diffuse and smooth surfaces, of named spectra
  kRows,            // two reflectances too
  kAny              // texels, temperatures, indices of refraction, gas
};

/// specialised  kernels are compiled for the features; else for any
VertexSpectra vertex_spectra(const SceneFeatures& features, bool specialised);

/// What a render asks of evaluation.
struct EvaluationTask {
  Method method = Method::kDpeptBatch;
  bool shared_wavelengths = true;
  uint32_t channels = 1;
  VertexSpectra vertices = VertexSpectra::kAny;
};

EvaluationTask evaluation_task(const FlatScene& scene, Method method, bool shared_wavelengths,
                               bool specialised);

/// How evaluation is compiled and launched; what follows from device and task.
struct EvaluationShape {
  Method method = Method::kDpeptBatch;
  bool shared_wavelengths = true;
  uint32_t width = 1;       // channels of a vector
  uint32_t vectors = 1;     // of a work-item at a time
  uint32_t local_size = 1;  // work-items that share a path
  uint32_t units_per_group =
      1;  // pixels (dpept_batch) or slots (pt) that a work-group takes; staged: side by side
  uint32_t registers = samples_in_registers(false);  // samples that are summed there
  uint32_t most_registers = 0;  // that NVIDIA's compiler is held to, for more warps; 0: any number
  bool film_transposed = false;
  bool staged =
      false;  // dpept_batch: work-groups bring vertices to local memory (kernels/evaluate/stage.clh)

  std::vector<std::string> defines(uint32_t derived) const;
  uint32_t group_size() const { return staged ? local_size * units_per_group : local_size; }
};

/// largest_group  work-items of a group of a GPU, at most; nothing: 64 for dpept-path, whose work-items have a path each; 256 for the
///                others, which share one, and 64 where pixels side by side fill it
EvaluationShape evaluation_shape(const DeviceInfo& device, const EvaluationTask& task,
                                 std::optional<uint32_t> largest_group = {});

/// Work-items that share a path: no more of them in a group than the compiled kernel can have, whose registers may allow fewer than the
/// device does.
/// throws DeviceError  not even one for each pixel
uint32_t fitting_local_size(const EvaluationShape& shape, uint64_t kernel_limit);

/// Bytes, from the layout alone: per pixel of the round, per dense table of spectra, per slot (pt).
uint64_t partial_bytes(const KbSpectraLayout& layout, const EvaluationShape& shape);
uint64_t table_bytes(const KbSpectraLayout& layout, const EvaluationShape& shape);
uint64_t slot_bytes(const KbSpectraLayout& layout, const EvaluationShape& shape);

class Evaluation {
 public:
  /// defines  of the scene (scene_defines); the film must outlive the evaluation
  Evaluation(DeviceContext& context, DeviceMemory& memory, const KbSpectraLayout& layout,
             const EvaluationShape& shape, const std::vector<std::string>& defines, bool program_cache,
             const PoolSize& pool, const DeviceFilm& film);

  /// Sets what does not change from launch to launch, before anything else; the arguments must outlive this object.
  void bind(const DeviceScene& scene, const DeviceSpectra& spectra, const PathPool& pool);

  /// Dense spectra of the round (shared wavelengths): before its paths are evaluated.
  void resample(const KbRound& round);
  /// dpept: the round's saved paths. Enqueued, not waited for.
  void evaluate(const KbRound& round, uint64_t film_pixel);
  /// pt: one bounce of the slots in the queue.
  void update(const LaunchQueue& queue, uint64_t film_pixel);

 private:
  KbSpectraLayout layout_;
  EvaluationShape shape_;
  const DeviceFilm& film_;
  EvaluationArguments::Of<DeviceBuffer> buffers_;
  Program program_;
  std::optional<Program> resample_program_;
  EvaluationKernel main_;
  std::optional<EvaluationKernel> resample_, derived_;
};

}  // namespace kiloband::opencl
