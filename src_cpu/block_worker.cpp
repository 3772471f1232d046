#include "src_cpu/block_worker.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "shared/sampler.h"
#include "src_cpu/path/denormals.hpp"

namespace kiloband::cpu {
namespace {

// Float sums take at most this many samples before they go to double: their rounding error stays below
// 64 * 2^-24 = 4e-6 in the worst case (all samples equal) and 5e-7 typically, however many samples follow.
constexpr uint32_t kFoldInterval = 64;

/// Whether the float sums go to double before a sample.
bool folds_before(uint32_t index) {
  return index > 0 && index % kFoldInterval == 0;
}

/// What is open becomes a part of what is closed.
void fold(const PixelSums& sums) {
  for (std::size_t c = 0; c < sums.open.size(); ++c)
    sums.closed[c] = std::bit_cast<ClosedSum>(std::bit_cast<double>(sums.closed[c]) + sums.open[c]);
  std::ranges::fill(sums.open, 0.0f);
}

}  // namespace

BlockWorker::BlockWorker(const TracerScene& scene, const DerivedChannels& derived,
                         const SamplingSettings& settings, Isa isa)
    : scene_(scene),
      settings_(settings),
      derived_count_(derived.names.size()),
      tracer_(scene, settings, path_kernels(isa)),
      evaluator_(*scene.flat, derived, isa) {}

SumRule BlockWorker::sum_rule() {
  return {SumRule::Kind::kFolded, kFoldInterval, kFoldInterval, 1};
}

BlockSamples BlockWorker::render(const PixelRect& block, uint32_t block_index, const SampleRange& range,
                                 const std::atomic<bool>& stop, const SampleEvents& events) {
  sums_.assign(block.pixels() * evaluator_.stride(), 0.0f);
  folded_.clear();
  counts_.assign(block.pixels(), 0);
  rows_.clear();
  for (std::size_t p = 0; p < block.pixels(); ++p) rows_.push_back(&sums_[p * evaluator_.stride()]);
  packed_ = false;
  add_samples(block, range, stop, events, [this] { fold_sums(); });
  finish_means(block.pixels());
  return {block_index, range.replicate, counts_, sums_, evaluator_.stride(), factors_};
}

/// Samples are added to the film in place: copying its sums into padded rows and back takes 3 % of a render of replicates of 8
/// samples with 512 channels, 8 % with 256, and no K from 8 to 1024 is faster with copies.
void BlockWorker::go_on(SpectralFilm& film, uint32_t block_index, const SampleRange& range,
                        const std::atomic<bool>& stop, const SampleEvents& events) {
  const PixelRect& block = film.blocks()[block_index];
  film.open_replicate(range.replicate, block_index);
  if (film.attempted(range.replicate, block_index) != range.first)
    throw std::logic_error("BlockWorker: the samples do not follow those that the film has");
  const std::size_t channels = film.options().channels;
  rows_.clear();
  counts_.clear();
  packed_ = true;
  const auto sums_of_row = [&](uint32_t y) {
    return film.open_sums(range.replicate, film.pixel_index(block, std::size_t{y} * block.width),
                          block.width);
  };
  for (uint32_t y = 0; y < block.height; ++y) {
    const OpenSums sums = sums_of_row(y);
    for (uint32_t x = 0; x < block.width; ++x) rows_.push_back(&sums.values[x * channels]);
    counts_.insert(counts_.end(), sums.counts.begin(), sums.counts.end());
  }
  const uint32_t done = add_samples(block, range, stop, events, [&] {
    for (std::size_t p = 0; p < block.pixels(); ++p)
      fold(film.pixel_sums(range.replicate, film.pixel_index(block, p)));
  });
  for (uint32_t y = 0; y < block.height; ++y)
    std::copy_n(&counts_[std::size_t{y} * block.width], block.width, sums_of_row(y).counts.begin());
  film.set_attempted(range.replicate, block_index, range.first + done);
}

/// Adds the range's samples to the sums. Returns how many.
uint32_t BlockWorker::add_samples(const PixelRect& block, const SampleRange& range,
                                  const std::atomic<bool>& stop, const SampleEvents& events,
                                  const std::function<void()>& fold_all) {
  const DenormalsToZero mode;
  uint32_t done = 0;
  for (; done < range.count && !stop; ++done) {
    const uint32_t index = range.first + done;
    const SampleId id{range.replicate + index * settings_.replicates, range.replicate, index};
    if (folds_before(index)) fold_all();
    add_sample(block, id);
    for (uint32_t& count : counts_) ++count;
    for (const uint32_t pixel : invalid_) {
      --counts_[pixel];
      events.on_invalid({block.x0 + pixel % block.width, block.y0 + pixel / block.width, id.sample});
    }
    events.on_sample(block.pixels());
  }
  return done;
}

/// The wavelength offsets of the block's paths: one (shared), or one per pixel.
void BlockWorker::set_mu(const PixelRect& block, const SampleId& id) {
  if (settings_.wavelengths == WavelengthMode::kShared) {
    mu_.assign(1, kb_shared_mu(settings_.seed, id.replicate, block.x0 / kBlockSize, block.y0 / kBlockSize,
                               id.index));
    return;
  }
  const uint32_t sampler =
      settings_.sampler == SamplerType::kSobol ? KB_SAMPLER_SOBOL : KB_SAMPLER_INDEPENDENT;
  mu_.resize(block.pixels());
  for (uint32_t i = 0; i < mu_.size(); ++i) {
    const uint32_t key =
        (block.y0 + i / block.width) * scene_.flat->camera.film_width + block.x0 + i % block.width;
    mu_[i] = kb_path_mu(sampler, settings_.seed, key, id.sample, id.replicate, id.index);
  }
}

void BlockWorker::add_sample(const PixelRect& block, const SampleId& id) {
  set_mu(block, id);
  tracer_.trace(block, id, mu_, paths_, invalid_);
  if (settings_.wavelengths == WavelengthMode::kShared) {
    evaluator_.add_shared(paths_, mu_.front(), {rows_, packed_});
    return;
  }
  path_mu_.clear();
  for (const SavedPath& path : paths_.paths) path_mu_.push_back(mu_[path.pixel]);
  evaluator_.add_per_path(paths_, path_mu_, {rows_, packed_});
}

std::vector<TracedPath> BlockWorker::trace(const PixelRect& block, const SampleId& id) {
  Recording recording;
  tracer_.record_into(&recording);
  set_mu(block, id);
  tracer_.trace(block, id, mu_, paths_, invalid_);
  tracer_.record_into(nullptr);
  std::vector<TracedPath> traced(block.pixels());
  for (std::size_t i = 0; i < recording.answers.size(); ++i) {
    const TraceRay& ray = recording.answers[i];
    const bool hit = ray.shape != KB_NONE;
    traced[recording.closest_path[i]].hits.push_back(
        hit ? TracedHit{ray.shape, ray.primitive, ray.t_max, ray.u, ray.v} : TracedHit{});
  }
  for (const SavedPath& path : paths_.paths) {
    const auto first = paths_.entries.begin() + path.first;
    traced[path.pixel].entries.assign(first, first + path.count);
  }
  for (const uint32_t pixel : invalid_) traced[pixel].invalid = true;
  for (TracedPath& path : traced) normalise(path);
  return traced;
}

void BlockWorker::fold_sums() {
  folded_.resize(sums_.size());
  for (std::size_t i = 0; i < sums_.size(); ++i) folded_[i] += sums_[i];
  std::ranges::fill(sums_, 0.0f);
}

/// What makes means of sums; derived channels move to the place behind the channels, where the film has them.
void BlockWorker::finish_means(std::size_t pixels) {
  const std::size_t stride = evaluator_.stride();
  const std::size_t channels = scene_.flat->channels.size();
  factors_.assign(pixels, 1.0f);
  for (std::size_t p = 0; p < pixels; ++p) {
    const double scale = counts_[p] > 0 ? 1.0 / counts_[p] : 0.0;
    float* sums = &sums_[p * stride];
    if (folded_.empty()) {
      factors_[p] = static_cast<float>(scale);
    } else {
      const double* folded = &folded_[p * stride];
      for (std::size_t k = 0; k < stride; ++k) sums[k] = static_cast<float>((folded[k] + sums[k]) * scale);
    }
    std::copy_n(sums + evaluator_.derived_offset(), derived_count_, sums + channels);
  }
}

}  // namespace kiloband::cpu
