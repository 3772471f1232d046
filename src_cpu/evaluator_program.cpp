#include "src_cpu/evaluator_program.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace kiloband {
namespace {

uint32_t wrap_texel(uint32_t i, uint32_t size, uint32_t wrap) {
  if (i < size) return i;
  if (wrap == KB_WRAP_REPEAT) return i % size;
  if (wrap == KB_WRAP_CLAMP) return size - 1;
  const uint32_t j = i % (2 * size);
  return j < size ? j : 2 * size - 1 - j;
}

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
void ProgramBuilder::reserve(std::size_t slots) {
  steps_.clear();
  generals_.clear();
  textures_.clear();
  cells_.clear();
  textured_ = gas_ = false;
  if (generals_.capacity() >= slots) return;
  slots = std::max<std::size_t>(64, 2 * slots);
  steps_.reserve(2 * slots);
  generals_.reserve(slots);
  textures_.reserve(2 * slots);
  cells_.reserve(5 * slots);
}

PathProgram ProgramBuilder::build(std::span<const KbPathVertex> slots, DenseSpectra& spectra) {
  reserve(slots.size());
  for (std::size_t i = 0; i < slots.size();) {
    const KbPathVertex& vertex = slots[i];
    const std::size_t next = i + 1 + kb_vertex_extensions(vertex.head);
    if (next > slots.size()) throw std::logic_error("saved path: texture samples or cells are missing");
    if ((vertex.head & KB_VERTEX_KIND_MASK) == KB_KIND_MEDIUM) {
      add_medium(vertex, &slots[i] + 1, spectra);
      i = next;
      continue;
    }
    const std::size_t samples = static_cast<std::size_t>(std::popcount(vertex.head & KB_VERTEX_TEX_MASK));
    KbTextureSample copies[4];
    if (samples > 0) std::memcpy(copies, &slots[i] + 1, samples * sizeof(KbTextureSample));
    add_vertex(vertex, copies, next == slots.size(), spectra);
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

void ProgramBuilder::add_vertex(const KbPathVertex& vertex, const KbTextureSample* samples, bool last,
                                DenseSpectra& spectra) {
  const uint32_t head = vertex.head;
  if ((head & (KB_VERTEX_EMIT | KB_VERTEX_TEX_EMIT)) == KB_VERTEX_EMIT) {
    steps_.push_back(
        {StepKind::kEmit, vertex.emit_weight, 0, nullptr, spectra.spectrum(vertex.emit_row), nullptr});
  }
  const bool nee = head & KB_VERTEX_NEE;
  const bool scatter = head & KB_VERTEX_SCATTER;
  if ((head & (KB_VERTEX_DEGRADE | KB_VERTEX_DEFER | KB_VERTEX_TEX_MASK)) ||
      (head & KB_VERTEX_KIND_MASK) != KB_KIND_SCALED || (nee && !scatter && !last)) {
    add_general(vertex, samples, spectra);
    return;
  }
  if (!nee && !scatter) return;
  // No light sample: a row of zeros costs less than a branch. After the last vertex nobody reads the
  // throughput.
  steps_.push_back({StepKind::kScaled, nee ? vertex.nee0 : 0, scatter ? vertex.scatter0 : 0,
                    spectra.spectrum(vertex.row_a), nee ? spectra.spectrum(vertex.nee_row) : spectra.zeros(),
                    nullptr});
}

void ProgramBuilder::add_general(const KbPathVertex& vertex, const KbTextureSample* samples,
                                 DenseSpectra& spectra) {
  const uint32_t head = vertex.head;
  const uint32_t material = head >> KB_VERTEX_MATERIAL_SHIFT;
  GeneralVertex& out = generals_.emplace_back();
  out.kind = head & KB_VERTEX_KIND_MASK;
  out.flags = head & (KB_VERTEX_NEE | KB_VERTEX_SCATTER | KB_VERTEX_DEGRADE | KB_VERTEX_DEFER);
  out.emit_weight = vertex.emit_weight;
  out.nee0 = vertex.nee0;
  out.nee1 = vertex.nee1;
  out.scatter0 = vertex.scatter0;
  out.scatter1 = vertex.scatter1;
  if (head & KB_VERTEX_DEGRADE) out.survivor = kb_as_u32(vertex.scatter1);

  const bool reflects = head & (KB_VERTEX_NEE | KB_VERTEX_SCATTER);
  const bool two = out.kind == KB_KIND_TWO_TERM || out.kind == KB_KIND_NONLINEAR;
  if (head & KB_VERTEX_TEX_A)
    out.a.texture = texture(*samples++, false, spectra);
  else if (reflects)
    out.a.row = spectra.spectrum(vertex.row_a);
  if (head & KB_VERTEX_TEX_B)
    out.b.texture = texture(*samples++, false, spectra);
  else if (reflects && two)
    out.b.row = spectra.spectrum(vertex.row_b);
  if (head & KB_VERTEX_TEX_EMIT) {
    out.emit.texture = texture(*samples++, true, spectra);
    out.flags |= head & KB_VERTEX_EMIT;
  }
  if (head & KB_VERTEX_TEX_NEE)
    out.nee.texture = texture(*samples++, true, spectra);
  else if (head & KB_VERTEX_NEE)
    out.nee.row = spectra.spectrum(vertex.nee_row);

  if (reflects && out.kind == KB_KIND_NONLINEAR) {
    if (material >= scene_.materials.size()) throw std::logic_error("saved path: material does not exist");
    out.fdr_int = scene_.materials[material].fdr_int;
  }
  if (reflects && (out.kind == KB_KIND_CONDUCTOR || out.kind == KB_KIND_DISPERSIVE))
    add_fresnel(out, material, spectra);
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
      const auto rows = spectra.dispersive(material, cosine < 0);
      terms.high = rows[0], terms.low = rows[1];
    }
    return terms;
  };
  if (out.flags & KB_VERTEX_NEE) out.nee_fresnel = side(out.nee1);
  if (out.flags & KB_VERTEX_SCATTER) out.scatter_fresnel = side(out.scatter1);
}

/// emission: the value stands for radiance, and its factor brings it to film units.
const TextureTerms* ProgramBuilder::texture(const KbTextureSample& sample, bool emission,
                                            DenseSpectra& spectra) {
  if (sample.texture >= scene_.textures.size()) throw std::logic_error("saved path: texture does not exist");
  const KbTexture& t = scene_.textures[sample.texture];
  const bool environment = t.flags & KB_TEXTURE_ENVMAP;
  const uint32_t wrap_x = environment ? KB_WRAP_REPEAT : t.wrap;
  const uint32_t wrap_y = environment ? KB_WRAP_CLAMP : t.wrap;
  TextureTerms& terms = textures_.emplace_back();
  double constant = 0;
  for (uint32_t corner = 0; corner < 4; ++corner) {
    const uint32_t dx = corner & 1, dy = corner >> 1;
    const uint32_t x = wrap_texel((sample.xy & 0xffffu) + dx, t.width, wrap_x);
    const uint32_t y = wrap_texel((sample.xy >> 16) + dy, t.height, wrap_y);
    const double fx = sample.fx, fy = sample.fy;
    const std::size_t index = t.first_texel + static_cast<std::size_t>(y) * t.width + x;
    add_texel(terms, constant, scene_.texels[index], (dx ? fx : 1 - fx) * (dy ? fy : 1 - fy));
  }
  terms.constant = static_cast<float>(constant);
  if (t.illuminant_row != KB_NONE)
    terms.factor = spectra.spectrum(t.illuminant_row);
  else if (emission)
    terms.factor = spectra.unit_emission();
  textured_ |= terms.count > 0;
  return &terms;
}

}  // namespace kiloband
