#include "scenes/generator/implicit.hpp"

#include <algorithm>
#include <stdexcept>
#include <unordered_map>

namespace kiloband::generator {
namespace {

constexpr int kRelaxations = 2;
constexpr int kBlock = 8;  // cubes along the edge of a block that is looked at, or skipped, together

/// The corner with bits (x, y, z) = (c & 1, c >> 1 & 1, c >> 2);
/// six tetrahedra around the diagonal from 0 to 7.
constexpr int kTetrahedra[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                   {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};

class Marcher {
 public:
  Marcher(const Field& field, const Bounds& bounds, double step)
      : field_(field), low_(bounds.low), step_(step) {
    const Vec3 extent = bounds.high - bounds.low;
    for (int a = 0; a < 3; ++a) {
      const double length = a == 0 ? extent.x : a == 1 ? extent.y : extent.z;
      count_[a] = static_cast<int>(std::floor(length / step)) + 2;
      if (count_[a] < 2 || count_[a] > 2000) throw std::logic_error("surface_of: unreasonable bounds");
    }
  }

  Mesh run(double steepness) {
    const double reach = steepness * step_ * kBlock * 0.8660254037844387;  // half of a block's diagonal
    for (int z = 0; z < count_[2]; z += kBlock) {
      for (int y = 0; y < count_[1]; y += kBlock) {
        for (int x = 0; x < count_[0]; x += kBlock) {
          const Vec3 middle = low_ + Vec3{x + kBlock / 2.0, y + kBlock / 2.0, z + kBlock / 2.0} * step_;
          if (std::fabs(field_(middle)) <= reach) block(x, y, z);
        }
      }
    }
    for (int i = 0; i < kRelaxations; ++i) relax();
    for (const Vec3& p : mesh_.positions) mesh_.normals.push_back(normalize(gradient(p)));
    return std::move(mesh_);
  }

 private:
  using Key = uint64_t;

  Key key(int x, int y, int z) const {
    return (static_cast<Key>(z) * 4096 + static_cast<Key>(y)) * 4096 + static_cast<Key>(x);
  }
  Vec3 place(Key k) const {
    const auto c = [&](int shift) { return static_cast<double>(k >> shift & 4095); };
    return low_ + Vec3{c(0), c(12), c(24)} * step_;
  }
  /// Never 0, so that every corner is inside or outside.
  double value(Key k) {
    const auto [slot, fresh] = values_.try_emplace(k, 0);
    if (fresh) {
      const double f = field_(place(k));
      slot->second = f == 0 ? 1e-12 : f;
    }
    return slot->second;
  }

  void block(int x0, int y0, int z0) {
    for (int z = z0; z < z0 + kBlock; ++z) {
      for (int y = y0; y < y0 + kBlock; ++y) {
        for (int x = x0; x < x0 + kBlock; ++x) cube(x, y, z);
      }
    }
  }

  void cube(int x, int y, int z) {
    Key keys[8];
    int inside = 0;
    for (int c = 0; c < 8; ++c) {
      keys[c] = key(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2));
      inside += value(keys[c]) < 0;
    }
    if (inside == 0 || inside == 8) return;
    for (const auto& t : kTetrahedra) tetrahedron({keys[t[0]], keys[t[1]], keys[t[2]], keys[t[3]]});
  }

  /// Corners in positive orientation. Each swap of two corners that sorts the inside ones
  /// first turns it round.
  void tetrahedron(std::array<Key, 4> corner) {
    int inside = 0;
    bool turned = false;
    for (int i = 0; i < 4; ++i) {
      if (value(corner[i]) >= 0) continue;
      if (i != inside) {
        std::swap(corner[i], corner[inside]);
        turned = !turned;
      }
      ++inside;
    }
    // One statement per vertex: they are numbered as they are made,
    // and the order of arguments is the compiler's choice.
    if (inside == 1 || inside == 3) {
      const int apex = inside == 1 ? 0 : 3, first = inside == 1 ? 1 : 0;
      const uint32_t a = vertex(corner[apex], corner[first]);
      const uint32_t b = vertex(corner[apex], corner[first + 1]);
      const uint32_t c = vertex(corner[apex], corner[first + 2]);
      triangle(a, b, c, turned);
    }
    if (inside == 2) {
      const uint32_t a = vertex(corner[0], corner[2]);
      const uint32_t b = vertex(corner[0], corner[3]);
      const uint32_t c = vertex(corner[1], corner[3]);
      const uint32_t d = vertex(corner[1], corner[2]);
      triangle(a, b, c, turned);
      triangle(a, c, d, turned);
    }
  }

  void triangle(uint32_t a, uint32_t b, uint32_t c, bool turned) {
    mesh_.triangles.push_back(turned ? std::array{a, c, b} : std::array{a, b, c});
  }

  /// The zero on an edge by false position, kept away from its ends, so that no triangle degenerates.
  uint32_t vertex(Key a, Key b) {
    if (a > b) std::swap(a, b);
    const Key id = a * 8 + direction(a, b);
    const auto [slot, fresh] = vertices_.try_emplace(id, static_cast<uint32_t>(mesh_.positions.size()));
    if (fresh) {
      const Vec3 p = place(a), q = place(b);
      double ta = 0, tb = 1, fa = value(a), fb = value(b);
      for (int i = 0; i < 3; ++i) {
        const double t = ta + (tb - ta) * fa / (fa - fb), f = field_(mix(p, q, t));
        ((f < 0) == (fa < 0) ? ta : tb) = t;
        ((f < 0) == (fa < 0) ? fa : fb) = f == 0 ? 1e-12 : f;
      }
      const double t = ta + (tb - ta) * fa / (fa - fb);
      mesh_.positions.push_back(mix(p, q, clamp(t, 0.06, 0.94)));
    }
    return slot->second;
  }

  /// Which of the seven directions between corners of a cube leads from a to b.
  uint64_t direction(Key a, Key b) const {
    const Key d = b - a;
    return (d & 4095 ? 1u : 0u) | (d >> 12 & 4095 ? 2u : 0u) | (d >> 24 & 4095 ? 4u : 0u);
  }

  Vec3 gradient(Vec3 p) const {
    const double h = 0.25 * step_;
    const auto along = [&](Vec3 d) { return (field_(p + d * h) - field_(p - d * h)) / (2 * h); };
    return {along({1, 0, 0}), along({0, 1, 0}), along({0, 0, 1})};
  }

  /// Marching leaves slivers: each vertex moves half of the way to the mean of its neighbours, along the
  /// surface, and is put back onto it by a Newton step (at most half of an edge).
  void relax() {
    const std::vector<Vec3> old = mesh_.positions;
    std::vector<Vec3> sums(old.size());
    std::vector<int> counts(old.size());
    for (const auto& t : mesh_.triangles) {
      for (int c = 0; c < 3; ++c) {
        sums[t[c]] = sums[t[c]] + old[t[(c + 1) % 3]] + old[t[(c + 2) % 3]];
        counts[t[c]] += 2;
      }
    }
    for (std::size_t i = 0; i < old.size(); ++i) {
      const Vec3 g = gradient(old[i]), n = normalize(g), way = sums[i] * (1.0 / counts[i]) - old[i];
      const Vec3 p = old[i] + (way - n * dot(way, n)) * 0.5;
      const double off = field_(p) / std::max(length(g), 0.25), limit = 0.5 * step_;
      mesh_.positions[i] = p - n * clamp(off, -limit, limit);
    }
  }

  const Field& field_;
  Vec3 low_;
  double step_;
  int count_[3] = {};
  std::unordered_map<Key, double> values_;
  std::unordered_map<uint64_t, uint32_t> vertices_;
  Mesh mesh_;
};

/// Dot product of v with one of twelve directions from a cube's middle to its edges
/// (Perlin, Improving noise, 2002).
double lattice_slope(double x, double y, double z, unsigned seed, Vec3 v) {
  const auto cell = [](double c) { return static_cast<unsigned>(static_cast<int64_t>(c) & 1023); };
  const unsigned at = (cell(z) * 1024 + cell(y)) * 1024 + cell(x);
  const int edge = static_cast<int>(12 * random_number(seed, at));
  const double a = edge & 1 ? 1 : -1, b = edge & 2 ? 1 : -1;
  if (edge < 4) return a * v.x + b * v.y;
  return edge < 8 ? a * v.y + b * v.z : a * v.z + b * v.x;
}

}  // namespace

Mesh surface_of(const Field& field, const Bounds& bounds, double step, double steepness) {
  return Marcher(field, bounds, step).run(steepness);
}

double sphere_distance(Vec3 p, Vec3 centre, double radius) {
  return length(p - centre) - radius;
}

double ellipsoid_distance(Vec3 p, Vec3 centre, Vec3 radii) {
  const Vec3 d = p - centre, scaled{d.x / radii.x, d.y / radii.y, d.z / radii.z};
  const double k0 = length(scaled);
  const double k1 = length({scaled.x / radii.x, scaled.y / radii.y, scaled.z / radii.z});
  return k1 > 0 ? k0 * (k0 - 1) / k1 : -std::min({radii.x, radii.y, radii.z});
}

double capsule_distance(Vec3 p, Vec3 a, Vec3 b, double a_radius, double b_radius) {
  const Vec3 ab = b - a;
  const double t = clamp(dot(p - a, ab) / dot(ab, ab), 0, 1);
  return length(p - mix(a, b, t)) - mix(a_radius, b_radius, t);
}

double blend(double a, double b, double radius) {
  const double h = std::max(radius - std::fabs(a - b), 0.0) / radius;
  return std::min(a, b) - h * h * radius * 0.25;
}

double blend_intersection(double a, double b, double radius) {
  return -blend(-a, -b, radius);
}

double noise(Vec3 p, unsigned seed) {
  const double x = std::floor(p.x), y = std::floor(p.y), z = std::floor(p.z);
  const auto fade = [](double t) { return t * t * t * (t * (t * 6 - 15) + 10); };
  const double fx = fade(p.x - x), fy = fade(p.y - y), fz = fade(p.z - z);
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    const double cx = x + (c & 1), cy = y + (c >> 1 & 1), cz = z + (c >> 2);
    const double weight = ((c & 1) ? fx : 1 - fx) * ((c >> 1 & 1) ? fy : 1 - fy) * ((c >> 2) ? fz : 1 - fz);
    sum += weight * lattice_slope(cx, cy, cz, seed, p - Vec3{cx, cy, cz});
  }
  return sum;
}

double turbulence(Vec3 p, unsigned seed, int octaves) {
  double sum = 0, height = 1;
  for (int i = 0; i < octaves; ++i) {
    sum += height * noise(p, seed + static_cast<unsigned>(i));
    p = p * 2;
    height *= 0.5;
  }
  return sum;
}

}  // namespace kiloband::generator
