#include "probe.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <tuple>

#include "scene/optics/coating.hpp"
#include "scene/optics/compensation.hpp"
#include "tests/support/opencl_probe.hpp"

namespace kiloband::test {
namespace {

constexpr const char* kSource = R"(
#include "bsdf/bsdf.clh"
typedef struct { float wi[3], wo[3], u_lobe, u[2], dispersion_eta, probability; kb_u32 material; } Query;
typedef struct { float w0, w1, pdf; kb_u32 lobe_b; } Value;
typedef struct { float wo[3], w0, w1, pdf, eta, bound; kb_u32 flags, kind; } Sample;

static inline float3 vector_of(__global const float* v) { return (float3)(v[0], v[1], v[2]); }
static inline MaterialContext context_of(__global const KbMaterial* materials, __global const float* tables,
                                         __global const Query* query) {
  MaterialContext context;
  context.material = materials[query->material];
  context.table = context.material.table == KB_NONE ? 0 : tables + context.material.table;
  context.dispersion_eta = query->dispersion_eta;
#if KB_HAS_PRINCIPLED
  read_principled_numbers(&context);
  set_principled_alpha(&context);
#endif
#if KB_HAS_COMPENSATION
  context.compensation = compensation_table(&context.material, context.table);
#endif
  return context;
}
static inline Sample record_of(BsdfSample s) {
  Sample r;
  r.wo[0] = s.wo.x; r.wo[1] = s.wo.y; r.wo[2] = s.wo.z;
  r.w0 = s.w0; r.w1 = s.w1; r.pdf = s.pdf; r.eta = s.eta; r.bound = s.bound;
  r.flags = (s.delta ? 1 : 0) | (s.transmission ? 2 : 0) | (s.lobe_b ? 4 : 0) | (s.needs_channel ? 8 : 0);
  r.kind = s.kind;
  return r;
}
__kernel void ask(__global const KbMaterial* materials, __global const float* tables, __global const Query* queries,
                  __global Value* values, __global Sample* samples, __global kb_u32* kinds) {
  const size_t i = get_global_id(0);
  const MaterialContext context = context_of(materials, tables, queries + i);
  const float3 wi = vector_of(queries[i].wi);
  const BsdfValue v = eval_bsdf(&context, wi, vector_of(queries[i].wo));
  values[i].w0 = v.w0; values[i].w1 = v.w1; values[i].pdf = v.pdf; values[i].lobe_b = v.lobe_b;
  samples[i] = record_of(sample_bsdf(&context, wi, queries[i].u_lobe, (float2)(queries[i].u[0], queries[i].u[1])));
  kinds[i] = eval_kind(&context.material) | (has_smooth_lobe(&context.material) ? 256u : 0u);
}
__kernel void transmit(__global const KbMaterial* materials, __global const Query* queries, __global Sample* samples) {
  const size_t i = get_global_id(0);
  const KbMaterial material = materials[queries[i].material];
  samples[i] = record_of(transmit_dispersive(&material, vector_of(queries[i].wi), queries[i].dispersion_eta,
                                             queries[i].probability));
}
__kernel void look_up(__global const float* table, kb_u32 has_table, __global const float* cosines,
                      __global float* bounds, __global float* transmittances) {
  const size_t i = get_global_id(0);
  bounds[i] = kb_conductor_bound(has_table ? table : 0, cosines[i]);
  transmittances[i] = has_table ? kb_coat_transmittance(table, cosines[i]) : 0.0f;
}
)";

/// Programs are compiled once per set of options: PoCL takes a second.
OpenclProbe& program(const std::string& options) {
  static std::vector<std::pair<std::string, std::unique_ptr<OpenclProbe>>> programs;
  for (auto& [known, probe] : programs)
    if (known == options) return *probe;
  programs.emplace_back(options, std::make_unique<OpenclProbe>(kSource, options));
  return *programs.back().second;
}

glm::vec3 vector_of(const float* v) {
  return {v[0], v[1], v[2]};
}

}  // namespace

Lookups lookups_on_device(const std::vector<float>& table, const std::vector<float>& cosines) {
  OpenclProbe& probe = program("");
  const std::size_t n = cosines.size();
  const cl::Buffer nodes = probe.upload(table), asked = probe.upload(cosines);
  const cl::Buffer bounds = probe.upload(cosines), transmittances = probe.upload(cosines);
  probe.run("look_up", n, nodes, cl_uint(!table.empty()), asked, bounds, transmittances);
  return {probe.download<float>(bounds, n), probe.download<float>(transmittances, n)};
}

