// Boxes around what a description places, in double.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <limits>
#include <map>

#include "scene/description/description.hpp"

namespace kiloband {

/// An axis-aligned box, m. Empty until something is added.
struct Extent {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

  void add(const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  bool is_empty() const { return !(low.x <= high.x); }
  double largest_side() const {
    const glm::dvec3 side = high - low;
    return std::max({side.x, side.y, side.z});
  }
  /// With the box of this one's corners under a transform.
  void add_placed(const Extent& other, const Transform& transform);
};

/// With a shape's points, or with a box around a canonical analytic shape, as its to_world places them.
void extend(const Shape& shape, Extent& extent);

/// The boxes of groups in their own coordinates, each computed once.
class GroupExtents {
 public:
  const Extent& of(const ShapeGroup& group);

 private:
  std::map<const ShapeGroup*, Extent> extents_;
};

}  // namespace kiloband
