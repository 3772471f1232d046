// Gas along the rays of a path: null boundaries are passed, and every segment in a gas becomes a vertex of
// kind KB_KIND_MEDIUM (shared/path_vertex.h).
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
#include "src_cpu/path/gas_paths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "shared/plume.h"
#include "src_cpu/geometry/boundary.hpp"

namespace kiloband::cpu {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

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

float plume_column(const FlatScene& scene, const KbMedium& medium, const Straight& s) {
  KbPlumeWalk walk;
  const KbFloat2* nodes = scene.plume_nodes.data();
  if (!kb_plume_begin(&walk, &medium, nodes, s.origin, s.direction, s.begin, s.end)) return 0;
  return kb_plume_column(&walk, &medium, nodes);
}

/// Of a part of a ray, in m.
float column_of(const FlatScene& scene, const KbMedium& medium, const glm::vec3& origin,
                const glm::vec3& direction, float t_min, float t_max) {
  if (is_plume(medium)) return plume_column(scene, medium, straight(origin, direction, t_min, t_max));
  const float length = glm::length(direction);
  return medium.scale * (t_max * length - t_min * length);
}

/// A vertex of gas behind what the path has saved, and the cells that follow it. The sample is invalid where a column is not finite.
void append_medium(Wave& wave, uint32_t path, const KbPathVertex& medium,
                   std::span<const KbPlumeCell> cells) {
  PathState& state = wave.paths[path];
  if (!std::isfinite(medium.nee0) || !std::isfinite(medium.scatter0)) state.flags |= kInvalidPath;
  add_entry(wave, state).vertex = medium;
  for (std::size_t i = 0; i < cells.size(); i += 4)
    wave.entries.emplace_back(&cells[i], std::min<std::size_t>(4, cells.size() - i) * sizeof cells[i]);
  ++wave.vertices;
}

}  // namespace

GasPaths::GasPaths(const FlatScene& scene, const EmbreeScene& embree)
    : scene_(scene), embree_(embree), has_boundaries_(has_boundaries(scene)), shadows_(kWavePaths) {}

void GasPaths::start(Wave& wave) {
  const RayQueue& rays = wave.rays();
  paths_.clear();
  for (uint32_t i = 0; i < rays.count; ++i)
    paths_.push_back({MediumStack(scene_.camera_media), 0, rays.t_min[i], rays.t_max[i]});
}

/// The path goes through a shape's surface. outwards: to the side of its normal.
void GasPaths::cross(PathState& path, MediumStack& media, uint32_t shape, bool outwards) const {
  const uint32_t medium = scene_.interiors[shape];
  if (medium == KB_NONE) return;
  if (outwards)
    media.leave(medium);
  else if (!media.enter(medium))
    path.flags |= kInvalidPath;
}

/// The media on the side of the surface that `direction` goes to, of a path that arrived there.
MediumStack GasPaths::media_towards(Wave& wave, const Departure& from, glm::vec3 direction) const {
  MediumStack media = paths_[from.path].media;
  const bool from_front = glm::dot(from.normal, from.arrival) < 0;
  const bool to_front = glm::dot(from.normal, direction) >= 0;
  if (from_front != to_front) cross(wave.paths[from.path], media, from.shape, to_front);
  return media;
}

/// Of the ray at hand, up to the surface that it has hit: the gas there.
void GasPaths::note_segment(const GasPath& gas, const TraceRay& ray) {
  const uint32_t medium = gas.media.current(scene_.atmosphere);
  if (ray.shape != KB_NONE && has_gas(scene_, medium))
    segments_.push_back({medium, ray.origin(), ray.direction(), gas.begin, ray.t_max});
}

void GasPaths::walk_boundaries(Wave& wave) {
  RayQueue& rays = wave.rays();
  segments_.clear();
  for (uint32_t i = 0; i < rays.count; ++i) {
    const uint32_t path = rays.path[i];
    GasPath& gas = paths_[path];
    gas.first_segment = static_cast<uint32_t>(segments_.size());
    TraceRay ray = ray_of(rays, i);
    note_segment(gas, ray);
    while (is_boundary(scene_, ray.shape)) {
      pass_boundary(wave, wave.paths[path], gas, ray);
      note_segment(gas, ray);
      put_ray(ray, rays, i);
    }
    gas.segments = static_cast<uint32_t>(segments_.size()) - gas.first_segment;
    gas.far = kInfinity;
  }
}

