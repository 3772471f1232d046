// Gas along the rays of a path: null boundaries are passed, and every segment in a gas becomes a vertex of
// kind KB_KIND_MEDIUM (shared/records.h).
//
// Estimator. Gas only absorbs and emits, so with optical depth x from the segment's begin the
// radiance there is
//
//   L = L_end exp(-x_end) + int_0^x_end B(T) exp(-x) dx,
//
// evaluated afterwards from columns and temperatures without any sampling: transmittances neither enter
// densities nor roulette (they are at most 1, so the bound of the throughput stays a bound). Light samples
// are multiplied by the transmittance of the shadow ray. A ray that leaves the scene is not attenuated by the
// atmosphere: what the environment shows is as seen in the scene; what interiors emit on the way is
// attenuated by the atmosphere in front of them.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "shared/plume.h"
#include "src_cpu/geometry/boundary.hpp"
#include "src_cpu/path/path_tracer.hpp"
#include "src_cpu/path/path_tracer_detail.hpp"

namespace kiloband::cpu {
namespace {

KbFloat3 to_record(glm::vec3 v) {
  return {v.x, v.y, v.z};
}

bool has_gas(const FlatScene& scene, uint32_t medium) {
  return medium != KB_NONE && scene.media[medium].type != KB_MEDIUM_EMPTY;
}

bool is_plume(const KbMedium& medium) {
  return medium.type == KB_MEDIUM_GRID || medium.type == KB_MEDIUM_JET;
}

KbPathVertex medium_vertex(const KbMedium& medium, uint32_t flags) {
  KbPathVertex vertex{};
  vertex.head = KB_KIND_MEDIUM | flags;
  vertex.row_a = static_cast<uint16_t>(medium.row);
  return vertex;
}

/// The part of a ray in one medium, with a direction of length 1.
struct Straight {
  KbFloat3 origin, direction;
  float begin, end;  // m
};

Straight straight(glm::vec3 origin, glm::vec3 direction, float t_min, float t_max) {
  const float length = glm::length(direction);
  return {to_record(origin), to_record(direction / length), t_min * length, t_max * length};
}

float column_of(const FlatScene& scene, const KbMedium& medium, const Straight& s) {
  if (!is_plume(medium)) return medium.scale * (s.end - s.begin);
  KbPlumeWalk walk;
  const KbFloat2* nodes = scene.plume_nodes.data();
  if (!kb_plume_begin(&walk, &medium, nodes, s.origin, s.direction, s.begin, s.end)) return 0;
  return kb_plume_column(&walk, &medium, nodes);
}

}  // namespace

/// The path goes through a shape's surface. outwards: to the side of its normal.
void PathTracer::cross(Path& path, MediumStack& media, uint32_t shape, bool outwards) {
  const uint32_t medium = flat_.interiors[shape];
  if (medium == KB_NONE) return;
  if (outwards)
    media.leave(medium);
  else if (!media.enter(medium))
    path.invalid = true;
}

/// The media on the side of a surface that `direction` goes to, for a path that arrived along `from`.
MediumStack PathTracer::media_towards(Path& path, const SurfaceHit& hit, glm::vec3 from,
                                      glm::vec3 direction) {
  MediumStack media = gas_of(path).media;
  const bool from_front = glm::dot(hit.geometric_normal, from) < 0;
  const bool to_front = glm::dot(hit.geometric_normal, direction) >= 0;
  if (from_front != to_front) cross(path, media, hit.shape, to_front);
  return media;
}

/// Follows every ray of the queue to the first surface that is one, and notes its segments.
void PathTracer::walk_boundaries() {
  segments_.clear();
  for (std::size_t i = 0; i < active_.size(); ++i) {
    GasPath& gas = gas_[active_[i]];
    Path& path = paths_[active_[i]];
    TraceRay& ray = rays_queue_[i];
    gas.first_segment = static_cast<uint32_t>(segments_.size());
    while (ray.shape != KB_NONE) {
      segments_.push_back(
          {gas.media.current(flat_.atmosphere), ray.origin(), ray.direction(), gas.begin, ray.t_max});
      if (!is_boundary(flat_, ray.shape)) break;
      pass_boundary(path, gas, ray);
    }
    gas.segments = static_cast<uint32_t>(segments_.size()) - gas.first_segment;
    gas.far = kInfiniteDistance;
  }
}

void PathTracer::pass_boundary(Path& path, GasPath& gas, TraceRay& ray) {
  const glm::vec3 direction = ray.direction();
  const SurfaceHit hit = surface_of(flat_, ray);
  cross(path, gas.media, hit.shape, glm::dot(hit.geometric_normal, direction) >= 0);
  gas.far -= ray.t_max;
  ray = TraceRay(leave_surface(hit, direction), direction, 0, gas.far);
  gas.begin = begin_at(hit, ray.origin(), direction);
  if (++gas.crossings >= KB_MAX_VERTICES) {
    path.invalid = true;
    return;  // as if it left the scene
  }
  if (recording_) {
    recording_->closest.push_back(ray);
    recording_->closest_path.push_back(path.pixel);
  }
  ++rays_;
  scene_.embree->closest_hits(std::span(&ray, 1), false);
  if (recording_) recording_->answers.push_back(ray);
}

/// The gas between where the path was and where it is now, or on its way out of the scene.
void PathTracer::append_gas(Path& path, bool escapes) {
  const GasPath& gas = gas_of(path);
  float in_front = 0;  // atmosphere that a ray out of the scene has passed, m
  for (uint32_t i = gas.first_segment; i < gas.first_segment + gas.segments; ++i) {
    const Segment& segment = segments_[i];
    if (!has_gas(flat_, segment.medium)) continue;
    const KbMedium& medium = flat_.media[segment.medium];
    if (escapes && segment.medium == flat_.atmosphere) {
      in_front +=
          column_of(flat_, medium, straight(segment.origin, segment.direction, segment.t_min, segment.t_max));
      continue;
    }
    if (in_front > 0 && medium.emit_row != KB_NONE) {
      KbPathVertex aside = medium_vertex(flat_.media[flat_.atmosphere], KB_VERTEX_DEFER);
      aside.scatter0 = in_front;
      append_medium(path, aside, {});
    }
    append_segment(path, medium, segment);
  }
}

void PathTracer::append_segment(Path& path, const KbMedium& medium, const Segment& segment) {
  const Straight s = straight(segment.origin, segment.direction, segment.t_min, segment.t_max);
  const bool emits = medium.emit_row != KB_NONE;
  KbPathVertex vertex = medium_vertex(medium, KB_VERTEX_SCATTER | (emits ? KB_VERTEX_EMIT : 0));
  vertex.emit_weight = 1;
  vertex.emit_row = static_cast<uint16_t>(emits ? medium.emit_row : 0);
  if (!is_plume(medium)) {
    vertex.scatter0 = column_of(flat_, medium, s);
    if (vertex.scatter0 != 0) append_medium(path, vertex, {});
    return;
  }
  KbPlumeWalk walk;
  KbPlumeCell cells[KB_PLUME_CELLS];
  const KbFloat2* nodes = flat_.plume_nodes.data();
  if (!kb_plume_begin(&walk, &medium, nodes, s.origin, s.direction, s.begin, s.end)) return;
  uint32_t count = 0;
  while (const uint32_t more = kb_plume_next(&walk, &medium, nodes, &cells[count])) count += more;
  if (count == 0) return;
  for (uint32_t i = 0; i < count; ++i) vertex.scatter0 += cells[i].column;
  vertex.head |= count << KB_VERTEX_MATERIAL_SHIFT;
  vertex.nee0 = walk.first_k;
  vertex.nee1 = medium.reference_k;
  append_medium(path, vertex, std::span(cells).first(count));
}

void PathTracer::append_medium(Path& path, const KbPathVertex& vertex, std::span<const KbPlumeCell> cells) {
  Draft draft;
  draft.vertex = vertex;
  append(path, draft);
  for (std::size_t i = 0; i < cells.size(); i += 4) {
    Entry extension{};
    extension.next = KB_NONE;
    const auto some = cells.subspan(i, std::min<std::size_t>(4, cells.size() - i));
    std::memcpy(static_cast<void*>(&extension.vertex), some.data(), some.size_bytes());
    entries_.push_back(extension);
  }
}

/// The path, which arrived along `from`, goes on with the ray that was queued last.
void PathTracer::follow_gas(Path& path, const SurfaceHit& hit, glm::vec3 from) {
  const TraceRay& ray = next_rays_.back();
  GasPath& gas = gas_of(path);
  gas.media = media_towards(path, hit, from, ray.direction());
  gas.begin = begin_at(hit, ray.origin(), ray.direction());
}

/// The same for the shadow ray that was queued last.
void PathTracer::note_shadow(Path& path, const SurfaceHit& hit, glm::vec3 from) {
  const ShadowRay& ray = shadow_rays_.back();
  const glm::vec3 origin{ray.ox, ray.oy, ray.oz}, direction{ray.dx, ray.dy, ray.dz};
  shadow_owner_.push_back({static_cast<uint32_t>(&path - paths_.data()), begin_at(hit, origin, direction),
                           media_towards(path, hit, from, direction)});
}

/// Light samples, each along its shadow ray through null boundaries.
void PathTracer::trace_shadows_through_gas() {
  for (std::size_t i = 0; i < shadow_rays_.size(); ++i) {
    Path& path = paths_[shadow_owner_[i].path];
    Columns columns;
    if (walk_shadow(path, shadow_owner_[i], shadow_rays_[i], columns))
      append_columns(path, shadow_entry_[i], columns);
    else
      entries_[shadow_entry_[i]].vertex.head &= ~KB_VERTEX_NEE;
  }
  shadow_owner_.clear();
}

/// Returns whether the light is visible; `columns` are then what lies in between.
bool PathTracer::walk_shadow(Path& path, ShadowOwner at, const ShadowRay& shadow, Columns& columns) {
  const glm::vec3 origin{shadow.ox, shadow.oy, shadow.oz}, direction{shadow.dx, shadow.dy, shadow.dz};
  const bool infinite = shadow.t_max == kInfiniteDistance;
  TraceRay ray(origin, direction, 0, shadow.t_max);
  for (uint32_t crossings = 0;; ++crossings) {
    ++rays_;
    scene_.embree->closest_hits(std::span(&ray, 1), false);
    const bool arrives = ray.shape == KB_NONE;
    if (!arrives && !is_boundary(flat_, ray.shape)) return false;
    const uint32_t medium = at.media.current(flat_.atmosphere);
    if (infinite ? !arrives && medium != flat_.atmosphere : true)
      add_column(path, columns, medium, ray, at.begin);
    if (arrives) return true;
    if (crossings >= KB_MAX_VERTICES) return path.invalid = true, false;
    const SurfaceHit hit = surface_of(flat_, ray);
    cross(path, at.media, hit.shape, glm::dot(hit.geometric_normal, direction) >= 0);
    const glm::vec3 from = leave_surface(hit, direction);
    ray = infinite ? TraceRay(from, direction, 0, kInfiniteDistance)
                   : TraceRay(from, origin + direction - from, 0, shadow.t_max);
    at.begin = begin_at(hit, from, ray.direction());
  }
}

void PathTracer::add_column(Path& path, Columns& columns, uint32_t medium, const TraceRay& ray, float begin) {
  if (!has_gas(flat_, medium)) return;
  const float column =
      column_of(flat_, flat_.media[medium], straight(ray.origin(), ray.direction(), begin, ray.t_max));
  if (column == 0) return;
  uint32_t i = 0;
  while (i < columns.count && columns.medium[i] != medium) ++i;
  if (i == KB_SHADOW_MEDIA) {
    path.invalid = true;
    return;
  }
  if (i == columns.count) {
    columns.medium[columns.count++] = medium;
    columns.column[i] = 0;
  }
  columns.column[i] += column;
}

/// The light goes through these columns: vertices behind the one that has it.
void PathTracer::append_columns(Path& path, uint32_t entry, const Columns& columns) {
  if (columns.count == 0) return;
  entries_[entry].vertex.head |= KB_VERTEX_DEFER;
  for (uint32_t i = 0; i < columns.count; ++i) {
    const bool last = i + 1 == columns.count;
    KbPathVertex vertex =
        medium_vertex(flat_.media[columns.medium[i]], KB_VERTEX_NEE | (last ? 0 : KB_VERTEX_DEFER));
    vertex.nee0 = columns.column[i];
    append_medium(path, vertex, {});
  }
}

}  // namespace kiloband::cpu