uint32_t Scene::add(const KbMaterial& given) {
  KbMaterial material = given;
  material.table = KB_NONE;
  if (material.type == KB_MATERIAL_ROUGH_PLASTIC) {
    static std::map<std::tuple<uint32_t, float, float>, Coating> made;
    const auto key = std::make_tuple(material.flags & KB_MATERIAL_GGX, material.alpha_u, material.eta);
    if (!made.count(key)) made[key] = make_coating(material);
    const Coating& coating = made[key];
    material.escape = static_cast<float>(1 - coating.internal_reflectance);
    material.table = static_cast<uint32_t>(tables_.size());
    tables_.insert(tables_.end(), coating.transmittance.begin(), coating.transmittance.end());
  }
  if (material.flags & KB_MATERIAL_COMPENSATED) {
    if (material.table == KB_NONE) material.table = static_cast<uint32_t>(tables_.size());
    const uint32_t before = kb_floats_before_compensation(material.type, material.flags);
    tables_.resize(material.table + before, 1.0f);
    const bool dispersive = material.flags & KB_MATERIAL_DISPERSIVE;
    const std::vector<float> table =
        make_compensation_table(material, {material.eta, dispersive ? 1.3 * material.eta : material.eta});
    tables_.insert(tables_.end(), table.begin(), table.end());
  }
  materials_.push_back(material);
  return static_cast<uint32_t>(materials_.size() - 1);
}

uint32_t Scene::add(const PrincipledExample& example) {
  const uint32_t index = add_without_table(principled_material(example));
  materials_[index].table = static_cast<uint32_t>(tables_.size());
  tables_.insert(tables_.end(), example.numbers.begin(), example.numbers.end());
  return index;
}

uint32_t Scene::add_without_table(KbMaterial material) {
  material.table = KB_NONE;
  materials_.push_back(material);
  return static_cast<uint32_t>(materials_.size() - 1);
}

MaterialContext Scene::context(const Query& query) const {
  const KbMaterial& material = materials_[query.material];
  const float* table = material.table == KB_NONE ? nullptr : &tables_[material.table];
  const bool compensated = material.flags & KB_MATERIAL_COMPENSATED;
  return {&material,
          table,
          {query.dispersion_eta},
          compensated ? table + kb_floats_before_compensation(material.type, material.flags) : nullptr};
}

Sample record_of(const BsdfSample& s) {
  const uint32_t flags = (s.delta ? kDelta : 0u) | (s.transmission ? kTransmission : 0u) |
                         (s.lobe_b ? kLobeB : 0u) | (s.needs_channel ? kNeedsChannel : 0u);
  return {{s.wo.x, s.wo.y, s.wo.z}, s.w0, s.w1, s.pdf, s.eta, s.bound, flags, s.kind};
}

Answers Scene::on_cpu(const std::vector<Query>& queries) const {
  Answers answers;
  for (const Query& q : queries) {
    const glm::vec3 wi = vector_of(q.wi);
    const BsdfValue v = eval_bsdf(context(q), wi, vector_of(q.wo));
    answers.values.push_back({v.w0, v.w1, v.pdf, v.lobe_b});
    answers.samples.push_back(record_of(sample_bsdf(context(q), wi, q.u_lobe, {q.u[0], q.u[1]})));
    const KbMaterial& m = materials_[q.material];
    answers.kinds.push_back(eval_kind(m) | (has_smooth_lobe(m) ? 256u : 0u));
    answers.transmitted.push_back(record_of(transmit_dispersive(m, wi, q.dispersion_eta, q.probability)));
  }
  return answers;
}

