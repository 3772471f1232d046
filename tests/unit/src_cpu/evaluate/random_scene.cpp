#include "random_scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "spectral/planck.hpp"

namespace kiloband::test {
namespace {

float uniform_float(std::mt19937& random, double low, double high) {
  return static_cast<float>(uniform(random, low, high));
}

bool chance(std::mt19937& random, double p) {
  return uniform(random, 0, 1) < p;
}

uint32_t below(std::mt19937& random, std::size_t n) {
  return static_cast<uint32_t>(random() % n);
}

// Rows of make_scene.
constexpr uint32_t kReflectances = 8, kFirstEmission = 8, kEmissions = 5, kFirstIndex = 13, kIndices = 6;
constexpr uint32_t kMaterials = 8;
constexpr uint32_t kKinds[] = {KB_KIND_SCALED,    KB_KIND_TWO_TERM,   KB_KIND_NONLINEAR,
                               KB_KIND_CONDUCTOR, KB_KIND_DISPERSIVE, KB_KIND_ROUGH_TRANSMISSION,
                               KB_KIND_TINTED};

/// Values in [low, high] around the hull of the channels; some tables end inside it.
RegularTable random_table(const Channel& range, double low, double high, bool extrapolate,
                          std::mt19937& random) {
  const double step = uniform(random, 0.003, 0.05) * range.width_nm();
  RegularTable out =
      table(range.min_nm - uniform(random, -0.1, 0.2) * range.width_nm(), step, {}, extrapolate);
  while (out.min_nm + step * static_cast<double>(out.values.size()) < range.max_nm + 0.1 * range.width_nm())
    out.values.push_back(uniform(random, low, high));
  return out;
}

void add_spectra(FlatScene& scene, const Channel& range, std::mt19937& random) {
  for (uint32_t s = 0; s < kReflectances; ++s)
    scene.spectra.push_back(row(random_table(range, 0.001, 1, s % 3 == 0, random)));
  for (uint32_t s = 0; s < kEmissions - 2; ++s)
    scene.spectra.push_back(row(random_table(range, 0.01, 1000, s % 2 == 0, random), true));
  for (double temperature : {900.0, 5800.0}) {
    SpectrumRow thermal;
    thermal.is_planck = thermal.is_emission = true;
    thermal.temperature_k = temperature;
    thermal.planck_scale = 0.5;
    if (temperature > 1000) thermal.planck_max_nm = 0.6 * range.max_nm + 0.4 * range.min_nm;
    scene.spectra.push_back(thermal);
  }
  const double bounds[kIndices][2] = {{0.02, 2}, {0, 8}, {1, 60}, {10, 100}, {1.3, 1.9}, {1.0, 1.2}};
  for (const auto& [low, high] : bounds)
    scene.spectra.push_back(row(random_table(range, low, high, true, random)));
}

void add_materials(FlatScene& scene) {
  const uint32_t pairs[kMaterials - 3][2] = {{0, 1}, {2, 3}, {5, 0}, {4, 5}, {4, KB_NONE}};
  for (const auto& [first, second] : pairs) {
    KbMaterial material{};
    material.eta_row = kFirstIndex + first;
    const bool metal = scene.materials.size() < 3;
    const uint32_t second_row = second == KB_NONE ? KB_NONE : kFirstIndex + second;
    material.k_row = metal ? second_row : KB_NONE;
    material.ext_row = metal ? KB_NONE : second_row;
    material.eta_ext = 1.000277f;
    if (scene.materials.size() % 2) material.flags |= KB_MATERIAL_GGX;
    // Rounding of a facet's slope s counts (s / alpha)^2 times in exp(-(s / alpha)^2): rough enough for 1e-5.
    material.alpha_u = 0.6f;
    material.alpha_v = 0.4f;
    scene.materials.push_back(material);
  }
  KbMaterial mirror{};
  mirror.flags = KB_MATERIAL_PERFECT_MIRROR;
  mirror.eta_row = mirror.k_row = KB_NONE;
  KbMaterial plastic{};
  plastic.escape = 0.404f;
  KbMaterial pane = scene.materials[3];
  pane.flags |= KB_MATERIAL_THIN;
  for (const KbMaterial& material : {mirror, plastic, pane}) scene.materials.push_back(material);
}

/// The parabola a ((x - x0) / 100)^2 + b, with terms far larger than their sum.
KbFloat4 random_texel(std::mt19937& random) {
  if (chance(random, 0.3)) return {0, 0, 1e10f, uniform_float(random, 0, 1)};
  const double a = uniform(random, -5, 5) * 1e-4, x0 = uniform(random, 350, 850) - KB_TEXTURE_CENTRE_NM,
               b = uniform(random, -2, 2);
  return {static_cast<float>(a), static_cast<float>(-2 * a * x0), static_cast<float>(a * x0 * x0 + b),
          uniform_float(random, 0.2, 1)};
}

void add_textures(FlatScene& scene, std::mt19937& random) {
  for (uint32_t t = 0; t < 6; ++t) {
    KbTexture texture{};
    const bool large = t == 1 || t == 4;  // more texels than have rows of their own, see ColourLookups
    texture.width = large ? 64 : 1 + below(random, 5);
    texture.height = large ? 40 : 1 + below(random, 5);
    texture.first_texel = static_cast<uint32_t>(scene.texels.size());
    texture.wrap = t % 3;
    texture.flags = t == 3 ? KB_TEXTURE_ENVMAP : 0;
    texture.illuminant_row = t >= 3 && t < 5 ? kFirstEmission : KB_NONE;
    for (uint32_t i = 0; i < texture.width * texture.height; ++i)
      scene.texels.push_back(random_texel(random));
    scene.textures.push_back(texture);
  }
}

void set_scales(FlatScene& scene) {
  for (const Channel& channel : scene.channels) {
    double peak = 0;
    for (const SpectrumRow& s : scene.spectra) {
      if (!s.is_emission) continue;
      const double lambda = channel.centre_nm();
      peak = std::max(peak, s.is_planck ? planck_radiance(lambda, s.temperature_k) : s.table(lambda));
    }
    scene.channel_scale.push_back(peak > 0 ? std::exp2(std::floor(std::log2(peak * channel.width_nm()))) : 1);
  }
}

/// A light sample or scattering event with directions about a facet of moderate slope: T is of order 1.
void make_transmission(const FlatScene& scene, KbPathVertex& v, std::mt19937& random) {
  const bool nee = chance(random, 0.5), inside = chance(random, 0.5);
  const KbMaterial& material = scene.materials[v.head >> KB_VERTEX_MATERIAL_SHIFT];
  const double ratio = scene.spectra[material.eta_row].table(scene.channels.front().centre_nm());
  const double e = inside ? 1 / ratio : ratio;
  const double x = uniform(random, -0.5, 0.5), y = uniform(random, -0.5, 0.5);
  const double limit = std::min(0.9, 0.9 * e), scale = limit / std::max(limit, std::hypot(x, y));
  v.head &= ~(KB_VERTEX_EMIT | KB_VERTEX_NEE | KB_VERTEX_SCATTER);
  v.head |= nee ? KB_VERTEX_NEE : KB_VERTEX_SCATTER;
  v.emit_weight = static_cast<float>(scale * x);
  (nee ? v.scatter0 : v.nee0) = static_cast<float>(scale * y);
  v.nee1 = static_cast<float>(-scale * x / e + uniform(random, -0.03, 0.03));
  v.scatter1 = static_cast<float>(-scale * y / e + uniform(random, -0.03, 0.03));
  v.row_b = inside;
}

/// Textured values are decided by the caller.
KbPathVertex random_vertex(const FlatScene& scene, std::mt19937& random) {
  KbPathVertex v{};
  const uint32_t kind = kKinds[below(random, std::size(kKinds))];
  uint32_t material = 6;
  if (kind == KB_KIND_CONDUCTOR) material = std::array<uint32_t, 4>{0, 1, 2, 5}[below(random, 4)];
  if (kind == KB_KIND_DISPERSIVE) material = std::array<uint32_t, 3>{3, 4, 7}[below(random, 3)];
  // Far from an index of 1, where wi + e wo cancels.
  if (kind == KB_KIND_ROUGH_TRANSMISSION) material = 4;
  v.head = kind | material << KB_VERTEX_MATERIAL_SHIFT;
  for (uint32_t flag : {KB_VERTEX_EMIT, KB_VERTEX_NEE, KB_VERTEX_SCATTER})
    if (chance(random, flag == KB_VERTEX_SCATTER ? 0.9 : 0.6)) v.head |= flag;
  v.row_a = static_cast<uint16_t>(below(random, kReflectances));
  v.row_b = static_cast<uint16_t>(below(random, kReflectances));
  v.emit_row = static_cast<uint16_t>(kFirstEmission + below(random, kEmissions));
  v.nee_row = static_cast<uint16_t>(kFirstEmission + below(random, kEmissions));
  v.emit_weight = uniform_float(random, 0.1, 1);
  v.nee0 = uniform_float(random, 0.1, 1.5);
  v.scatter0 = uniform_float(random, 0.5, 2);
  const bool angle = kind == KB_KIND_CONDUCTOR || kind == KB_KIND_DISPERSIVE;
  const double low = kind == KB_KIND_DISPERSIVE || kind == KB_KIND_TINTED ? -1 : angle ? 0 : 0.1;
  v.nee1 = uniform_float(random, low, 1);
  v.scatter1 = uniform_float(random, low, 1);
  if (kind == KB_KIND_SCALED && chance(random, 0.2)) {
    v.head |= KB_VERTEX_DEGRADE | KB_VERTEX_SCATTER;
    v.scatter1 = kb_channel_weight(below(random, scene.channels.size()));
  }
  if (kind == KB_KIND_ROUGH_TRANSMISSION) make_transmission(scene, v, random);
  return v;
}

/// An emissivity, of a reflectance's row or bitmap, at a temperature of its own.
KbTextureSample random_thermal_sample(const FlatScene& scene, std::mt19937& random) {
  const float temperature_k =
      chance(random, 0.1) ? 0 : static_cast<float>(std::exp(uniform(random, 5.3, 8.6)));
  KbThermalSample thermal{KB_SAMPLE_THERMAL | KB_SAMPLE_ROW | below(random, kReflectances), 0, 0,
                          temperature_k};
  if (chance(random, 0.5)) {
    const uint32_t t = below(random, 3);
    const uint32_t x = below(random, scene.textures[t].width), y = below(random, scene.textures[t].height);
    thermal = {KB_SAMPLE_THERMAL | t, x | y << 16, below(random, 65536) | below(random, 65536) << 16,
               temperature_k};
  }
  KbTextureSample sample;
  static_assert(sizeof sample == sizeof thermal);
  std::memcpy(&sample, &thermal, sizeof sample);
  return sample;
}

KbTextureSample random_sample(const FlatScene& scene, bool emission, std::mt19937& random) {
  if (emission && scene.features.temperature_field && chance(random, 0.5))
    return random_thermal_sample(scene, random);
  // Textures 0-2 are reflectances; 3-5 emit, the last without an illuminant; 6-11 the same, spectral.
  const uint32_t t = below(random, 3) + (emission ? 3 : 0) + (chance(random, 0.5) ? 6 : 0);
  const uint32_t x = below(random, scene.textures[t].width), y = below(random, scene.textures[t].height);
  const float fx = chance(random, 0.2) ? 0 : uniform_float(random, 0, 1);
  return {t, x | y << 16, fx, uniform_float(random, 0, 1)};
}

void add_vertex(const FlatScene& scene, PathBuffer& paths, std::mt19937& random) {
  KbPathVertex vertex = random_vertex(scene, random);
  KbTextureSample samples[4] = {};
  uint32_t count = 0;
  if (chance(random, 0.4)) {
    for (uint32_t flag = KB_VERTEX_TEX_A; flag <= KB_VERTEX_TEX_NEE; flag <<= 1) {
      if (!chance(random, 0.5)) continue;
      if ((vertex.head & KB_VERTEX_KIND_MASK) == KB_KIND_ROUGH_TRANSMISSION && flag != KB_VERTEX_TEX_A)
        continue;
      vertex.head |= flag;
      samples[count++] = random_sample(scene, flag >= KB_VERTEX_TEX_EMIT, random);
    }
  }
  paths.entries.push_back(vertex);
  const std::size_t first = paths.entries.size(), slots = (count + 1) / 2;
  paths.entries.resize(first + slots);
  if (slots > 0) std::memcpy(&paths.entries[first], samples, slots * sizeof(KbPathVertex));
}

}  // namespace

RegularTable table(double min_nm, double step_nm, std::vector<double> values, bool extrapolate) {
  RegularTable out;
  out.min_nm = min_nm;
  out.step_nm = step_nm;
  out.values = std::move(values);
  out.extrapolate = extrapolate;
  return out;
}

SpectrumRow row(RegularTable values, bool is_emission) {
  SpectrumRow out;
  out.table = std::move(values);
  out.is_emission = is_emission;
  return out;
}

ChannelList make_channels(std::size_t count, Layout layout, std::mt19937& random) {
  ChannelList channels;
  const double low = layout == Layout::kInfrared ? 3000 : 380;
  const double step = (layout == Layout::kInfrared ? 9000.0 : 400.0) / static_cast<double>(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double start = low + step * static_cast<double>(k);
    if (layout == Layout::kNarrow)
      channels.push_back({start, start + 0.1, {}});
    else if (layout == Layout::kOverlapping)
      channels.push_back({start, start + uniform(random, 0.1, 3.5 * step + 0.2), {}});
    else
      channels.push_back({start, low + step * static_cast<double>(k + 1), {}});
  }
  if (layout == Layout::kOverlapping) std::shuffle(channels.begin(), channels.end(), random);
  return channels;
}

FlatScene make_scene(const ChannelList& channels, std::mt19937& random) {
  FlatScene scene;
  scene.channels = channels;
  Channel range = channels.front();
  for (const Channel& c : channels)
    range = {std::min(range.min_nm, c.min_nm), std::max(range.max_nm, c.max_nm), {}};
  add_spectra(scene, range, random);
  add_materials(scene);
  add_textures(scene, random);
  add_spectral_textures(scene, range, kFirstEmission, random);
  set_scales(scene);
  return scene;
}

PathBuffer make_paths(const FlatScene& scene, std::size_t count, std::mt19937& random) {
  PathBuffer paths;
  for (uint32_t p = 0; p < count; ++p) {
    const uint32_t first = static_cast<uint32_t>(paths.entries.size());
    for (uint32_t v = 0, n = 1 + below(random, 8); v < n; ++v) add_vertex(scene, paths, random);
    paths.paths.push_back({first, static_cast<uint32_t>(paths.entries.size()) - first, p});
  }
  return paths;
}

DerivedChannels make_responses() {
  DerivedChannels derived;
  derived.names = {"smooth", "narrow", "continued", "elsewhere"};
  derived.responses = {table(380, 100, {0, 0.3, 1, 0.4, 0.1}), table(500, 2, {0, 1, 0}),
                       table(600, 10, {0.5, 1}, true), table(100, 10, {1, 1})};
  return derived;
}

std::vector<float> evaluate(const FlatScene& scene, const DerivedChannels& derived, const PathBuffer& paths,
                            Isa isa, double mu, bool shared) {
  Evaluator evaluator(scene, derived, isa);
  std::vector<float> sums(paths.paths.size() * evaluator.stride(), 0.0f);
  if (shared)
    evaluator.add_shared(paths, mu, FollowingRows(evaluator, sums));
  else
    evaluator.add_per_path(paths, std::vector<float>(paths.paths.size(), static_cast<float>(mu)),
                           FollowingRows(evaluator, sums));
  return sums;
}

std::vector<Isa> available_isas() {
  std::vector<Isa> isas;
  for (Isa isa : {Isa::kSse4, Isa::kAvx2, Isa::kAvx512})
    if (is_available(isa)) isas.push_back(isa);
  return isas;
}

}  // namespace kiloband::test
