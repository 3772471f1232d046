#include "cases.hpp"

#include <cmath>
#include <map>
#include <tuple>

#include "reference.hpp"
#include "tests/support/principled_numbers.hpp"

namespace kiloband::test {

KbMaterial material_of(KbMaterialType type) {
  KbMaterial m{};
  m.type = type;
  m.eta = 1.5f;
  m.alpha_u = m.alpha_v = 0.1f;
  m.specular_weight = 0.5f;
  m.bound_a = m.bound_b = 1;
  m.flags = KB_MATERIAL_SAMPLE_VISIBLE;
  return m;
}

KbMaterial rough(KbMaterialType type, uint32_t distribution, float alpha_u, float alpha_v, bool visible,
                 float eta) {
  KbMaterial m = material_of(type);
  m.flags |= distribution;
  m.alpha_u = alpha_u;
  m.alpha_v = alpha_v;
  m.eta = eta;
  if (!visible) m.flags &= ~KB_MATERIAL_SAMPLE_VISIBLE;
  return m;
}

KbMaterial plastic(KbMaterialType type, bool nonlinear, float alpha) {
  static const float escape = static_cast<float>(1 - reference::diffuse_fresnel(1 / 1.49));
  KbMaterial m = rough(type, KB_MATERIAL_GGX, alpha, alpha, true, 1.49f);
  m.specular_weight = 0.6f;
  m.escape = escape;
  if (type == KB_MATERIAL_ROUGH_PLASTIC)
    m.escape = static_cast<float>(1 - coating_of(m).internal_reflectance);
  if (nonlinear) m.flags |= KB_MATERIAL_NONLINEAR;
  return m;
}

glm::vec3 direction(double degrees, double phi) {
  const double theta = degrees * M_PI / 180;
  return glm::vec3(
      glm::dvec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)));
}

MaterialContext context_of(const Case& c) {
  MaterialContext context{&c.material, nullptr, c.dispersion};
  if (c.material.type == KB_MATERIAL_ROUGH_PLASTIC)
    context.table = coating_of(c.material).transmittance.data();
  if (c.material.type == KB_MATERIAL_PRINCIPLED) context.table = c.numbers.data();
  return context;
}

const Coating& coating_of(const KbMaterial& material) {
  static std::map<std::tuple<uint32_t, float, float>, Coating> tables;
  const auto key = std::make_tuple(material.flags & KB_MATERIAL_GGX, material.alpha_u, material.eta);
  auto found = tables.find(key);
  if (found == tables.end()) found = tables.emplace(key, make_coating(material)).first;
  return found->second;
}

namespace {

std::string describe(const char* model, const KbMaterial& m, double degrees) {
  return std::string(model) + ((m.flags & KB_MATERIAL_GGX) ? " ggx " : " beckmann ") +
         std::to_string(m.alpha_u) + " x " + std::to_string(m.alpha_v) +
         (m.flags & KB_MATERIAL_SAMPLE_VISIBLE ? " visible" : " all normals") + " eta " +
         std::to_string(m.eta) + ", " + std::to_string(degrees) + " degrees";
}

void add(std::vector<Case>& cases, const char* model, const KbMaterial& m,
         std::initializer_list<double> angles) {
  for (double degrees : angles) cases.push_back({describe(model, m, degrees), m, direction(degrees), {}});
}

void add_rough(std::vector<Case>& cases, uint32_t distribution, bool visible) {
  for (auto [u, v] : {std::pair{0.01f, 0.01f}, {0.1f, 0.1f}, {0.9f, 0.9f}, {0.05f, 0.4f}}) {
    add(cases, "rough conductor", rough(KB_MATERIAL_ROUGH_CONDUCTOR, distribution, u, v, visible), {10, 75});
    add(cases, "rough dielectric", rough(KB_MATERIAL_ROUGH_DIELECTRIC, distribution, u, v, visible),
        {20, 80, 120});
  }
  const KbMaterial wide = rough(KB_MATERIAL_ROUGH_CONDUCTOR, distribution, 0.5f, 0.5f, visible);
  add(cases, "rough conductor", wide, {0, 89.5});
  const KbMaterial to_air = rough(KB_MATERIAL_ROUGH_DIELECTRIC, distribution, 0.3f, 0.3f, visible, 0.75f);
  add(cases, "rough dielectric", to_air, {40, 140});
}

std::vector<Case> make_cases() {
  std::vector<Case> cases;
  add(cases, "diffuse", material_of(KB_MATERIAL_DIFFUSE), {0, 60});
  for (uint32_t distribution : {0u, KB_MATERIAL_GGX})
    for (bool visible : {true, false}) add_rough(cases, distribution, visible);
  for (bool nonlinear : {false, true}) {
    add(cases, "plastic", plastic(KB_MATERIAL_PLASTIC, nonlinear), {5, 70});
    add(cases, "rough plastic", plastic(KB_MATERIAL_ROUGH_PLASTIC, nonlinear, 0.1f), {0, 30, 85});
  }
  KbMaterial all_normals = plastic(KB_MATERIAL_ROUGH_PLASTIC, false, 0.4f);
  all_normals.flags &= ~KB_MATERIAL_SAMPLE_VISIBLE;
  add(cases, "rough plastic", all_normals, {45});
  KbMaterial dispersive = rough(KB_MATERIAL_ROUGH_DIELECTRIC, KB_MATERIAL_GGX, 0.2f, 0.2f, true);
  dispersive.flags |= KB_MATERIAL_DISPERSIVE;
  cases.push_back({"rough dispersive, degraded", dispersive, direction(35), DispersionState{1.62f}});
  for (const PrincipledExample& example : principled_examples())
    for (const double degrees : {0.0, 35.0, 80.0, 145.0}) {
      if (degrees > 90 && !example.thin && !(example.numbers[KB_PRINCIPLED_SPEC_TRANS] > 0)) continue;
      cases.push_back({"principled " + example.name + ", " + std::to_string(degrees) + " degrees",
                       principled_material(example),
                       direction(degrees),
                       {},
                       example.numbers});
    }
  return cases;
}

}  // namespace

const std::vector<Case>& scattering_cases() {
  static const std::vector<Case> cases = make_cases();
  return cases;
}

}  // namespace kiloband::test