Answers Scene::on_device(const std::vector<Query>& queries, const std::string& options) const {
  OpenclProbe& probe = program(options);
  const std::size_t n = queries.size();
  const cl::Buffer materials = probe.upload(materials_), tables = probe.upload(tables_);
  const cl::Buffer asked = probe.upload(queries);
  const cl::Buffer values = probe.upload(std::vector<Value>(n)),
                   samples = probe.upload(std::vector<Sample>(n));
  const cl::Buffer transmitted = probe.upload(std::vector<Sample>(n));
  const cl::Buffer kinds = probe.upload(std::vector<uint32_t>(n));
  probe.run("ask", n, materials, tables, asked, values, samples, kinds);
  probe.run("transmit", n, materials, asked, transmitted);
  return {probe.download<Value>(values, n), probe.download<Sample>(samples, n),
          probe.download<Sample>(transmitted, n), probe.download<uint32_t>(kinds, n)};
}

float Uniform::operator()() {
  uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<float>((z ^ (z >> 31)) >> 40) * 0x1p-24f;
}

glm::vec3 Uniform::direction() {
  const bool grazing = (*this)() < 0.25f;
  double z = 2.0 * (*this)() - 1;
  if (grazing) z *= 0.01;
  const double phi = 2 * M_PI * (*this)(), r = std::sqrt(1 - z * z);
  return glm::vec3(r * std::cos(phi), r * std::sin(phi), z);
}

KbMaterial material_of(KbMaterialType type, float eta) {
  KbMaterial m{};
  m.type = type;
  m.flags = KB_MATERIAL_SAMPLE_VISIBLE;
  m.eta = eta;
  m.alpha_u = m.alpha_v = 0.1f;
  m.escape = 0.4f;
  m.specular_weight = 0.6f;
  m.bound_a = 0.9f;
  m.bound_b = 0.8f;
  return m;
}

KbMaterial rough(KbMaterialType type, uint32_t distribution, float alpha_u, float alpha_v, bool visible,
                 float eta) {
  KbMaterial m = material_of(type, eta);
  m.flags |= distribution;
  m.alpha_u = alpha_u;
  m.alpha_v = alpha_v;
  if (!visible) m.flags &= ~KB_MATERIAL_SAMPLE_VISIBLE;
  return m;
}

std::string describe(const KbMaterial& m) {
  return fmt::format("type {} {} alpha {} x {} eta {} flags {}", m.type,
                     (m.flags & KB_MATERIAL_GGX) ? "ggx" : "beckmann", m.alpha_u, m.alpha_v, m.eta, m.flags);
}

std::vector<KbMaterial> every_material() {
  std::vector<KbMaterial> all{material_of(KB_MATERIAL_DIFFUSE), material_of(KB_MATERIAL_CONDUCTOR)};
  for (const float eta : {1.5f, 1.0003f, 0.7f, 1.0f})
    for (const KbMaterialType type : {KB_MATERIAL_DIELECTRIC, KB_MATERIAL_PLASTIC})
      all.push_back(material_of(type, eta));
  for (const float eta : {1.5f, 1.0003f, 0.7f, 1.0f}) {
    all.push_back(material_of(KB_MATERIAL_DIELECTRIC, eta));
    all.back().flags |= KB_MATERIAL_THIN;
  }
  for (const uint32_t distribution : {0u, KB_MATERIAL_GGX})
    for (const bool visible : {true, false})
      for (const auto& [u, v] : {std::pair{1e-4f, 1e-4f}, {0.05f, 0.05f}, {0.5f, 0.5f}, {0.1f, 0.4f}}) {
        all.push_back(rough(KB_MATERIAL_ROUGH_CONDUCTOR, distribution, u, v, visible));
        for (const float eta : {1.5f, 1.0003f, 0.7f, 1.0f})
          all.push_back(rough(KB_MATERIAL_ROUGH_DIELECTRIC, distribution, u, v, visible, eta));
        for (const float eta : {1.5f, 1.1f})
          all.push_back(rough(KB_MATERIAL_ROUGH_PLASTIC, distribution, u, v, visible, eta));
      }
  for (const KbMaterialType type : {KB_MATERIAL_CONDUCTOR, KB_MATERIAL_ROUGH_CONDUCTOR}) {
    all.push_back(material_of(type));
    all.back().flags |= KB_MATERIAL_PERFECT_MIRROR;
  }
  for (const KbMaterialType type : {KB_MATERIAL_PLASTIC, KB_MATERIAL_ROUGH_PLASTIC}) {
    all.push_back(material_of(type));
    all.back().flags |= KB_MATERIAL_NONLINEAR;
  }
  return all;
}

}  // namespace kiloband::test
