// Runs the device's BSDFs and the CPU's on the same queries.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/one_path_bsdfs.hpp"
#include "tests/support/principled_numbers.hpp"

namespace kiloband::test {

// The records below are read by the kernels in probe.cpp: plain 4-byte members.
struct Query {
  float wi[3], wo[3];
  float u_lobe, u[2];
  float dispersion_eta;  // of the material's context; for transmit_dispersive the channel's index
  float probability;     // of transmit_dispersive
  uint32_t material;
};
struct Value {
  float w0, w1, pdf;
  uint32_t lobe_b;
};
enum SampleFlags : uint32_t { kDelta = 1, kTransmission = 2, kLobeB = 4, kNeedsChannel = 8 };
struct Sample {
  float wo[3], w0, w1, pdf, eta, bound;
  uint32_t flags, kind;
};
struct Answers {
  std::vector<Value> values;
  std::vector<Sample> samples, transmitted;
  std::vector<uint32_t> kinds;  // eval_kind | has_smooth_lobe << 8
};

/// Materials with their tables, as in a compiled scene.
class Scene {
 public:
  /// Returns the material's index.
  uint32_t add(const KbMaterial& material);
  uint32_t add(const PrincipledExample& example);
  /// The same for a material whose table is missing.
  uint32_t add_without_table(KbMaterial material);

  Answers on_cpu(const std::vector<Query>& queries) const;
  /// options: further compiler options, such as -DKB_SPECIALISED
  Answers on_device(const std::vector<Query>& queries, const std::string& options = "") const;

  MaterialContext context(const Query& query) const;
  const KbMaterial& material(uint32_t index) const { return materials_[index]; }

 private:
  std::vector<KbMaterial> materials_;
  std::vector<float> tables_;
};

/// The lookups of shared/material_tables.h on the device, at each cosine.
struct Lookups {
  std::vector<float> bounds;          // kb_conductor_bound; an empty table is a null pointer there
  std::vector<float> transmittances;  // kb_coat_transmittance; of an empty table 0
};
Lookups lookups_on_device(const std::vector<float>& table, const std::vector<float>& cosines);

Sample record_of(const BsdfSample& sample);

/// Deterministic uniform numbers in [0,1): SplitMix64 (Steele, Lea, Flood 2014).
class Uniform {
 public:
  explicit Uniform(uint64_t seed) : state_(seed) {}
  float operator()();
  /// A unit vector: uniform, or in one case of four grazing.
  glm::vec3 direction();

 private:
  uint64_t state_;
};

KbMaterial material_of(KbMaterialType type, float eta = 1.5f);
KbMaterial rough(KbMaterialType type, uint32_t distribution, float alpha_u, float alpha_v, bool visible,
                 float eta = 1.5f);
std::string describe(const KbMaterial& material);

/// Every material type; for rough ones both distributions, visible normals or all,
/// four roughnesses, and indices.
std::vector<KbMaterial> every_material();

}  // namespace kiloband::test
