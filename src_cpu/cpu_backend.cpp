#include "src_cpu/cpu_backend.hpp"

#include <omp.h>

#include <algorithm>
#include <exception>
#include <fstream>
#include <mutex>
#include <optional>

#include "base/threads.hpp"
#include "src_cpu/block_worker.hpp"
#include "src_cpu/geometry/boundary.hpp"
#include "src_cpu/path/camera.hpp"
#include "src_cpu/path/denormals.hpp"

namespace kiloband::cpu {
namespace {

constexpr std::size_t kReportedInvalid = 16;

/// OpenMP starts all threads but the caller's, and so does TBB, which Embree builds with, and one per processor
/// when Embree lets go of its limit. Both end the process where they cannot.
void check_threads(int threads) {
  const int others = threads - 1, of_tbb = std::max({1, others, omp_get_num_procs() - 1});
  require_threads(static_cast<unsigned>(others + of_tbb), "the CPU backend", "give fewer --threads");
}

class CpuBackend final : public Backend {
 public:
  CpuBackend(std::shared_ptr<const FlatScene> scene, const DerivedChannels& derived,
             const SamplingSettings& settings, const Options& options)
      : kept_(std::move(scene)),
        scene_(*kept_),
        derived_(derived),
        settings_(settings),
        isa_(resolve_isa(options.isa)),
        threads_(options.threads > 0 ? options.threads : omp_get_num_procs()) {
    check_threads(threads_);
    embree_ = std::make_unique<EmbreeScene>(scene_, isa_, threads_);
    tables_.emplace(scene_);
    tracer_scene_ = tracer_scene(scene_, *embree_, *tables_);
    for (int i = 0; i < threads_; ++i) {
      workers_.push_back(std::make_unique<BlockWorker>(tracer_scene_, derived_, settings_, isa_));
    }
  }

  void render(SpectralFilm& film, const SampleRange& range, const std::vector<uint32_t>& blocks,
              const std::atomic<bool>& stop, const std::function<void(uint64_t)>& progress) override;
  std::vector<AuxiliaryPixel> auxiliary(const PixelRect& rect) override;

  std::vector<TracedPath> trace(const PixelRect& rect, const SampleRange& range) override {
    const DenormalsToZero mode;
    const SampleId id{range.replicate + range.first * settings_.replicates, range.replicate, range.first};
    std::vector<TracedPath> paths(rect.pixels());
    for (const PixelRect& block : cut_into_blocks(rect)) {
      std::vector<TracedPath> traced = workers_.front()->trace(block, id);
      for (uint32_t i = 0; i < block.pixels(); ++i) {
        const uint32_t x = block.x0 + i % block.width - rect.x0, y = block.y0 + i / block.width - rect.y0;
        paths[std::size_t{y} * rect.width + x] = std::move(traced[i]);
      }
    }
    return paths;
  }

  void camera_moved() override {}  // the scene's is looked at for every block

  BackendInfo info() const override { return {"cpu", processor_name(), to_string(isa_)}; }
  BackendStatistics statistics() const override;
  std::vector<double> film_scale() const override;
  SumRule sum_rule() const override { return BlockWorker::sum_rule(); }
  uint32_t blocks_at_once(uint32_t) const override { return static_cast<uint32_t>(threads_); }

 private:
  void note_invalid(const InvalidSample& sample);
  float pass_boundaries(TraceRay& ray, float far) const;
  AuxiliaryPixel auxiliary_pixel(TraceRay ray, float far) const;

