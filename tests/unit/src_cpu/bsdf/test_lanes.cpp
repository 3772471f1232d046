// BSDFs over lanes: every instruction set gives the bits of one lane, and one lane what the interface for single paths
// gives. Materials, directions and random numbers are random, waves of one material and of many.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "bsdf_functions.hpp"
#include "cases.hpp"
#include "shared/material_tables.h"
#include "shared/principled.h"
#include "shared/thermal.h"

namespace kiloband::test::test_lanes {
namespace {

constexpr std::size_t kMaterials = 512, kCount = 9 << 13;

/// Materials of every kind, with tables of random numbers.
struct RandomScene {
  std::mt19937 random{41};
  std::vector<KbMaterial> materials;
  std::vector<float> tables = std::vector<float>(7, 0.5f);  // offsets that are not 0

  float between(float low, float high) {
    return low + (high - low) * static_cast<float>(random() >> 8) * 0x1p-24f;
  }
  bool chance(float p) { return between(0, 1) < p; }
  void add_table(std::size_t size, float low, float high) {
    for (std::size_t i = 0; i < size; ++i) tables.push_back(between(low, high));
  }

  RandomScene() {
    while (materials.size() < kMaterials) add_material();
  }

  void add_material() {
    KbMaterial m = material_of(static_cast<KbMaterialType>(random() % KB_MATERIAL_COUNT));
    m.flags = static_cast<uint32_t>(random()) & (KB_MATERIAL_NONLINEAR | KB_MATERIAL_SAMPLE_VISIBLE |
                                                 KB_MATERIAL_PERFECT_MIRROR | KB_MATERIAL_GGX);
    const bool glass = m.type == KB_MATERIAL_DIELECTRIC || m.type == KB_MATERIAL_ROUGH_DIELECTRIC;
    if (glass && chance(0.5f)) m.flags |= KB_MATERIAL_DISPERSIVE;
    if (m.type == KB_MATERIAL_DIELECTRIC && chance(0.3f)) m.flags |= KB_MATERIAL_THIN;
    m.alpha_u = chance(0.1f) ? 0 : std::pow(10.0f, between(-4.5f, 0.1f));
    m.alpha_v = chance(0.5f) ? m.alpha_u : std::pow(10.0f, between(-3, 0));
    m.eta = chance(0.1f) ? 1 + between(-1e-4f, 1e-4f) : between(0.5f, 2.5f);
    m.specular_weight = between(0, 1);
    m.escape = between(0.1f, 1);
    m.bound_a = between(0, 1);
    m.bound_b = between(0, 1);
    m.table = static_cast<uint32_t>(tables.size());
    const bool rough = m.type == KB_MATERIAL_ROUGH_CONDUCTOR || m.type == KB_MATERIAL_ROUGH_DIELECTRIC ||
                       m.type == KB_MATERIAL_ROUGH_PLASTIC;
    if (rough && chance(0.3f)) m.flags |= KB_MATERIAL_COMPENSATED;
    if (m.type == KB_MATERIAL_PRINCIPLED) add_principled(m);
    add_table(kb_floats_before_compensation(m.type, m.flags), 0, 1);
    if (m.flags & KB_MATERIAL_COMPENSATED) add_compensation(m);
    if (m.table == tables.size()) m.table = KB_NONE;
    materials.push_back(m);
  }

  /// Numbers that are often 0 or 1.
  void add_principled(KbMaterial& m) {
    m.flags = KB_MATERIAL_GGX | KB_MATERIAL_SAMPLE_VISIBLE | (chance(0.4f) ? KB_MATERIAL_THIN : 0u);
    for (int n = 0; n < KB_PRINCIPLED_NUMBERS; ++n)
      tables.push_back(chance(0.3f) ? 0.0f : chance(0.3f) ? 1.0f : between(0, 1));
    tables[m.table + KB_PRINCIPLED_ETA] = chance(0.2f) ? 1.0f : between(1, 2.5f);
  }

  void add_compensation(const KbMaterial& m) {
    const bool glass = m.type == KB_MATERIAL_ROUGH_DIELECTRIC;
    const uint32_t nodes_s = chance(0.5f) ? 1 : 5, nodes_eta = m.flags & KB_MATERIAL_DISPERSIVE ? 3 : 1;
    for (const float x : {float(nodes_s), float(nodes_eta), 1.4f, nodes_eta > 1 ? 5.0f : 0.0f})
      tables.push_back(x);
    add_table(std::size_t{KB_COMPENSATION_NODES} * nodes_s * nodes_eta * (glass ? 2 : 1), 0.3f, 1);
  }

