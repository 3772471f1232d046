// Runs the evaluation kernels on saved paths, with buffers of its own:
// what the renderer does, without tracing.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "src_cpu/path/path_buffer.hpp"
#include "src_gpu/device/kernel_groups.hpp"
#include "src_gpu/scene/channel_tables.hpp"
#include "tests/support/opencl_probe.hpp"

namespace kiloband::test {

using namespace cpu;

/// Slots of a vertex with its texture samples.
uint32_t entries_of(const KbPathVertex& vertex);

/// The macros of a build.
struct EvaluatorBuild {
  uint32_t width = 16;
  uint32_t vectors = 1;
  bool per_path = false;
  uint32_t derived = 0;
  bool transposed = false;
  uint32_t tile = 1;     // KB_PIXELS
  std::string features;  // "-DKB_SPECIALISED -DKB_HAS_..."; empty: everything
  bool staged = false;   // KB_STAGED: dpept_batch alone
  std::optional<uint32_t>
      stage_entries;  // KB_STAGE_ENTRIES; nothing: as many as the kernels have by themselves

  std::string options() const;
  std::string film_options() const;
};

/// Compiled kernels; scenes share them. As the renderer has them, resampling and film are programs of their own: builds that differ in
/// all else find them in the driver's cache.
struct EvaluatorProgram {
  explicit EvaluatorProgram(const EvaluatorBuild& build);
  EvaluatorBuild build;
  OpenclProbe probe;  // evaluation
  cl::Program resample, film;
};

/// What a round evaluates: for every job (sample * pixels + pixel) a path of the buffer.
struct RoundOfPaths {
  static constexpr uint32_t kEmpty = 0xfffffffeu, kInvalid = 0xffffffffu;
  uint32_t pixels = 1, samples = 1;
  std::vector<uint32_t> path;   // of the job: an index, kEmpty or kInvalid
  std::vector<float> mu;        // [block][sample], shared wavelengths
  std::vector<uint32_t> block;  // of a pixel
  uint32_t blocks = 1;
  uint32_t first_index = 0;
};

/// mu of a job where every path has its own.
float per_path_mu(const RoundOfPaths& round, uint32_t pixel, uint32_t sample);

/// Processor seconds of this program, of all threads, as if all cores had shared them: other programs disturb
/// them less than wall time.
double processor_seconds();

/// What bounces of the method pt take.
struct PtTiming {
  double seconds = 0;           // of all bounces, the best of the repetitions
  double bytes = 0;             // states and film that they move
  std::size_t state_bytes = 0;  // of throughputs and radiances
};

/// A film, and evaluations that add to it.
class DeviceEvaluator {
 public:
  DeviceEvaluator(EvaluatorProgram& program, const FlatScene& scene, const opencl::ChannelTables& tables,
                  uint32_t film_pixels);

  /// Uploads the paths and resamples the spectra. scattered: over the arena's chunks in a random order, else
  /// as the pool would leave them.
  void load(const PathBuffer& paths, const RoundOfPaths& round, bool scattered = true);

  /// local_size: work-items that share a path
  void batch(uint32_t local_size, uint32_t groups);
  void path(uint32_t local_size = 1);
  /// Bounce by bounce with `slots` slots, as the streaming pipeline does.
  void pt(const PathBuffer& paths, uint32_t slots, uint32_t local_size);

  /// Times whole paths of pt: `slots` paths of `bounces` diffuse vertices with a light sample each, begun,
  /// continued and added to the film together. The film needs a pixel per slot or divides them.
  PtTiming time_pt(uint32_t slots, uint32_t groups, uint32_t bounces, uint32_t repetitions);
  /// Fills the dense rows anew.
  void resample();

  void clear();
  /// Means [pixel][K + D], in film units.
  std::vector<float> means();
  std::vector<uint32_t> counts();

  cl::Kernel batch_kernel();
  cl::Kernel path_kernel();
  EvaluatorProgram& program() { return program_; }
  const KbSpectraLayout& layout() const { return layout_; }

 private:
  /// With all its groups set to what they hold now.
  cl::Kernel evaluation_kernel(const char* name);
  cl::Kernel evaluation_kernel(const cl::Program& program, const char* name);
  cl::Kernel film_kernel(const char* name, const cl::Buffer& packed);
  template <class... Groups>
  cl::Kernel kernel(const cl::Program& program, const char* name, const Groups&... groups);
  void run(cl::Kernel& kernel, std::size_t items, std::size_t local);

  EvaluatorProgram& program_;
  KbSpectraLayout layout_;
  uint32_t film_pixels_;
  RoundOfPaths round_;
  KbRound record_{};
  opencl::SceneArguments::Of<ProbeBuffer> scene_;
  opencl::SpectraArguments::Of<ProbeBuffer> spectra_;
  opencl::PoolArguments::Of<ProbeBuffer> pool_;
  opencl::EvaluationArguments::Of<ProbeBuffer> evaluation_{};
  opencl::FilmArguments::Of<ProbeBuffer> film_{};
  opencl::QueueArguments::Of<ProbeBuffer> queue_{};
};

}  // namespace kiloband::test
