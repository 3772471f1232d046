// One thread's work: the samples of a replicate in one block, traced, evaluated and averaged.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "film/spectral_film.hpp"
#include "src_cpu/evaluator.hpp"
#include "src_cpu/path_tracer.hpp"

namespace kiloband {

class BlockWorker {
 public:
  BlockWorker(const TracerScene& scene, const DerivedChannels& derived, const SamplingSettings& settings,
              Isa isa);

  /// Renders range.count samples (fewer if stop becomes true) of every pixel of the block; the result stays
  /// valid until the next call. on_sample is called after each sample with the number of pixels; on_invalid
  /// for every invalid sample.
  BlockSamples render(const PixelRect& block, uint32_t block_index, const SampleRange& range,
                      const std::atomic<bool>& stop, const std::function<void(uint64_t)>& on_sample,
                      const std::function<void(const InvalidSample&)>& on_invalid);

  /// Traces one sample of every pixel of the block, without evaluating it.
  std::vector<TracedPath> trace(const PixelRect& block, const SampleId& id);

  PathTracer& tracer() { return tracer_; }
  const Evaluator& evaluator() const { return evaluator_; }

 private:
  void set_mu(const PixelRect& block, const SampleId& id);
  void add_sample(const PixelRect& block, const SampleId& id);
  void fold_sums();
  void finish_means(std::size_t pixels);

  const TracerScene& scene_;
  SamplingSettings settings_;
  std::size_t derived_count_;
  PathTracer tracer_;
  Evaluator evaluator_;
  PathBuffer paths_;
  std::vector<float> mu_, path_mu_;
  std::vector<float> sums_;     // [pixel][stride], at most kFoldInterval samples
  std::vector<double> folded_;  // the samples before those; empty until needed
  std::vector<uint32_t> counts_, invalid_;
};

}  // namespace kiloband
