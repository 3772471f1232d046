#include "scene/mesh/corner_uvs.hpp"

#include <bit>
#include <unordered_map>

#include "base/error.hpp"

namespace kiloband {
namespace {

struct UvCorner {
  uint32_t vertex;
  Vec2f uv;
  bool operator==(const UvCorner&) const = default;
};

struct UvCornerHash {
  size_t operator()(const UvCorner& c) const {
    uint64_t hash = c.vertex * 0x9E3779B97F4A7C15ull;
    for (const float x : c.uv) {
      const uint32_t bits = std::bit_cast<uint32_t>(x == 0 ? 0.0f : x);  // -0 is 0
      hash = (hash ^ (hash >> 29) ^ bits) * 0xBF58476D1CE4E5B9ull;
    }
    return hash ^ (hash >> 31);
  }
};

template <class T>
void append_copy(std::vector<T>& values, uint32_t of) {
  if (values.empty()) return;
  const T value = values[of];
  values.push_back(value);
}

}  // namespace

void set_corner_uvs(Mesh& mesh, const std::vector<CornerUvs>& uvs) {
  std::vector<bool> is_taken(mesh.positions.size());
  std::unordered_map<UvCorner, uint32_t, UvCornerHash> vertex_of;
  mesh.uvs.assign(mesh.positions.size(), {});
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (size_t corner = 0; corner < 3; ++corner) {
      uint32_t& index = mesh.triangles[t][corner];
      const Vec2f& uv = uvs[t][corner];
      const auto [entry, is_new] = vertex_of.try_emplace({index, uv}, index);
      if (is_new && is_taken[index]) {
        if (mesh.positions.size() > UINT32_MAX) throw InputError("more than 4294967295 vertices");
        entry->second = static_cast<uint32_t>(mesh.positions.size());
        append_copy(mesh.positions, index);
        append_copy(mesh.normals, index);
        for (auto& [name, values] : mesh.vertex_attributes) append_copy(values, index);
        mesh.uvs.push_back(uv);
      } else if (is_new) {
        is_taken[index] = true;
        mesh.uvs[index] = uv;
      }
      index = entry->second;
    }
}

}  // namespace kiloband
