// One thread's work: the samples of a replicate in one block, traced, evaluated and averaged.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "film/spectral_film.hpp"
#include "src_cpu/evaluate/evaluator.hpp"
#include "src_cpu/path/path_tracer.hpp"

namespace kiloband::cpu {

/// What is told while a block is rendered.
struct SampleEvents {
  std::function<void(uint64_t)> on_sample;  // after each sample of all pixels, with their number
  std::function<void(const InvalidSample&)> on_invalid;
};

class BlockWorker {
 public:
  BlockWorker(const TracerScene& scene, const DerivedChannels& derived, const SamplingSettings& settings,
              Isa isa);

  /// Renders range.count samples (fewer if stop becomes true) of every pixel of the block; the result stays
  /// valid until the next call.
  BlockSamples render(const PixelRect& block, uint32_t block_index, const SampleRange& range,
                      const std::atomic<bool>& stop, const SampleEvents& events);
  /// The same for a film that keeps sums: adds to those of the block, of which it has range.first samples.
  /// After an exception the block's sums are of no use.
  void go_on(SpectralFilm& film, uint32_t block_index, const SampleRange& range,
             const std::atomic<bool>& stop, const SampleEvents& events);

  /// Float sums of 64 samples, folded into doubles.
  static SumRule sum_rule();

  /// Traces one sample of every pixel of the block, without evaluating it.
  std::vector<TracedPath> trace(const PixelRect& block, const SampleId& id);

  PathTracer& tracer() { return tracer_; }
  const Evaluator& evaluator() const { return evaluator_; }

 private:
  uint32_t add_samples(const PixelRect& block, const SampleRange& range, const std::atomic<bool>& stop,
                       const SampleEvents& events, const std::function<void()>& fold_all);
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
  std::vector<float> sums_;     // [pixel][stride], at most kFoldInterval samples: open sums
  std::vector<double> folded_;  // the samples before those, closed sums; empty until needed
  std::vector<float*> rows_;    // what samples are added to: rows of sums_ or of the film
  bool packed_ = false;         // SumRows
  std::vector<float> factors_;  // [pixel]: means are these times the sums
  std::vector<uint32_t> counts_, invalid_;
};

}  // namespace kiloband::cpu
