// Vectors and matrices of records.
#pragma once

#include <glm/glm.hpp>

#include "scene/description/description.hpp"
#include "shared/records.h"

namespace kiloband {

inline glm::dvec3 to_glm(const KbFloat3& v) {
  return {v.x, v.y, v.z};
}

/// Row-major 3x4 of an affine transform.
inline void store_transform(const Transform& transform, float (&out)[12]) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      out[4 * row + column] = static_cast<float>(transform[column][row]);
    }
  }
}

/// to_world and its inverse of a shape or an emitter.
template <class Record>
void set_transforms(Record& record, const Transform& to_world) {
  store_transform(to_world, record.to_world);
  store_transform(glm::inverse(to_world), record.to_object);
}

}  // namespace kiloband
