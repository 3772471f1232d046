#include "rough_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "shared/rough_transmission.h"

namespace kiloband::test {
namespace {

double dot(const Direction& a, const Direction& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

void append_pair(RoughPairs& pairs, const Direction& wi, const Direction& wo) {
  KbPathVertex vertex{};
  vertex.head = KB_KIND_ROUGH_TRANSMISSION | KB_VERTEX_NEE;
  vertex.row_a = 1;
  vertex.row_b = pairs.inside;
  vertex.nee_row = 2;
  vertex.nee0 = 1;
  vertex.emit_weight = static_cast<float>(wi.x);
  vertex.scatter0 = static_cast<float>(wi.y);
  vertex.nee1 = static_cast<float>(wo.x);
  vertex.scatter1 = static_cast<float>(wo.y);
  const auto entry = static_cast<uint32_t>(pairs.paths.entries.size());
  pairs.paths.paths.push_back({entry, 1, entry});
  pairs.paths.entries.push_back(vertex);
}

void add_pair(RoughPairs& pairs, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const double slope = pairs.alpha * std::sqrt(-std::log(1 - unit(random))), turn = 2 * KB_PI * unit(random);
  const double up = 1 / std::hypot(1, slope);
  const Direction m{slope * up * std::cos(turn), slope * up * std::sin(turn), up};
  const double iz = 0.02 + 0.98 * unit(random), side = 2 * KB_PI * unit(random), s = std::sqrt(1 - iz * iz);
  const Direction wi{s * std::cos(side), s * std::sin(side), iz};
  const double c = dot(wi, m), e = pairs.inside ? 1 / 1.5 : 1.5;
  const double g2 = e * e - 1 + c * c;
  if (c <= 0 || g2 <= 0) return;
  const double along = (c - std::sqrt(g2)) / e;
  const Direction wo{along * m.x - wi.x / e, along * m.y - wi.y / e, along * m.z - wi.z / e};
  if (wo.z >= 0) return;
  append_pair(pairs, wi, wo);
}

/// The pair of a vertex as unit vectors: third components are rounded where they are made, not in the vertex.
void directions(const KbPathVertex& vertex, Direction& wi, Direction& wo) {
  const KbTransmissionPair p = kb_transmission_pair(vertex);
  wi = {p.ix, p.iy, std::sqrt(1 - double{p.ix} * p.ix - double{p.iy} * p.iy)};
  wo = {p.ox, p.oy, -std::sqrt(1 - double{p.ox} * p.ox - double{p.oy} * p.oy)};
}

double relative_index(const RoughPairs& pairs, std::size_t k) {
  return pairs.inside ? 1 / pairs.index[k] : pairs.index[k];
}

}  // namespace

RoughPairs::RoughPairs(float roughness, bool is_ggx, bool from_inside)
    : alpha(roughness), ggx(is_ggx), inside(from_inside) {
  for (const double n : {1.0002, 1.01, 1.3, 1.45, 1.499, 1.5, 1.501, 1.6, 2.0, 2.6}) index.push_back(n);
  for (std::size_t k = 0; k < index.size(); ++k)
    scene.channels.push_back({500.0 + 2.0 * k, 501.0 + 2.0 * k, {}});
  scene.channel_scale.assign(index.size(), 1.0);
  std::vector<double> entries = index;
  entries.push_back(1);
  scene.spectra = {row(table(500, 2, entries)), row(table(400, 1e6, {1, 1}, true)),
                   row(table(400, 1e6, {1, 1}, true), true)};
  KbMaterial material{};
  material.eta_row = 0;
  material.k_row = material.ext_row = KB_NONE;
  material.eta_ext = 1;
  material.alpha_u = material.alpha_v = alpha;
  material.type = KB_MATERIAL_ROUGH_DIELECTRIC;
  material.flags = KB_MATERIAL_DISPERSIVE | (ggx ? KB_MATERIAL_GGX : 0);
  scene.materials = {material};
  std::mt19937 random(5);
  while (paths.paths.size() < 400) add_pair(*this, random);
}

double RoughPairs::expected(std::size_t path, std::size_t k) const {
  Direction wi, wo;
  directions(paths.entries[path], wi, wo);
  const double e = relative_index(*this, k), a = std::max(alpha, KB_MIN_ALPHA);
  Direction m{wi.x + e * wo.x, wi.y + e * wo.y, wi.z + e * wo.z};
  const double size2 = dot(m, m), length = std::copysign(std::sqrt(size2), m.z);
  m = {m.x / length, m.y / length, m.z / length};
  const double c = dot(wi, m), other = -dot(wo, m);
  if (c <= 0 || other <= 0) return 0;
  const double rs = (c - e * other) / (c + e * other), rp = (e * c - other) / (e * c + other);
  const double t = (m.x * m.x + m.y * m.y) / (a * a * m.z * m.z);
  const double shape = ggx ? 1 / ((1 + t) * (1 + t)) : std::exp(-t);
  const double density = shape / (KB_PI * a * a * std::pow(m.z, 4));
  return (1 - (rs * rs + rp * rp) / 2) * density * c * other / size2;
}

double RoughPairs::allowed(std::size_t path, std::size_t k) const {
  Direction wi, wo;
  directions(paths.entries[path], wi, wo);
  const double d = relative_index(*this, k) - 1, a = std::max(alpha, KB_MIN_ALPHA), a2 = a * a;
  const auto rounded = [&](double i, double o) { return std::abs(i + o) + std::abs(d * o); };
  const double x = wi.x + wo.x + d * wo.x, y = wi.y + wo.y + d * wo.y, z = wi.z + wo.z + d * wo.z;
  const double third = 1 / wi.z - (d + 1) / wo.z, mixed = -wo.z / wi.z - wi.z / wo.z;
  const double q = (x * x + y * y) / a2, height = ggx ? z * z + q : z * z;
  const double lean = (std::abs(x) * rounded(wi.x, wo.x) + std::abs(y) * rounded(wi.y, wo.y)) / a2;
  const double rise = (rounded(wi.z, wo.z) + third) * std::abs(z) * (ggx ? 1 : 1 + q / (z * z));
  const double in = dot(wi, wi) + (d + 1) * dot(wi, wo), out = dot(wi, wo) + (d + 1) * dot(wo, wo);
  return 12 + ((ggx ? 4 : 2) * lean + 4 * rise) / height +
         2 * (1 + mixed) * (1 / std::abs(in) + 1 / std::abs(out));
}

RoughPairs edge_on_facets() {
  RoughPairs pairs(0.3f, false, false);
  for (std::size_t k = 0; k < pairs.index.size(); ++k) pairs.index[k] = 1.2 + 0.6 * static_cast<double>(k);
  std::vector<double> entries = pairs.index;
  entries.push_back(1);
  pairs.scene.spectra[0] = row(table(500, 2, entries));
  pairs.paths = {};
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(0, 1);
  while (pairs.paths.paths.size() < 4000) {
    const double e = pairs.index[random() % pairs.index.size()], off = 1 + 2e-7 * (unit(random) - 0.5);
    const double iz = std::pow(10, -3 * unit(random)), oz = -iz / e * off, turn = 2 * KB_PI * unit(random),
                 bend = 0.3 * unit(random);
    const double i = std::sqrt(1 - iz * iz), o = std::sqrt(1 - oz * oz);
    append_pair(pairs, {i * std::cos(turn), i * std::sin(turn), iz},
                {-o * std::cos(turn + bend), -o * std::sin(turn + bend), oz});
  }
  return pairs;
}

RoughPairs horizontal_facet() {
  RoughPairs pairs(0.5f, false, false);
  pairs.paths = {};
  append_pair(pairs, {0.8, 0, 0.6}, {-std::sqrt(0.84), 0, -0.4});
  return pairs;
}

Errors errors_of(const RoughPairs& pairs, const std::vector<float>& values, std::size_t stride) {
  constexpr double kUnit = 0x1p-24, kFloor = 1e-25;
  Errors errors;
  for (std::size_t p = 0; p < pairs.paths.paths.size(); ++p) {
    for (std::size_t k = 0; k < pairs.index.size(); ++k) {
      const double value = values[p * stride + k], expected = pairs.expected(p, k);
      const double allowed = kUnit * pairs.allowed(p, k);
      EXPECT_GE(value, 0);
      if (expected < kFloor || allowed > 0.1) continue;
      ++errors.counted;
      errors.largest = std::max(errors.largest, std::abs(value - expected) / (expected * allowed));
    }
  }
  return errors;
}

}  // namespace kiloband::test
