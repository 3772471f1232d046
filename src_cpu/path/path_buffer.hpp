// The saved paths of one block of pixels, as deferred evaluation reads them.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/records.h"

namespace kiloband::cpu {

/// Vertices of path p are slots[first[p]] .. slots[first[p] + count[p]): KbPathVertex records, each followed
/// by the slots of its texture samples (two KbTextureSample per 32-byte slot, see path_vertex.h).
struct SavedPath {
  uint32_t first = 0;
  uint32_t count = 0;  // slots
  uint32_t pixel = 0;  // index in the tile
};

struct PathBuffer {
  std::vector<KbPathVertex> slots;
  std::vector<SavedPath> paths;

  void clear() {
    slots.clear();
    paths.clear();
  }
};

}  // namespace kiloband::cpu
