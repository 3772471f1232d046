#include "src_cpu/evaluate/evaluator_program.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "shared/rough_transmission.h"

namespace kiloband::cpu {
namespace {

/// One term of a lookup. A flat texel is evaluated here, in double: S(1e10) is exactly 1.
void add_texel(TextureTerms& terms, double& constant, const KbFloat4& texel, double weight) {
  if (weight == 0) return;
  if (texel.x == 0 && texel.y == 0) {
    const double v = texel.z;
    constant += weight * texel.w * (0.5 + 0.5 * v / std::sqrt(1 + v * v));
    return;
  }
  const uint32_t i = terms.count++;
  terms.coefficients[i][0] = texel.x;
  terms.coefficients[i][1] = texel.y;
  terms.coefficients[i][2] = texel.z;
  terms.weights[i] = static_cast<float>(weight * texel.w);
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

/// Pointers into generals_ and textures_ must stay valid while the program is built.
void ProgramBuilder::reserve(std::size_t entries) {
  steps_.clear();
  generals_.clear();
  textures_.clear();
  textured_ = gas_ = false;
  spectral_.begin_path();
  scratch_used_ = 0;
  cells_.clear();
  if (generals_.capacity() >= entries) return;
  entries = std::max<std::size_t>(64, 2 * entries);
  steps_.reserve(2 * entries);
  generals_.reserve(entries);
  textures_.reserve(2 * entries);
  cells_.reserve(5 * entries);
}

PathProgram ProgramBuilder::build(std::span<const KbPathVertex> entries, DenseSpectra& spectra) {
  reserve(entries.size());
  for (std::size_t i = 0; i < entries.size();) {
    const KbPathVertex& vertex = entries[i];
    const std::size_t next = i + 1 + kb_vertex_extensions(vertex.head);
    if (next > entries.size()) throw std::logic_error("saved path: texture samples or cells are missing");
    if ((vertex.head & KB_VERTEX_KIND_MASK) == KB_KIND_MEDIUM) {
      add_medium(vertex, &entries[i] + 1, spectra);
      i = next;
      continue;
    }
    const std::size_t samples = static_cast<std::size_t>(std::popcount(vertex.head & KB_VERTEX_TEX_MASK));
    KbTextureSample copies[4];
    if (samples > 0) std::memcpy(copies, &entries[i] + 1, samples * sizeof(KbTextureSample));
    add_vertex(vertex, sources(vertex, copies, spectra), next == entries.size(), spectra);
    i = next;
  }
  PathProgram program;
  program.steps = steps_.data();
  program.step_count = steps_.size();
  program.channels = spectra.channels();
  program.gas = gas_;
  program.texture_lambda = textured_ ? spectra.texture_lambda() : nullptr;
  return program;
}

ProgramBuilder::Sources ProgramBuilder::sources(const KbPathVertex& vertex, const KbTextureSample* samples,
                                                DenseSpectra& spectra) {
  const uint32_t head = vertex.head, kind = head & KB_VERTEX_KIND_MASK;
  const bool reflects = head & (KB_VERTEX_NEE | KB_VERTEX_SCATTER);
  const auto source = [&](uint32_t flag, bool used, uint32_t row, bool emission) -> SpectralSource {
    if (head & flag) return texture(*samples++, emission, spectra);
    return {used ? spectra.spectrum(row) : nullptr, nullptr};
  };
  const bool two = kind == KB_KIND_TWO_TERM || kind == KB_KIND_NONLINEAR;
  Sources from;
  from.a = source(KB_VERTEX_TEX_A, reflects, vertex.row_a, false);
  from.b = source(KB_VERTEX_TEX_B, reflects && two, vertex.row_b, false);
  from.emit = source(KB_VERTEX_TEX_EMIT, head & KB_VERTEX_EMIT, vertex.emit_row, true);
  from.nee = source(KB_VERTEX_TEX_NEE, head & KB_VERTEX_NEE, vertex.nee_row, true);
  return from;
}

void ProgramBuilder::add_vertex(const KbPathVertex& vertex, const Sources& from, bool last,
                                DenseSpectra& spectra) {
  const uint32_t head = vertex.head;
  if ((head & KB_VERTEX_EMIT) && !from.emit.texture)
    steps_.push_back({StepKind::kEmit, vertex.emit_weight, 0, nullptr, from.emit.row, nullptr});
  const bool nee = head & KB_VERTEX_NEE;
  const bool scatter = head & KB_VERTEX_SCATTER;
  if ((head & (KB_VERTEX_DEGRADE | KB_VERTEX_DEFER)) || from.any_colour() ||
      (head & KB_VERTEX_KIND_MASK) != KB_KIND_SCALED || (nee && !scatter && !last)) {
    add_general(vertex, from, spectra);
    return;
  }
  if (!nee && !scatter) return;
  // No light sample: a row of zeros costs less than a branch.
  // After the last vertex nobody reads the throughput.
  steps_.push_back({StepKind::kScaled, nee ? vertex.nee0 : 0, scatter ? vertex.scatter0 : 0, from.a.row,
                    nee ? from.nee.row : spectra.zeros(), nullptr});
}

void ProgramBuilder::add_general(const KbPathVertex& vertex, const Sources& from, DenseSpectra& spectra) {
  const uint32_t head = vertex.head;
  const uint32_t material = head >> KB_VERTEX_MATERIAL_SHIFT;
  GeneralVertex& out = generals_.emplace_back();
  out.kind = head & KB_VERTEX_KIND_MASK;
  out.flags = head & (KB_VERTEX_NEE | KB_VERTEX_SCATTER | KB_VERTEX_DEGRADE | KB_VERTEX_DEFER);
  if (from.emit.texture) out.flags |= head & KB_VERTEX_EMIT;
  out.emit_weight = vertex.emit_weight;
  out.nee0 = vertex.nee0;
  out.nee1 = vertex.nee1;
  out.scatter0 = vertex.scatter0;
  out.scatter1 = vertex.scatter1;
  if (head & KB_VERTEX_DEGRADE) out.survivor = kb_as_u32(vertex.scatter1);
  out.a = from.a;
  out.b = from.b;
  out.emit = from.emit;
  out.nee = from.nee;

  const bool reflects = head & (KB_VERTEX_NEE | KB_VERTEX_SCATTER);
  if (reflects && out.kind == KB_KIND_NONLINEAR) {
    if (material >= scene_.materials.size()) throw std::logic_error("saved path: material does not exist");
    out.fdr_int = scene_.materials[material].fdr_int;
  }
  if (reflects && (out.kind == KB_KIND_CONDUCTOR || out.kind == KB_KIND_DISPERSIVE))
    add_fresnel(out, material, spectra);
  if (reflects && out.kind == KB_KIND_ROUGH_TRANSMISSION) add_transmission(out, vertex, spectra);
  steps_.push_back({StepKind::kGeneral, 0, 0, nullptr, nullptr, &out});
}

/// Gas along a ray. The cells get the near end's temperature in front.
void ProgramBuilder::add_medium(const KbPathVertex& vertex, const KbPathVertex* extensions,
                                DenseSpectra& spectra) {
  GeneralVertex& out = generals_.emplace_back();
  out.kind = KB_KIND_MEDIUM;
  out.flags = vertex.head & (KB_VERTEX_EMIT | KB_VERTEX_NEE | KB_VERTEX_SCATTER | KB_VERTEX_DEFER);
  out.a.row = spectra.spectrum(vertex.row_a);
  if (out.flags & KB_VERTEX_EMIT) out.emit.row = spectra.spectrum(vertex.emit_row);
  out.emit_weight = vertex.emit_weight;
  out.nee0 = vertex.nee0;
  out.scatter0 = vertex.scatter0;
  gas_ = true;
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
  steps_.push_back({StepKind::kGeneral, 0, 0, nullptr, nullptr, &out});
}

void ProgramBuilder::add_fresnel(GeneralVertex& out, uint32_t material, DenseSpectra& spectra) const {
  if (material >= scene_.materials.size()) throw std::logic_error("saved path: material does not exist");
  if (scene_.materials[material].flags & KB_MATERIAL_PERFECT_MIRROR) {
    out.kind = KB_KIND_SCALED;  // F = 1
    return;
  }
  const auto side = [&](float cosine) {
    FresnelTerms terms = fresnel_terms(cosine);
    if (out.kind == KB_KIND_CONDUCTOR) {
      const auto rows = spectra.conductor(material);
      terms.high = rows[0], terms.low = rows[1], terms.nk = rows[2];
    } else {
      const bool thin = scene_.materials[material].flags & KB_MATERIAL_THIN;
      const auto rows = spectra.dispersive(material, cosine < 0 && !thin);
      using Of = FresnelTerms::Of;
      if (thin) terms.of = cosine < 0 ? Of::kPaneTransmittance : Of::kPaneReflectance;
      terms.high = rows[0], terms.low = rows[1];
    }
    return terms;
  };
  if (out.flags & KB_VERTEX_NEE) out.nee_fresnel = side(out.nee1);
  if (out.flags & KB_VERTEX_SCATTER) out.scatter_fresnel = side(out.scatter1);
}

void ProgramBuilder::add_transmission(GeneralVertex& out, const KbPathVertex& vertex,
                                      DenseSpectra& spectra) const {
  const uint32_t material = vertex.head >> KB_VERTEX_MATERIAL_SHIFT;
  if (material >= scene_.materials.size()) throw std::logic_error("saved path: material does not exist");
  const KbMaterial& m = scene_.materials[material];
  const KbTransmissionPair pair = kb_transmission_pair(vertex);
  const float alpha_u = std::max(m.alpha_u, KB_MIN_ALPHA), alpha_v = std::max(m.alpha_v, KB_MIN_ALPHA);
  const auto rows = spectra.dispersive(material, pair.inside != 0);
  const double cosine = double{pair.ix} * pair.ox + double{pair.iy} * pair.oy + double{pair.iz} * pair.oz;
  out.transmission = {rows[0],           rows[1], pair.ix + pair.ox, pair.iy + pair.oy,
                      pair.iz + pair.oz, pair.ox, pair.oy,           pair.oz};
  out.transmission.cosine = static_cast<float>(cosine);
  out.transmission.one_plus_cosine = static_cast<float>(1 + cosine);
  out.transmission.inverse_alpha_u = 1 / alpha_u;
  out.transmission.inverse_alpha_v = 1 / alpha_v;
  out.transmission.norm = KB_INV_PI / (alpha_u * alpha_v);
  out.transmission.ggx = (m.flags & KB_MATERIAL_GGX) != 0;
}

/// corners: of texels of colours.
void ProgramBuilder::add_texels(TextureTerms& terms, uint32_t texture, const TexelCorners& corners) const {
  const std::size_t first = scene_.textures[texture].first_texel;
  double constant = 0;
  for (int c = 0; c < 4; ++c)
    add_texel(terms, constant, scene_.texels[first + corners.texel[c]], corners.weight[c]);
  terms.constant = static_cast<float>(constant);
}

float* ProgramBuilder::scratch_row(const DenseSpectra& spectra) {
  if (scratch_used_ == scratch_.size()) scratch_.push_back(aligned_zeros<float>(spectra.padded_channels()));
  return scratch_[scratch_used_++].get();
}

/// An emissivity, a row or a lookup, times Planck's law at a temperature of its own.
SpectralSource ProgramBuilder::thermal(const KbThermalSample& sample, DenseSpectra& spectra) {
  const uint32_t index = sample.source & KB_SAMPLE_INDEX_MASK;
  float* factor = scratch_row(spectra);
  if (sample.source & KB_SAMPLE_ROW) {
    spectra.fill_planck(sample.temperature_k, spectra.spectrum(index), factor);
    return {factor, nullptr};
  }
  if (index >= scene_.textures.size()) throw std::logic_error("saved path: texture does not exist");
  constexpr float kUnit = 1.0f / 65535;
  const KbTextureSample lookup{index, sample.xy, static_cast<float>(sample.fractions & 0xffffu) * kUnit,
                               static_cast<float>(sample.fractions >> 16) * kUnit};
  TextureTerms& terms = textures_.emplace_back();
  add_texels(terms, index, TexelCorners(scene_.textures[index], lookup));
  spectra.fill_planck(sample.temperature_k, nullptr, factor);
  terms.factor = factor;
  textured_ |= terms.count > 0;
  return {nullptr, &terms};
}

/// emission: the value stands for radiance, and its factor brings it to film units.
SpectralSource ProgramBuilder::texture(const KbTextureSample& sample, bool emission, DenseSpectra& spectra) {
  if (emission && (sample.texture & KB_SAMPLE_THERMAL)) {
    KbThermalSample hot;
    std::memcpy(&hot, &sample, sizeof hot);
    return thermal(hot, spectra);
  }
  if (sample.texture >= scene_.textures.size()) throw std::logic_error("saved path: texture does not exist");
  const KbTexture& t = scene_.textures[sample.texture];
  if (t.flags & KB_TEXTURE_SPECTRAL) return {spectral_.row(sample, spectra), nullptr};
  TextureTerms& terms = textures_.emplace_back();
  add_texels(terms, sample.texture, TexelCorners(t, sample));
  if (t.illuminant_row != KB_NONE)
    terms.factor = spectra.spectrum(t.illuminant_row);
  else if (emission)
    terms.factor = spectra.unit_emission();
  textured_ |= terms.count > 0;
  return {nullptr, &terms};
}

}  // namespace kiloband::cpu