  MaterialContext context(uint32_t index, float channel_eta) const {
    const KbMaterial& m = materials[index];
    MaterialContext context{&m, m.table == KB_NONE ? nullptr : &tables[m.table], {channel_eta}};
    if (m.flags & KB_MATERIAL_COMPENSATED)
      context.compensation = context.table + kb_floats_before_compensation(m.type, m.flags);
    return context;
  }
};

/// Also grazing ones, the normal itself, and some in the plane of the surface.
glm::vec3 random_direction(RandomScene& scene) {
  float z = scene.between(-1, 1);
  const uint32_t kind = scene.random() % 32;
  if (kind < 4) z *= 1e-3f;
  if (kind == 4) z = z < 0 ? -1 : 1;
  if (kind == 5) z = 0;
  if (kind == 6) z *= 1e-8f;
  const float r = std::sqrt((1 - z) * (1 + z)), phi = scene.between(0, 6.28f);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

/// Half of the waves have one material, and all lanes in use.
LaneQueries random_queries(RandomScene& scene) {
  LaneQueries q;
  q.materials = scene.materials.data();
  q.tables = scene.tables.data();
  uint32_t material = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    const bool uniform_wave = i / 16 % 2 == 0;
    if (i % 16 == 0 || !uniform_wave) material = scene.random() % kMaterials;
    q.material.push_back(material);
    q.active.push_back(uniform_wave || !scene.chance(0.3f));
    const glm::vec3 wi = random_direction(scene);
    glm::vec3 wo = random_direction(scene);
    // Near the mirrored direction, so that narrow lobes have values too.
    if (scene.chance(0.4f)) wo = glm::normalize(glm::vec3(-wi.x, -wi.y, wi.z) + scene.between(0, 0.02f) * wo);
    for (int k = 0; k < 3; ++k) {
      q.wi[k].push_back(wi[k]);
      q.wo[k].push_back(wo[k]);
    }
    q.channel_eta.push_back(scene.chance(0.5f) ? 0 : scene.between(1.2f, 1.9f));
    q.probability.push_back(scene.between(0.01f, 1));
    q.u_lobe.push_back(scene.between(0, 1));
    q.u[0].push_back(scene.between(0, 1));
    q.u[1].push_back(scene.between(0, 1));
  }
  return q;
}

struct Fixture {
  RandomScene scene;
  LaneQueries queries = random_queries(scene);
  LaneAnswers answers = answers_of_one_lane(queries);
};

const Fixture& fixture() {
  static const Fixture all;
  return all;
}

std::string where(std::size_t i) {
  const Fixture& f = fixture();
  const KbMaterial& m = f.scene.materials[f.queries.material[i]];
  return "query " + std::to_string(i) + ", material type " + std::to_string(m.type) + ", flags " +
         std::to_string(m.flags) + ", alpha " + std::to_string(m.alpha_u);
}

class BsdfLanes : public testing::TestWithParam<cpu::Isa> {};

TEST_P(BsdfLanes, GiveTheBitsOfOneLane) {
  if (!is_available(GetParam())) GTEST_SKIP() << "this processor has no " << to_string(GetParam());
  const LaneAnswers& one = fixture().answers;
  const LaneAnswers many = answers_of(GetParam(), fixture().queries);
  ASSERT_EQ(many.size(), one.size());
  for (std::size_t row = 0; row < one.size(); ++row)
    for (std::size_t i = 0; i < kCount; ++i)
      ASSERT_EQ(kb_as_u32(many[row][i]), kb_as_u32(one[row][i]))
          << "row " << row << ": " << many[row][i] << " instead of " << one[row][i] << "; " << where(i);
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, BsdfLanes,
                         testing::Values(cpu::Isa::kSse4, cpu::Isa::kAvx2, cpu::Isa::kAvx512),
                         [](const auto& set) { return std::string(to_string(set.param)); });

/// Nothing but eta = 1 and the kind that no sample has.
TEST(BsdfLanes, LanesOutOfUseHaveNothing) {
  const Fixture& f = fixture();
  std::size_t unused = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    if (f.queries.active[i]) continue;
    ++unused;
    for (std::size_t row = 0; row < f.answers.size(); ++row) {
      const bool eta = row == kValueRows + 6 || row == kValueRows + kSampleRows + 6;
      ASSERT_EQ(f.answers[row][i], eta ? 1.0f : 0.0f) << "row " << row << "; " << where(i);
    }
  }
  EXPECT_GT(unused, kCount / 10);
}

TEST(BsdfLanes, NoLaneWithoutSampleHasWeights) {
  const Fixture& f = fixture();
  const auto sample = [&](std::size_t row, std::size_t i) { return f.answers[kValueRows + row][i]; };
  std::size_t lost = 0, found = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    if (sample(5, i) > 0) {
      ++found;
      continue;
    }
    ++lost;
    for (const std::size_t row : {0, 1, 2, 3, 4, 5, 7, 8, 9, 10, 11})
      ASSERT_EQ(sample(row, i), 0.0f) << "row " << row << "; " << where(i);
  }
  EXPECT_GT(lost, kCount / 10);
  EXPECT_GT(found, kCount / 3);
}