  std::shared_ptr<const FlatScene> kept_;
  const FlatScene& scene_;
  DerivedChannels derived_;
  SamplingSettings settings_;
  Isa isa_;
  int threads_;
  std::optional<TracerTables> tables_;
  TracerScene tracer_scene_;
  std::unique_ptr<EmbreeScene> embree_;
  std::vector<std::unique_ptr<BlockWorker>> workers_;
  std::atomic<uint64_t> paths_{0}, vertices_{0}, rays_{0}, invalid_samples_{0};
  mutable std::mutex mutex_;
  std::vector<InvalidSample> invalid_;
};

void CpuBackend::note_invalid(const InvalidSample& sample) {
  ++invalid_samples_;
  const std::lock_guard lock(mutex_);
  if (invalid_.size() < kReportedInvalid) invalid_.push_back(sample);
}

void CpuBackend::render(SpectralFilm& film, const SampleRange& range, const std::vector<uint32_t>& blocks,
                        const std::atomic<bool>& stop, const std::function<void(uint64_t)>& progress) {
  std::exception_ptr failure;
  std::atomic<bool> failed{false};
  const auto on_sample = [&](uint64_t pixels) {
    paths_ += pixels;
    if (!progress) return;
    const std::lock_guard lock(mutex_);
    progress(pixels);
  };
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads_)
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (stop || failed) continue;
    try {
      BlockWorker& worker = *workers_[static_cast<std::size_t>(omp_get_thread_num())];
      const uint64_t rays = worker.tracer().rays();
      const uint64_t vertices = worker.tracer().vertices();
      const SampleEvents events{on_sample, [this](const InvalidSample& sample) { note_invalid(sample); }};
      if (film.keeps_sums()) {
        worker.go_on(film, blocks[i], range, stop, events);
      } else {
        film.add(worker.render(film.blocks()[blocks[i]], blocks[i], range, stop, events));
      }
      rays_ += worker.tracer().rays() - rays;
      vertices_ += worker.tracer().vertices() - vertices;
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failed.exchange(true)) failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
}

/// A ray that has hit a null boundary goes on to the first surface that is none. Returns the distance passed.
float CpuBackend::pass_boundaries(TraceRay& ray, float far) const {
  float passed = 0;
  while (is_boundary(scene_, ray.shape)) {
    passed += ray.t_max;
    ray = TraceRay(leave_surface(surface_of(scene_, ray), ray.direction()), ray.direction(), 0, far - passed);
    embree_->closest_hits(std::span(&ray, 1));
  }
  return passed;
}

/// What a camera ray with that answer has met. far: where the ray ends
AuxiliaryPixel CpuBackend::auxiliary_pixel(TraceRay ray, float far) const {
  const float in_front = pass_boundaries(ray, far);
  if (ray.shape == KB_NONE) return {};
  const SurfaceHit hit = surface_of(scene_, ray);
  const KbSurface& surface = scene_.surfaces[scene_.shapes[hit.shape].surface];
  const bool behind = glm::dot(hit.shading_normal, ray.direction()) > 0 && surface.back != KB_NONE;
  const glm::vec3 n = hit.shading_normal;
  return {in_front + ray.t_max,
          {n.x, n.y, n.z},
          static_cast<float>(hit.shape),
          static_cast<float>(behind ? surface.back : surface.front)};
}

std::vector<AuxiliaryPixel> CpuBackend::auxiliary(const PixelRect& rect) {
  std::vector<AuxiliaryPixel> pixels;
  const auto rays = std::make_unique<RayQueue>();
  std::vector<float> far(kWavePaths);
  while (pixels.size() < rect.pixels()) {
    const auto first = static_cast<uint32_t>(pixels.size());
    rays->count = static_cast<uint32_t>(std::min<std::size_t>(kWavePaths, rect.pixels() - first));
    for (uint32_t i = 0; i < rays->count; ++i) {
      const uint32_t x = (first + i) % rect.width, y = (first + i) / rect.width;
      const CameraRay ray = centre_camera_ray(scene_.camera, rect.x0 + x, rect.y0 + y);
      put_ray({ray.origin, ray.direction, ray.t_min, ray.t_max}, *rays, i);
      far[i] = ray.t_max;
    }
    embree_->closest_hits(*rays, RayPackets::kCoherent);
    for (uint32_t i = 0; i < rays->count; ++i) pixels.push_back(auxiliary_pixel(ray_of(*rays, i), far[i]));
  }
  return pixels;
}

BackendStatistics CpuBackend::statistics() const {
  BackendStatistics done;
  done.paths = paths_;
  done.vertices = vertices_;
  done.rays = rays_;
  done.invalid_samples = invalid_samples_;
  const std::lock_guard lock(mutex_);
  done.first_invalid = invalid_;
  return done;
}

std::vector<double> CpuBackend::film_scale() const {
  std::vector<double> scale = scene_.channel_scale;
  for (std::size_t d = 0; d < derived_.names.size(); ++d)
    scale.push_back(workers_.front()->evaluator().derived_scale(d));
  for (double& s : scale) s *= scene_.filter_scale;
  return scale;
}

}  // namespace

std::string processor_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown processor";
}

std::unique_ptr<Backend> make_backend(std::shared_ptr<const FlatScene> scene, const DerivedChannels& derived,
                                      const SamplingSettings& settings, const Options& options) {
  return std::make_unique<CpuBackend>(std::move(scene), derived, settings, options);
}

BackendEntry backend_entry() {
  return {"cpu", {}, [](const BackendInput& input, const BackendRequest& request, const auto&) {
            const std::optional<Isa> isa = find_isa(request.isa);
            if (!isa) throw InputError("no instruction set '" + request.isa + "'");
            const int left = std::max(1, omp_get_num_procs() - request.reserved_threads);
            const int threads = request.threads == 0 && request.reserved_threads > 0 ? left : request.threads;
            std::vector<std::unique_ptr<Backend>> one;
            one.push_back(make_backend(input.scene, input.derived, input.sampling, {*isa, threads}));
            return one;
          }};
}

}  // namespace kiloband::cpu