void GasPaths::pass_boundary(Wave& wave, PathState& path, GasPath& gas, TraceRay& ray) const {
  const glm::vec3 direction = ray.direction();
  const SurfaceHit hit = surface_of(scene_, ray);
  cross(path, gas.media, hit.shape, glm::dot(hit.geometric_normal, direction) >= 0);
  gas.far -= ray.t_max;
  ray = TraceRay(leave_surface(hit, direction), direction, 0, gas.far);
  gas.begin = begin_at(hit.point, ray.origin(), direction);
  if (++gas.crossings >= KB_MAX_VERTICES) {
    path.flags |= kInvalidPath;
    return;  // as if it left the scene
  }
  const bool recorded = wave.recording && path.pixel != KB_NONE;
  if (recorded) {
    wave.recording->closest.push_back(ray);
    wave.recording->closest_path.push_back(path.pixel);
  }
  ++wave.traced_rays;
  embree_.closest_hits(std::span(&ray, 1));
  if (recorded) wave.recording->answers.push_back(ray);
}

/// The gas between where the path was and where it is now, or on its way out of the scene.
void GasPaths::append(Wave& wave, uint32_t path, bool escapes) {
  const GasPath& gas = paths_[path];
  float in_front = 0;  // atmosphere that a ray out of the scene has passed, m
  for (uint32_t i = gas.first_segment; i < gas.first_segment + gas.segments; ++i) {
    const Segment& segment = segments_[i];
    const KbMedium& medium = scene_.media[segment.medium];
    if (escapes && segment.medium == scene_.atmosphere) {
      in_front += column_of(scene_, medium, segment.origin, segment.direction, segment.t_min, segment.t_max);
      continue;
    }
    if (in_front > 0 && medium.emit_row != KB_NONE) {
      KbPathVertex aside = medium_vertex(scene_.media[scene_.atmosphere], KB_VERTEX_DEFER);
      aside.scatter0 = in_front;
      append_medium(wave, path, aside, {});
    }
    append_segment(wave, path, medium, segment);
  }
}

void GasPaths::append_segment(Wave& wave, uint32_t path, const KbMedium& medium,
                              const Segment& segment) const {
  const bool emits = medium.emit_row != KB_NONE;
  KbPathVertex vertex = medium_vertex(medium, KB_VERTEX_SCATTER | (emits ? KB_VERTEX_EMIT : 0));
  vertex.emit_weight = 1;
  if (emits) vertex.emit_row = static_cast<uint16_t>(medium.emit_row);
  if (is_plume(medium)) return append_plume(wave, path, medium, segment, vertex);
  vertex.scatter0 =
      column_of(scene_, medium, segment.origin, segment.direction, segment.t_min, segment.t_max);
  if (vertex.scatter0 != 0) append_medium(wave, path, vertex, {});
}

void GasPaths::append_plume(Wave& wave, uint32_t path, const KbMedium& medium, const Segment& segment,
                            KbPathVertex vertex) const {
  const Straight s = straight(segment.origin, segment.direction, segment.t_min, segment.t_max);
  KbPlumeWalk walk;
  KbPlumeCell cells[KB_PLUME_CELLS];
  const KbFloat2* nodes = scene_.plume_nodes.data();
  if (!kb_plume_begin(&walk, &medium, nodes, s.origin, s.direction, s.begin, s.end)) return;
  uint32_t count = 0;
  while (const uint32_t more = kb_plume_next(&walk, &medium, nodes, &cells[count])) count += more;
  if (count == 0) return;
  for (uint32_t i = 0; i < count; ++i) vertex.scatter0 += cells[i].column;
  vertex.head |= count << KB_VERTEX_MATERIAL_SHIFT;
  vertex.nee0 = walk.first_k;
  vertex.nee1 = medium.reference_k;
  append_medium(wave, path, vertex, std::span(cells).first(count));
}

void GasPaths::follow_ray(Wave& wave, const Departure& from, uint32_t ray) {
  const TraceRay next = query_of(wave.next_rays(), ray);
  GasPath& gas = paths_[from.path];
  gas.media = media_towards(wave, from, next.direction());
  gas.begin = begin_at(from.point, next.origin(), next.direction());
}

