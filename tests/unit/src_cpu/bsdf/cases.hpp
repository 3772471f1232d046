// The materials and directions that the statistical tests run over.
#pragma once

#include <string>
#include <vector>

#include "scene/optics/coating.hpp"
#include "tests/support/chi_square.hpp"
#include "tests/support/one_path_bsdfs.hpp"

namespace kiloband::test {

KbMaterial material_of(KbMaterialType type);
KbMaterial rough(KbMaterialType type, uint32_t distribution, float alpha_u, float alpha_v, bool visible,
                 float eta = 1.5f);
/// Plastic with 1.49 / 1 and specular weight 0.6; escape from the independent quadrature, or of its coating.
KbMaterial plastic(KbMaterialType type, bool nonlinear, float alpha = 0.1f);

/// Unit vector at `degrees` from the normal (above 90: from below) and azimuth phi [rad].
glm::vec3 direction(double degrees, double phi = 0.7);

struct Case {
  std::string name;
  KbMaterial material;
  glm::vec3 wi;
  DispersionState dispersion;
  std::vector<float> numbers = {};  // of principled materials
};

/// Of a rough plastic; computed once per roughness.
const Coating& coating_of(const KbMaterial& material);
MaterialContext context_of(const Case& c);
/// Every BSDF with a non-delta lobe, over roughness, distribution, sampling and incident angle.
const std::vector<Case>& scattering_cases();

}  // namespace kiloband::test
