// What was compiled of bsdfs, each once.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>

#include "scene/compile/compile_context.hpp"

namespace kiloband {

/// Indices by bsdf and one more key; of a bsdf with mesh attributes there is one for each mesh.
template <class Key>
class CompiledBsdfs {
 public:
  explicit CompiledBsdfs(CurrentMesh& current) : current_(current) {}

  /// What was compiled for every mesh, or for this one; or null.
  const uint32_t* find(const Bsdf& bsdf, Key key) {
    const auto for_all = indices_.find({&bsdf, key, nullptr});
    if (for_all != indices_.end()) return &for_all->second;
    const auto for_this = indices_.find({&bsdf, key, current_.mesh});
    if (for_this == indices_.end()) return nullptr;
    ++current_.lookups;
    return &for_this->second;
  }
  /// lookups: CurrentMesh's before this was compiled
  void add(const Bsdf& bsdf, Key key, std::size_t lookups, uint32_t index) {
    indices_[{&bsdf, key, current_.lookups > lookups ? current_.mesh : nullptr}] = index;
  }

 private:
  CurrentMesh& current_;
  std::map<std::tuple<const Bsdf*, Key, const Mesh*>, uint32_t> indices_;
};

}  // namespace kiloband
