// Gas along the rays of paths.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "src_cpu/path/medium_stack.hpp"
#include "src_cpu/path/wave.hpp"

namespace kiloband::cpu {

/// Where a path that has arrived at a surface sends a ray off.
struct Departure {
  uint32_t path, shape;
  glm::vec3 point, normal;  // of the surface, as geometry is: without interpolated normals
  glm::vec3 arrival;        // direction in which the path came
};

/// Null boundaries are passed, and every segment in a gas becomes a vertex: for one path at a time, told by the lanes that shade
/// what the paths have hit (shade-inl.hpp). Scenes without gas have none.
class GasPaths {
 public:
  GasPaths(const FlatScene& scene, const EmbreeScene& embree);

  /// The wave's paths begin where the camera is.
  void start(Wave& wave);
  /// Follows every ray of the queue to the first surface that is one, and notes its segments.
  void walk_boundaries(Wave& wave);
  /// The gas between where the path was and where it is now, or on its way out of the scene.
  void append(Wave& wave, uint32_t path, bool escapes);
  /// The path goes on with number `ray` of the next rays.
  void follow_ray(Wave& wave, const Departure& from, uint32_t ray);
  /// The same for shadow rays. A path has one at most.
  void note_shadow_ray(Wave& wave, const Departure& from, uint32_t ray);
  /// rays: with their answers, in any order. What meets nothing has one medium along its ray; null boundaries are walked through, ray by
  /// ray.
  void finish_shadows(Wave& wave, const ShadowQueue& rays);

 private:
  /// Where a path is, and the segments of the ray at hand.
  struct GasPath {
    MediumStack media;
    uint32_t crossings = 0;  // null boundaries passed
    float begin, far;  // where the ray at hand begins (on the surface that it left) and ends: ray parameters
    uint32_t first_segment = 0, segments = 0;
  };
  /// A part of a ray in one medium.
  struct Segment {
    uint32_t medium;
    glm::vec3 origin, direction;
    float t_min, t_max;
  };
  /// The gases that a shadow ray passes.
  struct Columns {
    uint32_t count = 0;
    uint32_t medium[KB_SHADOW_MEDIA];
    float column[KB_SHADOW_MEDIA];  // m
  };
  /// Where a path's shadow ray begins.
  struct ShadowStart {
    float begin;  // ray parameter: on the surface that it left
    MediumStack media;
  };

  void cross(PathState& path, MediumStack& media, uint32_t shape, bool outwards) const;
  MediumStack media_towards(Wave& wave, const Departure& from, glm::vec3 direction) const;
  void note_segment(const GasPath& gas, const TraceRay& ray);
  void pass_boundary(Wave& wave, PathState& path, GasPath& gas, TraceRay& ray) const;
  void append_segment(Wave& wave, uint32_t path, const KbMedium& medium, const Segment& segment) const;
  void append_plume(Wave& wave, uint32_t path, const KbMedium& medium, const Segment& segment,
                    KbPathVertex vertex) const;
  Columns clear_columns(PathState& path, const ShadowStart& at, const ShadowRay& shadow) const;
  bool walk_shadow(Wave& wave, PathState& path, ShadowStart at, const ShadowRay& shadow,
                   Columns& columns) const;
  void add_column(PathState& path, Columns& columns, uint32_t medium, const TraceRay& ray, float begin) const;
  void append_columns(Wave& wave, uint32_t path, uint32_t entry, const Columns& columns) const;

  const FlatScene& scene_;
  const EmbreeScene& embree_;
  const bool has_boundaries_;
  std::vector<GasPath> paths_;
  std::vector<Segment> segments_;
  std::vector<ShadowStart> shadows_;  // by path
};

}  // namespace kiloband::cpu
