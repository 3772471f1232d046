// The row-major 3x4 matrices of shared/records.h, applied to glm vectors of either precision.
#pragma once

#include <glm/glm.hpp>

namespace kiloband::cpu {

/// Column 0..2: the images of the axes; column 3: the image of the origin.
template <typename T>
glm::vec<3, T> affine_column(const float (&m)[12], int column) {
  return {T(m[column]), T(m[4 + column]), T(m[8 + column])};
}

/// The linear part times v.
template <typename T>
glm::vec<3, T> transform_vector(const float (&m)[12], const glm::vec<3, T>& v) {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[4] * v.x + m[5] * v.y + m[6] * v.z,
          m[8] * v.x + m[9] * v.y + m[10] * v.z};
}

template <typename T>
glm::vec<3, T> transform_point(const float (&m)[12], const glm::vec<3, T>& p) {
  return transform_vector(m, p) + affine_column<T>(m, 3);
}

}  // namespace kiloband::cpu
