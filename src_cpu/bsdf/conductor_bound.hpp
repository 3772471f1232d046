// Upper bound of a metal's Fresnel reflectance over all channels: what roulette needs to end paths
// in metal cavities.
#pragma once

#include <algorithm>
#include <array>

#include "scene/compile/flat_scene.hpp"

namespace kiloband {

/// F falls from normal incidence to a minimum and rises to 1 at grazing incidence, so within a cell of
/// cosines it is largest at an end.
class ConductorBound {
 public:
  ConductorBound() { nodes_.fill(1); }
  /// Largest F over guide bands and rendered channels (both ends and the middle of each) at 65 cosines.
  ConductorBound(const FlatScene& scene, const KbMaterial& material);

  /// cos_i in [0, 1]
  float at(float cos_i) const {
    const float x = std::clamp(cos_i, 0.0f, 1.0f) * kCells;
    const int cell = std::min(static_cast<int>(x), kCells - 1);
    return std::max(nodes_[cell], nodes_[cell + 1]);
  }

 private:
  static constexpr int kCells = 64;
  std::array<float, kCells + 1> nodes_;
};

}  // namespace kiloband
