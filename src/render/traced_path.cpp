#include "render/traced_path.hpp"

#include <cstddef>

namespace kiloband {

void normalise(TracedPath& path) {
  std::size_t last = path.entries.size();
  for (std::size_t i = 0; i < path.entries.size(); i += 1 + kb_vertex_extensions(path.entries[i].head)) {
    if (path.entries[i].head & (KB_VERTEX_EMIT | KB_VERTEX_NEE)) last = i;
  }
  std::vector<KbPathVertex> kept;
  for (std::size_t i = 0; last < path.entries.size() && i <= last;
       i += 1 + kb_vertex_extensions(path.entries[i].head)) {
    KbPathVertex vertex = path.entries[i];
    if (!(vertex.head & KB_VERTEX_NEE)) vertex.head &= ~KB_VERTEX_TEX_NEE;
    if (i == last) vertex.head &= ~(KB_VERTEX_SCATTER | KB_VERTEX_DEGRADE);
    kept.push_back(vertex);
    for (std::size_t s = 0; s < kb_vertex_extensions(vertex.head); ++s)
      kept.push_back(path.entries[i + 1 + s]);
  }
  path.entries = std::move(kept);
}

}  // namespace kiloband
