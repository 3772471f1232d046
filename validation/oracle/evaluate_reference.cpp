#include "validation/oracle/evaluate_reference.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstring>

#include "shared/rough_transmission.h"
#include "spectral/planck.hpp"

namespace kiloband {
namespace {

using Complex = std::complex<double>;

/// The spectra at one channel's wavelength. Radiances are integrals over the channel, W m^-2 sr^-1.
struct Point {
  const FlatScene& scene;
  double lambda_nm;
  double width_nm;
  uint32_t channel = 0;
  double mu = 0;
};

double spectrum(const Point& at, uint32_t s) {
  const SpectrumRow& row = at.scene.spectra[s];
  if (row.absorption) return (*row.absorption)(at.channel, at.mu);
  if (!row.is_planck) return row.table(at.lambda_nm);
  const bool inside = at.lambda_nm >= row.planck_min_nm && at.lambda_nm <= row.planck_max_nm;
  const double emissivity = row.table.values.empty() ? 1 : row.table(at.lambda_nm);
  return inside ? emissivity * row.planck_scale * planck_radiance(at.lambda_nm, row.temperature_k) : 0;
}

double named(const Point& at, uint32_t s) {
  return spectrum(at, s) * (at.scene.spectra[s].is_emission ? at.width_nm : 1);
}

/// i is at most one texel beyond the end.
uint32_t wrapped(uint32_t i, uint32_t size, uint32_t rule) {
  if (i < size) return i;
  return rule == KB_WRAP_REPEAT ? 0 : size - 1;
}

double texel_value(const KbFloat4& texel, double lambda_nm) {
  const double y = std::clamp(lambda_nm, 360.0, 830.0) - KB_TEXTURE_CENTRE_NM;
  const double v = (static_cast<double>(texel.x) * y + texel.y) * y + texel.z;
  return texel.w * (0.5 + v / (2 * std::sqrt(1 + v * v)));
}

/// One value of a spectral texel that is given at band centres.
double band_value(const BandSet& set, const float* values, double lambda_nm) {
  if (!set.extrapolate && (lambda_nm < set.min_nm || lambda_nm > set.max_nm)) return 0;
  const std::vector<double>& c = set.centres_nm;
  if (lambda_nm <= c.front()) return set.scale * values[0];
  std::size_t i = 1;
  while (i < c.size() && lambda_nm > c[i]) ++i;
  if (i == c.size()) return set.scale * values[i - 1];
  const double t = (lambda_nm - c[i - 1]) / (c[i] - c[i - 1]);
  return set.scale * ((1 - t) * values[i - 1] + t * values[i]);
}

/// A texel at the point's wavelength, per nm; texel: its number in the texture.
double texel_at(const Point& at, uint32_t texture, std::size_t texel) {
  const KbTexture& t = at.scene.textures[texture];
  if (!(t.flags & KB_TEXTURE_SPECTRAL))
    return texel_value(at.scene.texels[t.first_texel + texel], at.lambda_nm);
  const float* values = at.scene.spectral_texels[texture]->data() + texel * t.values;
  if (t.flags & KB_TEXTURE_BANDS) return band_value(at.scene.band_sets[t.first_row], values, at.lambda_nm);
  double sum = 0;
  for (uint32_t p = 0; p < t.values; ++p) sum += values[p] * spectrum(at, t.first_row + p);
  return sum;
}

/// The bilinear value of a texture.
double lookup(const Point& at, uint32_t texture, uint32_t xy, double fx, double fy) {
  const KbTexture& t = at.scene.textures[texture];
  const bool environment = (t.flags & KB_TEXTURE_ENVMAP) != 0;
  const uint32_t x0 = xy & 0xffffu, y0 = xy >> 16;
  const uint32_t x1 = wrapped(x0 + 1, t.width, environment ? KB_WRAP_REPEAT : t.wrap);
  const uint32_t y1 = wrapped(y0 + 1, t.height, environment ? KB_WRAP_CLAMP : t.wrap);
  const auto texel = [&](uint32_t x, uint32_t y) {
    return texel_at(at, texture, std::size_t{y} * t.width + x);
  };
  const double top = (1 - fx) * texel(x0, y0) + fx * texel(x1, y0);
  const double bottom = (1 - fx) * texel(x0, y1) + fx * texel(x1, y1);
  return (1 - fy) * top + fy * bottom;
}

/// An emissivity times Planck's law at the place's temperature.
double thermal(const Point& at, const KbThermalSample& sample) {
  const uint32_t index = sample.source & KB_SAMPLE_INDEX_MASK;
  const double emissivity = sample.source & KB_SAMPLE_ROW
                                ? spectrum(at, index)
                                : lookup(at, index, sample.xy, (sample.fractions & 0xffffu) / 65535.0,
                                         (sample.fractions >> 16) / 65535.0);
  return emissivity * planck_radiance(at.lambda_nm, sample.temperature_k) * at.width_nm;
}

double textured(const Point& at, const KbTextureSample& sample, bool emission) {
  if (emission && (sample.texture & KB_SAMPLE_THERMAL)) {
    KbThermalSample hot;
    std::memcpy(&hot, &sample, sizeof hot);
    return thermal(at, hot);
  }
  const uint32_t row = at.scene.textures[sample.texture].illuminant_row;
  const double illuminant = row == KB_NONE ? 1 : spectrum(at, row);
  return lookup(at, sample.texture, sample.xy, sample.fx, sample.fy) * illuminant *
         (emission ? at.width_nm : 1);
}

/// Unpolarised Fresnel reflectance of a boundary to the relative complex index m, in the textbook form.
double fresnel(double cosine, Complex m) {
  const double c = std::abs(cosine);
  const Complex ct = std::sqrt(1.0 - (1 - c * c) / (m * m));
  const Complex rs = (c - m * ct) / (c + m * ct);
  const Complex rp = (m * c - ct) / (m * c + ct);
  return 0.5 * (std::norm(rs) + std::norm(rp));
}

double vertex_fresnel(const Point& at, const KbPathVertex& vertex, double cosine) {
  const KbMaterial& m = at.scene.materials[vertex.head >> KB_VERTEX_MATERIAL_SHIFT];
  if (m.flags & KB_MATERIAL_PERFECT_MIRROR) return 1;
  if ((vertex.head & KB_VERTEX_KIND_MASK) == KB_KIND_CONDUCTOR) {
    return fresnel(cosine, {spectrum(at, m.eta_row), spectrum(at, m.k_row)});
  }
  const double interior = spectrum(at, m.eta_row);
  const double exterior = m.ext_row == KB_NONE ? m.eta_ext : spectrum(at, m.ext_row);
  if (m.flags & KB_MATERIAL_THIN) {
    const double f = fresnel(cosine, interior / exterior);
    return (cosine < 0 ? 1 - f : 2 * f) / (1 + f);
  }
  return fresnel(cosine, cosine < 0 ? exterior / interior : interior / exterior);
}

/// T of shared/rough_transmission.h from the directions as they were saved.
double rough_transmission(const Point& at, const KbPathVertex& vertex) {
  const KbMaterial& m = at.scene.materials[vertex.head >> KB_VERTEX_MATERIAL_SHIFT];
  const KbTransmissionPair p = kb_transmission_pair(vertex);
  const double exterior = m.ext_row == KB_NONE ? m.eta_ext : spectrum(at, m.ext_row);
  const double ratio = spectrum(at, m.eta_row) / exterior;
  const double e = p.inside ? 1 / ratio : ratio;
  double x = p.ix + e * p.ox, y = p.iy + e * p.oy, z = p.iz + e * p.oz;
  const double size2 = x * x + y * y + z * z;
  const double length = z < 0 ? -std::sqrt(size2) : std::sqrt(size2);
  x /= length, y /= length, z /= length;
  const double dot_i = p.ix * x + p.iy * y + p.iz * z, dot_o = p.ox * x + p.oy * y + p.oz * z;
  if (!(dot_i > 0) || !(dot_o < 0)) return 0;
  const double au = std::max(m.alpha_u, KB_MIN_ALPHA), av = std::max(m.alpha_v, KB_MIN_ALPHA);
  const double slope2 = (x * x / (au * au) + y * y / (av * av)) / (z * z);
  const double shape = m.flags & KB_MATERIAL_GGX ? 1 / ((1 + slope2) * (1 + slope2)) : std::exp(-slope2);
  const double density = shape / (KB_PI * au * av * z * z * z * z);
  return (1 - fresnel(dot_i, e)) * density * dot_i * -dot_o / size2;
}

double scattering(const Point& at, const KbPathVertex& vertex, double a, double b, double w0, double w1) {
  switch (vertex.head & KB_VERTEX_KIND_MASK) {
    case KB_KIND_TWO_TERM:
      return w0 * a + w1 * b;
    case KB_KIND_NONLINEAR:
      return w0 * a +
             w1 * b / (1 - b + b * at.scene.materials[vertex.head >> KB_VERTEX_MATERIAL_SHIFT].escape);
    case KB_KIND_CONDUCTOR:
    case KB_KIND_DISPERSIVE:
      return w0 * a * vertex_fresnel(at, vertex, w1);
    case KB_KIND_ROUGH_TRANSMISSION:
      return w0 * a * rough_transmission(at, vertex);
    case KB_KIND_TINTED:
      return w0 * a + (w1 >= 0 ? w1 : -w1 * std::sqrt(a));
    default:
      return w0 * a;
  }
}

/// tau and L of one channel along the path.
struct State {
  double tau = 1, radiance = 0;
  double aside = 1;  // q of path_vertex.h
};

/// samples: the vertex's texture samples, in order. k: the channel.
void apply(const Point& at, const KbPathVertex& v, const KbTextureSample* samples, uint32_t k, State& state) {
  const auto value = [&](uint32_t flag, bool used, uint32_t row, bool emission) {
    if (v.head & flag) return textured(at, *samples++, emission);
    return used ? named(at, row) : 0.0;
  };
  const uint32_t kind = v.head & KB_VERTEX_KIND_MASK;
  const bool reflects = v.head & (KB_VERTEX_NEE | KB_VERTEX_SCATTER);
  const double a = value(KB_VERTEX_TEX_A, reflects, v.row_a, false);
  const double b = value(KB_VERTEX_TEX_B, reflects && kb_has_two_spectra(kind), v.row_b, false);
  const double emitted = value(KB_VERTEX_TEX_EMIT, v.head & KB_VERTEX_EMIT, v.emit_row, true);
  const double light = value(KB_VERTEX_TEX_NEE, v.head & KB_VERTEX_NEE, v.nee_row, true);
  if (v.head & KB_VERTEX_EMIT) state.radiance += state.tau * v.emit_weight * emitted;
  if (v.head & KB_VERTEX_NEE) {
    const double lit = state.tau * scattering(at, v, a, b, v.nee0, v.nee1) * light;
    if (v.head & KB_VERTEX_DEFER)
      state.aside = lit;
    else
      state.radiance += lit;
  }
  if (v.head & KB_VERTEX_SCATTER) state.tau *= scattering(at, v, a, b, v.scatter0, v.scatter1);
  if ((v.head & KB_VERTEX_DEGRADE) && k != kb_surviving_channel(v.scatter1)) state.tau = 0;
}

/// A plume's cells: the source function is linear in the column within each.
void apply_plume(const Point& at, const KbPathVertex& v, const KbPathVertex* extensions, State& state) {
  const double kappa = named(at, v.row_a);
  double near = planck_radiance(at.lambda_nm, v.nee0), sum = 0, passed = 1;
  for (uint32_t i = 0; i < v.head >> KB_VERTEX_MATERIAL_SHIFT; ++i) {
    KbPlumeCell cell;
    std::memcpy(&cell, reinterpret_cast<const char*>(extensions) + i * sizeof cell, sizeof cell);
    const double far = planck_radiance(at.lambda_nm, cell.temperature_k);
    const double x = kappa * cell.column, stays = -std::expm1(-x);
    const double share = x < 1e-4 ? x / 2 - x * x / 3 : (stays - x * std::exp(-x)) / x;
    sum += passed * (stays * near + share * (far - near));
    passed *= std::exp(-x);
    near = far;
  }
  state.radiance += state.tau * state.aside * v.emit_weight * sum * at.width_nm;
  state.tau *= passed;
  state.aside = 1;
}

/// Gas along a ray.
void apply_medium(const Point& at, const KbPathVertex& v, const KbPathVertex* extensions, State& state) {
  const double kappa = named(at, v.row_a);
  if (v.head & KB_VERTEX_NEE) {
    state.aside *= std::exp(-kappa * v.nee0);
    if (v.head & KB_VERTEX_DEFER) return;
    state.radiance += state.aside;
    state.aside = 1;
  } else if (v.head & KB_VERTEX_DEFER) {
    state.aside = std::exp(-kappa * v.scatter0);
  } else if (v.head >> KB_VERTEX_MATERIAL_SHIFT) {
    apply_plume(at, v, extensions, state);
  } else {
    const double x = kappa * v.scatter0;
    if (v.head & KB_VERTEX_EMIT) {
      state.radiance += state.tau * state.aside * v.emit_weight * -std::expm1(-x) * named(at, v.emit_row);
      state.aside = 1;
    }
    if (v.head & KB_VERTEX_SCATTER) state.tau *= std::exp(-x);
  }
}

double channel_value(const Point& at, const cpu::PathBuffer& paths, const cpu::SavedPath& path, uint32_t k) {
  State state;
  for (uint32_t i = path.first; i < path.first + path.count; ++i) {
    const KbPathVertex& vertex = paths.entries[i];
    if (vertex.head & KB_VERTEX_NEGATIVE) state.tau = -state.tau;
    if ((vertex.head & KB_VERTEX_KIND_MASK) == KB_KIND_MEDIUM) {
      apply_medium(at, vertex, &vertex + 1, state);
      i += kb_vertex_extensions(vertex.head);
      continue;
    }
    KbTextureSample samples[4];
    uint32_t count = 0;
    for (uint32_t flag = KB_VERTEX_TEX_A; flag <= KB_VERTEX_TEX_NEE; flag <<= 1)
      count += (vertex.head & flag) != 0;
    if (count > 0) std::memcpy(samples, &paths.entries[i] + 1, count * sizeof(KbTextureSample));
    apply(at, vertex, samples, k, state);
    i += (count + 1) / 2;
  }
  return state.radiance;
}

}  // namespace

std::vector<double> evaluate_path_reference(const FlatScene& scene, const DerivedChannels& derived,
                                            const cpu::PathBuffer& paths, std::size_t path, double mu) {
  const std::size_t channels = scene.channels.size();
  std::vector<double> values(channels + derived.responses.size());
  for (std::size_t k = 0; k < channels; ++k) {
    const Channel& channel = scene.channels[k];
    const Point at{scene, (1 - mu) * channel.min_nm + mu * channel.max_nm, channel.width_nm(),
                   static_cast<uint32_t>(k), mu};
    values[k] = channel_value(at, paths, paths.paths[path], static_cast<uint32_t>(k));
    double others = 0;  // channel widths for each of which one of the others falls on this wavelength
    for (std::size_t j = 0; j < channels; ++j) {
      const Channel& c = scene.channels[j];
      if (j != k && c.min_nm <= at.lambda_nm && at.lambda_nm < c.max_nm)
        others += channel.width_nm() / c.width_nm();
    }
    for (std::size_t d = 0; d < derived.responses.size(); ++d) {
      values[channels + d] += derived.responses[d](at.lambda_nm) / (1 + others) * values[k];
    }
  }
  return values;
}

}  // namespace kiloband