void GasPaths::note_shadow_ray(Wave& wave, const Departure& from, uint32_t ray) {
  const ShadowRay shadow = query_of(wave.shadow_rays, ray);
  shadows_[from.path] = {begin_at(from.point, shadow.origin(), shadow.direction()),
                         media_towards(wave, from, shadow.direction())};
}

void GasPaths::finish_shadows(Wave& wave, const ShadowQueue& rays) {
  for (uint32_t i = 0; i < rays.count; ++i) {
    const uint32_t path = rays.path[i];
    const ShadowRay ray = query_of(rays, i);
    Columns columns;
    bool visible = !ray.occluded();
    if (visible && has_boundaries_ && rays.passes[i])
      visible = walk_shadow(wave, wave.paths[path], shadows_[path], ray, columns);
    else if (visible)
      columns = clear_columns(wave.paths[path], shadows_[path], ray);
    if (visible)
      append_columns(wave, path, rays.entry[i], columns);
    else
      wave.entries[rays.entry[i]].vertex.head &= ~KB_VERTEX_NEE;
  }
}

/// Of a shadow ray that meets nothing: the medium where it begins, on all of it; out of the scene none (as in walk_shadow()).
GasPaths::Columns GasPaths::clear_columns(PathState& path, const ShadowStart& at,
                                          const ShadowRay& shadow) const {
  Columns columns;
  if (shadow.t_max == kInfinity) return columns;
  const TraceRay ray(shadow.origin(), shadow.direction(), 0, shadow.t_max);
  add_column(path, columns, at.media.current(scene_.atmosphere), ray, at.begin);
  return columns;
}

/// Returns whether the light is visible; `columns` are then what lies in between.
bool GasPaths::walk_shadow(Wave& wave, PathState& path, ShadowStart at, const ShadowRay& shadow,
                           Columns& columns) const {
  const glm::vec3 origin = shadow.origin(), direction = shadow.direction();
  const bool infinite = shadow.t_max == kInfinity;
  TraceRay ray(origin, direction, 0, shadow.t_max);
  for (uint32_t crossings = 0;; ++crossings) {
    ++wave.traced_rays;
    embree_.closest_hits(std::span(&ray, 1));
    const bool arrives = ray.shape == KB_NONE;
    if (!arrives && !is_boundary(scene_, ray.shape)) return false;
    const uint32_t medium = at.media.current(scene_.atmosphere);
    if (infinite ? !arrives && medium != scene_.atmosphere : true)
      add_column(path, columns, medium, ray, at.begin);
    if (arrives) return true;
    if (crossings >= KB_MAX_VERTICES) return path.flags |= kInvalidPath, false;
    const SurfaceHit hit = surface_of(scene_, ray);
    cross(path, at.media, hit.shape, glm::dot(hit.geometric_normal, direction) >= 0);
    const glm::vec3 from = leave_surface(hit, direction);
    ray = infinite ? TraceRay(from, direction, 0, kInfinity)
                   : TraceRay(from, origin + direction - from, 0, shadow.t_max);
    at.begin = begin_at(hit.point, from, ray.direction());
  }
}

void GasPaths::add_column(PathState& path, Columns& columns, uint32_t medium, const TraceRay& ray,
                          float begin) const {
  if (!has_gas(scene_, medium)) return;
  const float column =
      column_of(scene_, scene_.media[medium], ray.origin(), ray.direction(), begin, ray.t_max);
  if (column == 0) return;
  uint32_t i = 0;
  while (i < columns.count && columns.medium[i] != medium) ++i;
  if (i == KB_SHADOW_MEDIA) {
    path.flags |= kInvalidPath;
    return;
  }
  if (i == columns.count) {
    columns.medium[columns.count++] = medium;
    columns.column[i] = 0;
  }
  columns.column[i] += column;
}

/// The light goes through these columns: vertices behind the one that has it.
void GasPaths::append_columns(Wave& wave, uint32_t path, uint32_t entry, const Columns& columns) const {
  if (columns.count == 0) return;
  wave.entries[entry].vertex.head |= KB_VERTEX_DEFER;
  for (uint32_t i = 0; i < columns.count; ++i) {
    const bool last = i + 1 == columns.count;
    KbPathVertex vertex =
        medium_vertex(scene_.media[columns.medium[i]], KB_VERTEX_NEE | (last ? 0 : KB_VERTEX_DEFER));
    vertex.nee0 = columns.column[i];
    append_medium(wave, path, vertex, {});
  }
}

}  // namespace kiloband::cpu
