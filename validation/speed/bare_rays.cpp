#include "validation/speed/bare_rays.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "src_cpu/path/denormals.hpp"
#include "src_cpu/path/path_tracer.hpp"

namespace kiloband::speed {

using namespace cpu;
namespace {

/// The rays of one sample of every block.
/// use(recording): called for each
template <class Use>
void record_rays(const BareScene& scene, const Use& use) {
  SamplingSettings settings;
  settings.sampler = SamplerType::kIndependent;
  settings.replicates = 1;
  PathTracer tracer(scene.tracer, settings, path_kernels(resolve_isa(Isa::kAuto)));
  PathBuffer paths;
  std::vector<uint32_t> invalid;
  const float mu[1] = {0.5f};
  for (const PixelRect& block : scene.blocks) {
    Recording recording;
    tracer.record_into(&recording);
    tracer.trace(block, {0, 0, 0}, mu, paths, invalid);
    use(recording);
  }
}

}  // namespace

BareScene::BareScene(std::shared_ptr<const FlatScene> scene) : compiled(std::move(scene)), tables(*compiled) {
  const FlatScene& flat = *compiled;
  embree = std::make_unique<EmbreeScene>(flat, Isa::kAuto, 1);
  tracer = tracer_scene(flat, *embree, tables);
  blocks = cut_into_blocks({0, 0, flat.film.crop_width, flat.film.crop_height});
}

BareSingles::BareSingles(const BareScene& scene) : scene_(scene) {
  record_rays(scene, [&](const Recording& recording) { append(recording); });
}

void BareSingles::append(const Recording& recording) {
  std::vector<std::pair<uint32_t, uint32_t>> keyed;  // (path, order code)
  const auto closest_base = static_cast<uint32_t>(closest_.size());
  const auto shadow_base = static_cast<uint32_t>(shadow_.size());
  closest_.insert(closest_.end(), recording.closest.begin(), recording.closest.end());
  shadow_.insert(shadow_.end(), recording.shadow.begin(), recording.shadow.end());
  for (uint32_t i = 0; i < recording.closest.size(); ++i)
    keyed.push_back({recording.closest_path[i], (closest_base + i) << 1});
  for (uint32_t i = 0; i < recording.shadow.size(); ++i)
    keyed.push_back({recording.shadow_path[i], (shadow_base + i) << 1 | 1});
  std::ranges::stable_sort(keyed, {}, &std::pair<uint32_t, uint32_t>::first);
  for (const auto& [path, code] : keyed) order_.push_back(code);
}

std::size_t BareSingles::query() const {
  const DenormalsToZero mode;  // as paths are traced
  std::size_t hits = 0;
  for (const uint32_t code : order_) {
    if (code & 1) {
      ShadowRay ray = shadow_[code >> 1];
      scene_.embree->occlusions({&ray, 1});
      hits += ray.occluded();
    } else {
      TraceRay ray = closest_[code >> 1];
      scene_.embree->closest_hits({&ray, 1});
      hits += ray.shape != KB_NONE;
    }
  }
  return hits;
}

/// The rays that a wave traced at once, in the order of their paths, or sorted; those behind null boundaries, which paths trace alone, in
/// packets, too.
struct BarePackets::Queue {
  std::vector<float> columns[8];  // of the queue that traces them
  bool shadow = false, camera = false;

  /// first .. end of `rays`, whose paths are `path`.
  template <class Ray>
  Queue(const std::vector<Ray>& rays, const std::vector<uint32_t>& path, std::size_t first, std::size_t end,
        const RayGrid* grid)
      : shadow(std::is_same_v<Ray, ShadowRay>), camera(!shadow && first == 0) {
    std::vector<std::size_t> order(end - first);
    std::iota(order.begin(), order.end(), first);
    std::ranges::sort(order, {}, [&](std::size_t i) { return path[i]; });
    const auto queue = std::make_unique<RayQueue>(), sorted = std::make_unique<RayQueue>();
    for (const std::size_t i : order) {
      const Ray& ray = rays[i];
      const uint32_t n = queue->count++;
      queue->ox[n] = ray.ox, queue->oy[n] = ray.oy, queue->oz[n] = ray.oz, queue->t_min[n] = ray.t_min;
      queue->dx[n] = ray.dx, queue->dy[n] = ray.dy, queue->dz[n] = ray.dz, queue->t_max[n] = ray.t_max;
    }
    const bool sorts = grid && !camera;
    if (sorts) sort_rays(*queue, *grid, *sorted);
    const RayQueue& from = sorts ? *sorted : *queue;
    const float* arrays[8] = {from.ox, from.oy, from.oz, from.dx, from.dy, from.dz, from.t_max, from.t_min};
    for (int c = 0; c < 8; ++c) columns[c].assign(arrays[c], arrays[c] + from.count);
  }

  template <class Target>
  void load(Target& queue) const {
    queue.count = static_cast<uint32_t>(columns[0].size());
    float* arrays[7] = {queue.ox, queue.oy, queue.oz, queue.dx, queue.dy, queue.dz, queue.t_max};
    for (int c = 0; c < 7; ++c) std::ranges::copy(columns[c], arrays[c]);
    if constexpr (requires { queue.t_min; }) std::ranges::copy(columns[7], queue.t_min);
  }
};

template <class Ray>
void BarePackets::append(const std::vector<Ray>& rays, const std::vector<uint32_t>& path,
                         const std::vector<std::size_t>& ends) {
  const RayGrid* grid = way_ == BareWay::kSorted ? &scene_.embree->grid() : nullptr;
  std::size_t first = 0;
  for (const std::size_t end : ends) {
    while (first < end) {
      const std::size_t last = std::min<std::size_t>(end, first + kWavePaths);
      queues_.emplace_back(rays, path, first, last, grid);
      first = last;
    }
  }
}

BareWay way_of_paths(const BareScene& scene) {
  if (scene.tables.few) return BareWay::kFew;
  return scene.embree->sorting_pays() ? BareWay::kSorted : BareWay::kPackets;
}

BarePackets::BarePackets(const BareScene& scene, BareWay way)
    : scene_(scene),
      way_(way),
      kernels_(path_kernels(resolve_isa(Isa::kAuto))),
      rays_(std::make_unique<RayQueue>()),
      shadows_(std::make_unique<ShadowQueue>()) {
  if (way == BareWay::kFew && !scene.tables.few) throw std::logic_error("BarePackets: too many triangles");
  record_rays(scene, [&](const Recording& r) {
    append(r.closest, r.closest_path, r.closest_ends);
    append(r.shadow, r.shadow_path, r.shadow_ends);
  });
}

BarePackets::~BarePackets() = default;

void BarePackets::trace(const Queue& queue) const {
  const bool coherent = way_ == BareWay::kSorted || queue.camera;
  const RayPackets packets = coherent ? RayPackets::kCoherent : RayPackets::kIncoherent;
  if (queue.shadow)
    scene_.embree->occlusions(*shadows_, packets);
  else
    scene_.embree->closest_hits(*rays_, packets);
}

void BarePackets::try_all(const Queue& queue) const {
  if (queue.shadow)
    kernels_.occlusions_of_few(*scene_.tables.few, *shadows_);
  else
    kernels_.closest_of_few(*scene_.tables.few, *rays_);
}

void BarePackets::query() const {
  const DenormalsToZero mode;  // as paths are traced
  for (const Queue& queue : queues_) {
    if (queue.shadow)
      queue.load(*shadows_);
    else
      queue.load(*rays_);
    way_ == BareWay::kFew ? try_all(queue) : trace(queue);
  }
}

}  // namespace kiloband::speed
