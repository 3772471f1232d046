// Paths one by one, for `kiloband trace` and parity tests.
#include <stdexcept>

#include "src_gpu/device_state.hpp"
#include "src_gpu/group_renderer.hpp"

namespace kiloband::opencl {
namespace {

/// Appends what the live slots' rays have found to their jobs.
class HitObserver {
 public:
  HitObserver(const PathPool& pool, const Bvh& bvh, std::vector<TracedPath>& traced)
      : pool_(pool), bvh_(bvh), traced_(traced) {}

  void operator()(const LaunchQueue& queue) const {
    const std::vector<KbPathState> states = pool_.buffers().states.download();
    const std::vector<KbHit> hits = pool_.buffers().hits.download();
    const std::vector<uint32_t> instances = pool_.buffers().hit_instances.download();
    std::vector<uint32_t> slots(queue.slots.length.buffer().read(0));
    queue.slots.slots.buffer().download(std::span<uint32_t>(slots));
    for (const uint32_t slot : slots) {
      if (states[slot].flags & KB_PATH_LIVE)
        traced_.at(states[slot].job)
            .hits.push_back(to_hit(hits[slot], instances.empty() ? KB_NONE : instances[slot]));
    }
  }

 private:
  TracedHit to_hit(const KbHit& hit, uint32_t instance) const {
    if (hit.primitive == KB_NONE) return {};
    const KbPrimitive& primitive = bvh_.primitives.at(hit.primitive);
    return {instance == KB_NONE ? primitive.shape : instance + primitive.shape, primitive.primitive, hit.t,
            hit.u, hit.v};
  }

  const PathPool& pool_;
  const Bvh& bvh_;
  std::vector<TracedPath>& traced_;
};

}  // namespace

std::vector<KbPathVertex> DeviceState::saved_entries(const KbSavedPath& saved,
                                                     const std::vector<KbPathVertex>& arena,
                                                     const std::vector<uint32_t>& chunk_next) const {
  std::vector<KbPathVertex> entries;
  uint32_t chunk = saved.chunk;
  for (uint32_t i = 0; i < saved.count; ++i) {
    entries.push_back(arena.at(std::size_t{chunk} * KB_CHUNK_ENTRIES + i % KB_CHUNK_ENTRIES));
    if (i % KB_CHUNK_ENTRIES == KB_CHUNK_ENTRIES - 1 && i + 1 < saved.count) chunk = chunk_next.at(chunk);
  }
  return entries;
}

std::vector<TracedPath> DeviceState::trace(const KbRound& round, std::span<const KbRoundPixel> pixels,
                                           std::span<const float> mu, bool hits) {
  if (method == Method::kPt) throw std::logic_error("trace: the method pt does not keep vertices");
  std::vector<TracedPath> traced(std::size_t{round.samples} * round.padded_pixels);
  if (hits) pool_->observe_hits(HitObserver(*pool_, host_.bvh, traced));
  pool_->begin(round, pixels, mu);
  const RoundOutcome outcome = pool_->run(round);
  pool_->observe_hits({});
  if (outcome.arena_full) throw DeviceOutOfMemory("trace: the vertices of these paths do not fit the arena");
  const std::vector<KbSavedPath> saved = pool_->buffers().saved.download();
  const std::vector<KbPathVertex> arena = pool_->buffers().arena.download();
  const std::vector<uint32_t> chunk_next = pool_->buffers().chunk_next.download();
  for (std::size_t job = 0; job < traced.size(); ++job) {
    traced[job].invalid = saved[job].count == KB_SAVED_INVALID;
    if (!traced[job].invalid) traced[job].entries = saved_entries(saved[job], arena, chunk_next);
    normalise(traced[job]);
  }
  return traced;
}

std::vector<TracedPath> GroupRenderer::trace(std::span<const ImagePixel> pixels, const SampleRange& range,
                                             bool hits) {
  prepare(pixels.size());
  KbRound round = make_round(range, pixels.size());
  fill_pixels(pixels, round);
  fill_mu(round);
  return device_.trace(round, round_pixels_, mu_, hits);
}

}  // namespace kiloband::opencl