/// The comparisons are of something: every type with values or samples, and what few materials have.
TEST(BsdfLanes, EverythingIsTried) {
  const Fixture& f = fixture();
  std::array<std::size_t, KB_MATERIAL_COUNT> values{}, samples{};
  std::size_t undecided = 0, transmitted = 0, crossing = 0, compensated = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    const KbMaterial& m = f.scene.materials[f.queries.material[i]];
    values[m.type] += f.answers[2][i] > 0;
    samples[m.type] += f.answers[kValueRows + 5][i] > 0;
    undecided += f.answers[kValueRows + 11][i] > 0;
    crossing += f.answers[kValueRows + 9][i] > 0;
    transmitted += f.answers[kValueRows + kSampleRows + 5][i] > 0;
    compensated += f.answers.back()[i] > 0 && f.answers[kValueRows + 5][i] > 0;
  }
  for (uint32_t type = 0; type < KB_MATERIAL_COUNT; ++type) {
    EXPECT_GT(samples[type], 2000u) << "type " << type;
    const bool has_values = has_smooth_lobe(material_of(static_cast<KbMaterialType>(type)));
    EXPECT_EQ(values[type] > 1000, has_values) << "type " << type;
  }
  for (const std::size_t number : {undecided, transmitted, crossing, compensated}) EXPECT_GT(number, 500u);
}

/// Records gathered from the scene's arrays against what is made of one material with pointers to its tables.
TEST(BsdfLanes, OneLaneIsTheInterfaceOfSinglePaths) {
  const Fixture& f = fixture();
  const LaneQueries& q = f.queries;
  std::size_t compared = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    const MaterialContext context = f.scene.context(q.material[i], q.channel_eta[i]);
    const KbMaterial& m = *context.material;
    const bool undecided = m.flags & KB_MATERIAL_DISPERSIVE && !(q.channel_eta[i] > 0);
    if (!q.active[i] || (undecided && m.type == KB_MATERIAL_ROUGH_DIELECTRIC)) continue;
    ++compared;
    const glm::vec3 wi(q.wi[0][i], q.wi[1][i], q.wi[2][i]), wo(q.wo[0][i], q.wo[1][i], q.wo[2][i]);
    const BsdfValue v = eval_bsdf(context, wi, wo);
    const BsdfSample s = sample_bsdf(context, wi, q.u_lobe[i], {q.u[0][i], q.u[1][i]});
    const float expected[kValueRows + kSampleRows] = {v.w0,
                                                      v.w1,
                                                      v.pdf,
                                                      float(v.lobe_b),
                                                      s.wo.x,
                                                      s.wo.y,
                                                      s.wo.z,
                                                      s.w0,
                                                      s.w1,
                                                      s.pdf,
                                                      s.eta,
                                                      s.bound,
                                                      float(s.delta),
                                                      float(s.transmission),
                                                      float(s.lobe_b),
                                                      float(s.needs_channel),
                                                      float(s.kind)};
    for (std::size_t row = 0; row < std::size(expected); ++row)
      ASSERT_EQ(kb_as_u32(f.answers[row][i]), kb_as_u32(expected[row])) << "row " << row << "; " << where(i);
  }
  EXPECT_GT(compared, kCount / 2);
}

}  // namespace
}  // namespace kiloband::test::test_lanes
