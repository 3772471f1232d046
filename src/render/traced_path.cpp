#include "render/traced_path.hpp"

#include <bit>
#include <cstddef>

namespace kiloband {
namespace {

std::size_t sample_slots(uint32_t head) {
  return (static_cast<std::size_t>(std::popcount(head & KB_VERTEX_TEX_MASK)) + 1) / 2;
}

}  // namespace

void normalise(TracedPath& path) {
  std::size_t last = path.slots.size();
  for (std::size_t i = 0; i < path.slots.size(); i += 1 + sample_slots(path.slots[i].head)) {
    if (path.slots[i].head & (KB_VERTEX_EMIT | KB_VERTEX_NEE)) last = i;
  }
  std::vector<KbPathVertex> kept;
  for (std::size_t i = 0; last < path.slots.size() && i <= last; i += 1 + sample_slots(path.slots[i].head)) {
    KbPathVertex vertex = path.slots[i];
    if (!(vertex.head & KB_VERTEX_NEE)) vertex.head &= ~KB_VERTEX_TEX_NEE;
    if (i == last) vertex.head &= ~(KB_VERTEX_SCATTER | KB_VERTEX_DEGRADE);
    kept.push_back(vertex);
    for (std::size_t s = 0; s < sample_slots(vertex.head); ++s) kept.push_back(path.slots[i + 1 + s]);
  }
  path.slots = std::move(kept);
}

}  // namespace kiloband
