// One path, vertex by vertex: what `kiloband trace` shows and what parity tests compare.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/records.h"

namespace kiloband {

/// What one ray of a path found. shape KB_NONE: it left the scene.
struct TracedHit {
  uint32_t shape = KB_NONE;
  uint32_t primitive = 0;  // triangle within the shape
  float t = 0, u = 0, v = 0;
};

struct TracedPath {
  std::vector<TracedHit> hits;  // by bounce
  std::vector<KbPathVertex>
      entries;           // as saved for evaluation, up to the last vertex with light; see path_vertex.h
  bool invalid = false;  // the sample leaves the mean
};

/// Drops what does not contribute and what only one backend writes: vertices behind the last one with light,
/// the scattering of that vertex, texture samples of light that is hidden.
void normalise(TracedPath& path);

}  // namespace kiloband
