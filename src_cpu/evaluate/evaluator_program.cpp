#include "src_cpu/evaluate/evaluator_program.hpp"

#include <hwy/cache_control.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "shared/rough_transmission.h"

namespace kiloband::cpu {
namespace {

/// B = w0 S_a and nothing else that steps do not have. A light sample without a scattering event multiplies
/// P with what the next vertices must not have.
bool is_scaled(uint32_t head, bool last) {
  constexpr uint32_t kOther = KB_VERTEX_KIND_MASK | KB_VERTEX_DEGRADE | KB_VERTEX_DEFER;
  static_assert(KB_KIND_SCALED == 0);
  return !(head & kOther) && (last || (head & (KB_VERTEX_NEE | KB_VERTEX_SCATTER)) != KB_VERTEX_NEE);
}

bool is_plain(uint32_t head, bool last) {
  return !(head & KB_VERTEX_TEX_MASK) && is_scaled(head, last);
}

/// Of a vertex of any kind but KB_KIND_MEDIUM.
std::size_t sample_count(uint32_t head) {
  return static_cast<std::size_t>(std::popcount(head & KB_VERTEX_TEX_MASK));
}

/// A prefetch that stays: functions that do nothing else are taken for pure by GCC, which drops their calls.
void fetch(const KbFloat4* texel) {
  hwy::Prefetch(texel);
  asm volatile("");
}

/// Both rows of the texels of a lookup, with their right neighbours if these are in the texture.
void fetch_square(const KbFloat4* texels, const KbTexture& texture, uint32_t xy) {
  const uint32_t x = xy & 0xffffu, y = xy >> 16, below = std::min(y + 1, texture.height - 1);
  if (x >= texture.width || y >= texture.height) return;
  const uint32_t right = std::min(x + 1, texture.width - 1);
  for (const uint32_t row : {y, below}) {
    fetch(texels + std::size_t{row} * texture.width + x);
    fetch(texels + std::size_t{row} * texture.width + right);
  }
}

FresnelTerms fresnel_terms(float cosine) {
  FresnelTerms terms;
  const double c = std::fabs(static_cast<double>(cosine));
  terms.cosine = static_cast<float>(c);
  terms.cosine2_high = static_cast<float>(c * c);
  terms.cosine2_low = static_cast<float>(c * c - terms.cosine2_high);
  terms.sine2 = static_cast<float>(std::max(0.0, 1 - c * c));
  return terms;
}

}  // namespace

/// Pointers into these arrays must stay valid while the program is built.
void ProgramBuilder::reserve(std::size_t entries) {
  gas_.clear();
  survivor_ = kAll;
  scratch_.release();
  cells_.clear();
  if (steps_.size() < StepWriter::kMostSteps * entries) {
    const std::size_t room = std::max<std::size_t>(64, 2 * entries);
    steps_.resize(StepWriter::kMostSteps * room);
    gas_.reserve(room);
    cells_.reserve(5 * room);
  }
  writer_ = StepWriter(steps_.data());
}

/// The vertices from `first` on that refer to nothing but spectra, as most do. Returns where the first other one is.
inline std::size_t ProgramBuilder::add_plain(std::span<const KbPathVertex> entries, std::size_t first,
                                             DenseSpectra& spectra) {
  StepWriter writer = writer_;
  const DenseSpectra::Lookup spectrum = spectra.lookup();
  std::size_t i = first;
  for (; i < entries.size() && is_plain(entries[i].head, i + 1 == entries.size()); ++i) {
    const KbPathVertex& vertex = entries[i];
    const uint32_t head = vertex.head;
    if (head & KB_VERTEX_EMIT) writer.emit(spectrum(vertex.emit_row), vertex.emit_weight);
    if (!(head & (KB_VERTEX_NEE | KB_VERTEX_SCATTER))) continue;
    // Whether a light sample is there is as good as random: no branch.
    const bool nee = head & KB_VERTEX_NEE;
    const float* const light = spectrum(nee ? vertex.nee_row : vertex.row_a);
    writer.reflect(spectrum(vertex.row_a), nee ? light : writer.light(), nee ? vertex.nee0 : 0);
    writer.scatter(head & KB_VERTEX_SCATTER ? vertex.scatter0 : 1);
  }
  writer_ = writer;
  return i;
}

void ProgramBuilder::fetch_texels(std::span<const KbPathVertex> entries) const {
  for (std::size_t i = 0; i < entries.size();) {
    const uint32_t head = entries[i].head;
    const std::size_t samples = sample_count(head), next = i + 1 + kb_vertex_extensions(head);
    if (next > entries.size()) return;
    for (std::size_t n = 0; n < samples; ++n) {
      KbTextureSample sample;
      std::memcpy(&sample, reinterpret_cast<const char*>(&entries[i] + 1) + n * sizeof sample, sizeof sample);
      if (sample.texture >= scene_.textures.size()) continue;  // a temperature's, or none
      const KbTexture& t = scene_.textures[sample.texture];
      if ((t.flags & KB_TEXTURE_SPECTRAL) || colours_.has_rows(sample.texture)) continue;
      fetch_square(&scene_.texels[t.first_texel], t, sample.xy);
    }
    i = next;
  }
}

PathProgram ProgramBuilder::build(std::span<const KbPathVertex> entries, DenseSpectra& spectra) {
  reserve(entries.size());
  if (!entries.empty() && (entries.front().head & KB_VERTEX_NEGATIVE)) writer_.scatter(-1);
  for (std::size_t i = 0; (i = add_plain(entries, i, spectra)) < entries.size();) {
    const KbPathVertex& vertex = entries[i];
    const std::size_t next = i + 1 + kb_vertex_extensions(vertex.head);
    if (next > entries.size()) throw std::logic_error("saved path: texture samples or cells are missing");
    if ((vertex.head & KB_VERTEX_KIND_MASK) == KB_KIND_MEDIUM) {
      add_medium(vertex, &entries[i] + 1, spectra);
      i = next;
      continue;
    }
    const std::size_t samples = sample_count(vertex.head);
    KbTextureSample copies[4];
    if (samples > 0) std::memcpy(copies, &entries[i] + 1, samples * sizeof(KbTextureSample));
    add_vertex(vertex, factors(vertex, copies, spectra), next == entries.size(), spectra);
    i = next;
  }
  PathProgram program;
  program.steps = steps_.data();
  program.step_count = writer_.count();
  program.light = writer_.light();
  program.channels = spectra.channels();
  program.gas = !gas_.empty();
  return program;
}

ProgramBuilder::Factors ProgramBuilder::factors(const KbPathVertex& vertex, const KbTextureSample* samples,
                                                DenseSpectra& spectra) {
  const uint32_t head = vertex.head, kind = head & KB_VERTEX_KIND_MASK;
  const bool reflects = head & (KB_VERTEX_NEE | KB_VERTEX_SCATTER);
  const auto row = [&](uint32_t flag, bool used, uint32_t named, bool emission) -> const float* {
    const KbTextureSample* sample = head & flag ? samples++ : nullptr;
    if (!used) return nullptr;
    return sample ? texture(*sample, emission, spectra) : spectra.spectrum(named);
  };
  const bool two = kb_has_two_spectra(kind);
  Factors from;
  from.a = row(KB_VERTEX_TEX_A, reflects, vertex.row_a, false);
  from.b = row(KB_VERTEX_TEX_B, reflects && two, vertex.row_b, false);
  from.emit = row(KB_VERTEX_TEX_EMIT, head & KB_VERTEX_EMIT, vertex.emit_row, true);
  from.nee = row(KB_VERTEX_TEX_NEE, head & KB_VERTEX_NEE, vertex.nee_row, true);
  return from;
}

void ProgramBuilder::add_vertex(const KbPathVertex& vertex, Factors from, bool last, DenseSpectra& spectra) {
  const uint32_t head = vertex.head;
  const bool light = head & KB_VERTEX_NEE, scatters = head & KB_VERTEX_SCATTER;
  if (head & KB_VERTEX_EMIT) writer_.emit(from.emit, vertex.emit_weight);
  if (is_scaled(head, last)) {
    if (light)
      writer_.reflect(from.a, from.nee, vertex.nee0);
    else if (scatters)
      writer_.reflect(from.a);
    if (scatters) writer_.scatter(vertex.scatter0);
    return;
  }
  if ((light || scatters) && (head & KB_VERTEX_KIND_MASK) == KB_KIND_NONLINEAR) {
    float* const internal = scratch_.take();
    const ChannelRange range = needed(spectra);
    factors_.internal_row(material_of(vertex).escape, from.b, range.begin, range.end, internal);
    from.b = internal;
  }
  if (light) {
    const auto [row, weight] = product(vertex, from, vertex.nee0, vertex.nee1, spectra);
    if (head & KB_VERTEX_DEFER)
      add_deferred_light(row, weight, from.nee);
    else
      writer_.sample(row, weight, from.nee);
  }
  if (scatters) {
    const auto [row, weight] = product(vertex, from, vertex.scatter0, vertex.scatter1, spectra);
    writer_.reflect(row);
    writer_.scatter(weight);
  }
  if (!(head & KB_VERTEX_DEGRADE)) return;
  survivor_ = kb_surviving_channel(vertex.scatter1);
  writer_.keep_one(survivor_);
}

/// The vertices of the gas along the shadow ray follow.
void ProgramBuilder::add_deferred_light(const float* row, float weight, const float* light) {
  GasVertex& out = gas_.emplace_back();
  out.of = GasVertex::Of::kDeferredLight;
  out.a = row;
  out.emit = light;
  out.emit_weight = weight;
  writer_.gas(out);
}

const KbMaterial& ProgramBuilder::material_of(const KbPathVertex& vertex) const {
  const uint32_t material = vertex.head >> KB_VERTEX_MATERIAL_SHIFT;
  if (material >= scene_.materials.size()) throw std::logic_error("saved path: material does not exist");
  return scene_.materials[material];
}

ProgramBuilder::Product ProgramBuilder::product(const KbPathVertex& vertex, const Factors& from, float w0,
                                                float w1, DenseSpectra& spectra) {
  switch (vertex.head & KB_VERTEX_KIND_MASK) {
    case KB_KIND_TWO_TERM:
    case KB_KIND_NONLINEAR:
    case KB_KIND_TINTED:
      return {blend(from, w0, w1, spectra), 1};
    case KB_KIND_CONDUCTOR:
    case KB_KIND_DISPERSIVE:
      return {reflectance(vertex, from.a, w1, spectra), w0};
    case KB_KIND_ROUGH_TRANSMISSION:
      return {transmission(vertex, from.a, spectra), w0};
    default:
      return {from.a, w0};
  }
}

/// w0 S_a + w1 S_b, or KB_KIND_TINTED where there is no b.
const float* ProgramBuilder::blend(const Factors& from, float w0, float w1, const DenseSpectra& spectra) {
  float* const out = scratch_.take();
  const ChannelRange range = needed(spectra);
  if (!from.b) {
    factors_.tinted_row(w0, w1, from.a, range.begin, range.end, out);
    return out;
  }
  const float* const rows[] = {from.a + range.begin, from.b + range.begin};
  const float weights[] = {w0, w1};
  factors_.weighted_sum(rows, weights, 2, pad_channels(range.end - range.begin), out + range.begin);
  return out;
}

/// Gas along a ray. The cells get the near end's temperature in front.
void ProgramBuilder::add_medium(const KbPathVertex& vertex, const KbPathVertex* extensions,
                                DenseSpectra& spectra) {
  GasVertex& out = gas_.emplace_back();
  out.flags = vertex.head & (KB_VERTEX_EMIT | KB_VERTEX_NEE | KB_VERTEX_SCATTER | KB_VERTEX_DEFER);
  out.a = spectra.spectrum(vertex.row_a);
  if (out.flags & KB_VERTEX_EMIT) out.emit = spectra.spectrum(vertex.emit_row);
  out.emit_weight = vertex.emit_weight;
  out.nee0 = vertex.nee0;
  out.scatter0 = vertex.scatter0;
  const std::size_t count = vertex.head >> KB_VERTEX_MATERIAL_SHIFT;
  if (count > 0) {
    if (!(out.flags & KB_VERTEX_EMIT)) throw std::logic_error("saved path: a plume that does not emit");
    const std::size_t first = cells_.size();
    cells_.push_back({0, vertex.nee0});
    cells_.resize(first + 1 + count);
    std::memcpy(&cells_[first + 1], extensions, count * sizeof(KbPlumeCell));
    out.cells = std::span(cells_).subspan(first, count + 1);
    out.reference_k = vertex.nee1;
    out.second_k = spectra.planck_second();
  }
  writer_.gas(out);
}

const float* ProgramBuilder::reflectance(const KbPathVertex& vertex, const float* a, float cosine,
                                         DenseSpectra& spectra) {
  const KbMaterial& m = material_of(vertex);
  if (m.flags & KB_MATERIAL_PERFECT_MIRROR) return a;  // F = 1
  const uint32_t material = vertex.head >> KB_VERTEX_MATERIAL_SHIFT;
  FresnelTerms terms = fresnel_terms(cosine);
  if ((vertex.head & KB_VERTEX_KIND_MASK) == KB_KIND_CONDUCTOR) {
    const auto rows = spectra.conductor(material);
    terms.high = rows[0], terms.low = rows[1], terms.nk = rows[2];
  } else {
    const bool thin = m.flags & KB_MATERIAL_THIN;
    const auto rows = spectra.dispersive(material, cosine < 0 && !thin);
    using Of = FresnelTerms::Of;
    if (thin) terms.of = cosine < 0 ? Of::kPaneTransmittance : Of::kPaneReflectance;
    terms.high = rows[0], terms.low = rows[1];
  }
  float* const out = scratch_.take();
  const ChannelRange range = needed(spectra);
  factors_.fresnel_row(terms, a, range.begin, range.end, out);
  return out;
}

const float* ProgramBuilder::transmission(const KbPathVertex& vertex, const float* a, DenseSpectra& spectra) {
  const KbMaterial& m = material_of(vertex);
  const KbTransmissionPair pair = kb_transmission_pair(vertex);
  const float alpha_u = std::max(m.alpha_u, KB_MIN_ALPHA), alpha_v = std::max(m.alpha_v, KB_MIN_ALPHA);
  const auto rows = spectra.dispersive(vertex.head >> KB_VERTEX_MATERIAL_SHIFT, pair.inside != 0);
  const double cosine = double{pair.ix} * pair.ox + double{pair.iy} * pair.oy + double{pair.iz} * pair.oz;
  TransmissionTerms terms{rows[2],           rows[3], pair.ix + pair.ox, pair.iy + pair.oy,
                          pair.iz + pair.oz, pair.ox, pair.oy,           pair.oz};
  terms.cosine = static_cast<float>(cosine);
  terms.one_plus_cosine = static_cast<float>(1 + cosine);
  terms.inverse_alpha_u = 1 / alpha_u;
  terms.inverse_alpha_v = 1 / alpha_v;
  terms.norm = static_cast<float>(2 * (1 + 1 / (cosine * cosine)) / (double{KB_PI} * alpha_u * alpha_v));
  terms.ggx = (m.flags & KB_MATERIAL_GGX) != 0;
  float* const out = scratch_.take();
  const ChannelRange range = needed(spectra);
  factors_.transmission_row(terms, a, range.begin, range.end, out);
  return out;
}

ChannelRange ProgramBuilder::needed(const DenseSpectra& spectra) const {
  const std::size_t channels = spectra.channels();
  if (survivor_ >= channels) return {0, channels, false};
  const std::size_t begin = survivor_ / kRowPadding * kRowPadding;
  return {begin, std::min(channels, begin + kRowPadding), true};
}

/// An emissivity, a row or a lookup, times Planck's law at a temperature of its own.
const float* ProgramBuilder::thermal(const KbThermalSample& sample, DenseSpectra& spectra) {
  const uint32_t index = sample.source & KB_SAMPLE_INDEX_MASK;
  float* out = scratch_.take();
  if (sample.source & KB_SAMPLE_ROW) {
    spectra.fill_planck(sample.temperature_k, spectra.spectrum(index), out);
    return out;
  }
  if (index >= scene_.textures.size()) throw std::logic_error("saved path: texture does not exist");
  constexpr float kUnit = 1.0f / 65535;
  const KbTextureSample lookup{index, sample.xy, static_cast<float>(sample.fractions & 0xffffu) * kUnit,
                               static_cast<float>(sample.fractions >> 16) * kUnit};
  spectra.fill_planck(sample.temperature_k, nullptr, out);
  colours_.evaluate(index, TexelCorners(scene_.textures[index], lookup), out, spectra, needed(spectra), out);
  return out;
}

/// emission: the value stands for radiance, and its factor brings it to film units.
const float* ProgramBuilder::texture(const KbTextureSample& sample, bool emission, DenseSpectra& spectra) {
  if (emission && (sample.texture & KB_SAMPLE_THERMAL)) {
    KbThermalSample hot;
    std::memcpy(&hot, &sample, sizeof hot);
    return thermal(hot, spectra);
  }
  if (sample.texture >= scene_.textures.size()) throw std::logic_error("saved path: texture does not exist");
  const KbTexture& t = scene_.textures[sample.texture];
  float* const out = scratch_.take();
  if (t.flags & KB_TEXTURE_SPECTRAL) {
    spectral_.fill(sample, spectra, out);
    return out;
  }
  const float* factor = emission ? spectra.unit_emission() : nullptr;
  if (t.illuminant_row != KB_NONE) factor = spectra.spectrum(t.illuminant_row);
  return colours_.row(sample.texture, TexelCorners(t, sample), factor, spectra, needed(spectra), out);
}

}  // namespace kiloband::cpu
