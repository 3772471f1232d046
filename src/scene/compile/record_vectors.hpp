// Vectors of records, to compute with.
#pragma once

#include <glm/glm.hpp>

#include "shared/records.h"

namespace kiloband {

inline glm::dvec3 to_glm(const KbFloat3& v) {
  return {v.x, v.y, v.z};
}

}  // namespace kiloband
