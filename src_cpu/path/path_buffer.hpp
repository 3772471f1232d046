// The saved paths of one block of pixels, as deferred evaluation reads them.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/records.h"

namespace kiloband::cpu {

/// Vertices of path p are entries[first[p]] .. entries[first[p] + count[p]): KbPathVertex records, each followed
/// by the entries of its texture samples (two KbTextureSample per 32-byte entry, see path_vertex.h).
struct SavedPath {
  uint32_t first = 0;
  uint32_t count = 0;  // entries
  uint32_t pixel = 0;  // index in the tile
};

struct PathBuffer {
  std::vector<KbPathVertex> entries;
  std::vector<SavedPath> paths;
};

}  // namespace kiloband::cpu
