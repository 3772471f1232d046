// Chi-square test of sampled directions against a density on the sphere.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>

namespace kiloband::test {

/// One draw: a direction; nothing if no direction came out; or the delta lobe.
struct Draw {
  std::optional<glm::vec3> wo;
  bool delta = false;
};

struct ChiSquare {
  double p_value = 0;
  double pdf_integral = 0;  // over the sphere, by quadrature
  int bins = 0;
};

/// Cells are a quadtree in (z, phi), refined where a pilot run is dense; cells with an expected count below
/// 10 are pooled. Draws without a direction are a bin of their own with what is missing from 1; delta draws
/// have probability `delta`.
ChiSquare chi_square(const std::function<Draw()>& draw, const std::function<double(glm::vec3)>& pdf,
                     double delta, int count);

}  // namespace kiloband::test
