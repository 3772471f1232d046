#include "scene/compile/light/light_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "shared/records.h"

namespace kiloband {
namespace {

constexpr std::size_t kPlaces = 12;
/// Deeper than this halves are of equal number, so that no arrangement of lights makes a path down longer than this and 30 more.
constexpr int kMostUnequal = 40;

/// The solid angle into which normals within a cone shine, each up to 90 degrees away and weighted by the cosine of
/// what is beyond the cone.
double cone_measure(double cone) {
  constexpr double kPi = std::numbers::pi;
  const double reach = std::min(cone + kPi / 2, kPi);
  return 2 * kPi * (1 - std::cos(cone)) + kPi / 2 *
                                              (2 * reach * std::sin(cone) - std::cos(cone - 2 * reach) -
                                               2 * cone * std::sin(cone) + std::cos(cone));
}

double half_surface(const LightBounds& b) {
  const glm::dvec3 d = b.high - b.low;
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

/// By what lights cost that shine from these bounds; area: what even points have.
double cost(const LightBounds& b, double area) {
  return b.power * cone_measure(b.cone) * (half_surface(b) + area);
}

void merge_cones(const LightBounds& a, const LightBounds& b, LightBounds& out) {
  const double between = angle_between(a.axis, b.axis);
  if (std::min(between + b.cone, std::numbers::pi) <= a.cone) {
    out.axis = a.axis, out.cone = a.cone;
    return;
  }
  if (std::min(between + a.cone, std::numbers::pi) <= b.cone) {
    out.axis = b.axis, out.cone = b.cone;
    return;
  }
  out.cone = 0.5 * (a.cone + between + b.cone);
  const glm::dvec3 across = b.axis - glm::dot(a.axis, b.axis) * a.axis;
  const double length = glm::length(across);
  if (out.cone >= std::numbers::pi || !(length > 0)) {
    out.cone = std::numbers::pi, out.axis = a.axis;
    return;
  }
  const double turn = out.cone - a.cone;
  out.axis = glm::normalize(std::cos(turn) * a.axis + std::sin(turn) / length * across);
}

KbLightNode node_of(const LightBounds& b) {
  KbLightNode node{};
  const glm::dvec3 centre = b.centre();
  for (int i = 0; i < 3; ++i) {
    node.centre[i] = static_cast<float>(centre[i]);
    node.axis[i] = static_cast<float>(b.axis[i]);
  }
  const glm::dvec3 half = 0.5 * (b.high - b.low);
  node.power = static_cast<float>(b.power);
  node.radius2 = static_cast<float>(glm::dot(half, half));
  node.cos_cone = static_cast<float>(b.cone < std::numbers::pi ? std::cos(b.cone) : -1);
  node.sin_cone = static_cast<float>(b.cone < std::numbers::pi ? std::sin(b.cone) : 0);
  node.right = node.light = KB_NONE;
  return node;
}

class Builder {
 public:
  explicit Builder(std::span<const LightBounds> lights) : lights_(lights), order_(lights.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    tree_.nodes.reserve(2 * lights.size());
    tree_.leaves.resize(lights.size());
  }
  LightTree run() {
    if (!order_.empty()) build(order_, 0);
    return std::move(tree_);
  }

 private:
  /// Returns what bounds the lights.
  LightBounds build(std::span<uint32_t> part, int depth) {
    const std::size_t at = tree_.nodes.size();
    tree_.nodes.emplace_back();
    if (part.size() == 1) {
      tree_.leaves[part[0]] = static_cast<uint32_t>(at);
      tree_.nodes[at] = node_of(lights_[part[0]]);
      tree_.nodes[at].light = part[0];
      return lights_[part[0]];
    }
    const std::size_t left = split(part, depth);
    const LightBounds low = build(part.first(left), depth + 1);
    const auto right = static_cast<uint32_t>(tree_.nodes.size());
    const LightBounds whole = merged(low, build(part.subspan(left), depth + 1));
    tree_.nodes[at] = node_of(whole);
    tree_.nodes[at].right = right;
    return whole;
  }

  struct Place {
    double cost;
    int axis;
    std::size_t bucket;  // the last one of the left half
  };

  /// Where centres lie.
  struct Range {
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-low};
    std::size_t bucket(const glm::dvec3& centre, int axis) const {
      const double t = (centre[axis] - low[axis]) / (high[axis] - low[axis]);
      return std::min(static_cast<std::size_t>(t * kPlaces), kPlaces - 1);
    }
  };

  /// Orders the part; returns how many lights are in its left half, neither none nor all.
  std::size_t split(std::span<uint32_t> part, int depth) {
    Range range;
    for (const uint32_t i : part) {
      range.low = glm::min(range.low, lights_[i].centre());
      range.high = glm::max(range.high, lights_[i].centre());
    }
    std::optional<Place> best;
    for (int axis = 0; axis < 3 && depth < kMostUnequal; ++axis) {
      if (range.high[axis] > range.low[axis]) consider(part, range, axis, best);
    }
    if (best) {
      const auto middle = std::stable_partition(part.begin(), part.end(), [&](uint32_t i) {
        return range.bucket(lights_[i].centre(), best->axis) <= best->bucket;
      });
      return static_cast<std::size_t>(middle - part.begin());
    }
    const glm::dvec3 size = range.high - range.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t half = part.size() / 2;
    std::ranges::nth_element(part, part.begin() + static_cast<std::ptrdiff_t>(half), {},
                             [&](uint32_t i) { return std::pair(lights_[i].centre()[axis], i); });
    return half;
  }

  void consider(std::span<const uint32_t> part, const Range& range, int axis,
                std::optional<Place>& best) const {
    std::array<std::optional<LightBounds>, kPlaces> buckets, from_right;
    const auto add = [](std::optional<LightBounds>& to, const LightBounds& b) {
      to = to ? merged(*to, b) : b;
    };
    for (const uint32_t i : part) add(buckets[range.bucket(lights_[i].centre(), axis)], lights_[i]);
    std::optional<LightBounds> right, left;
    for (std::size_t i = kPlaces; i-- > 1;) {
      if (buckets[i]) add(right, *buckets[i]);
      from_right[i] = right;
    }
    const glm::dvec3 size = range.high - range.low;
    const double longest = std::max({size.x, size.y, size.z});
    const double stretched = longest / size[axis];  // prefers cuts across the longest axis
    for (std::size_t i = 0; i + 1 < kPlaces; ++i) {
      if (buckets[i]) add(left, *buckets[i]);
      if (!left || !from_right[i + 1]) continue;
      const double area = 1e-4 * longest * longest;
      const double value = stretched * (cost(*left, area) + cost(*from_right[i + 1], area));
      if (!best || value < best->cost) best = Place{value, axis, i};
    }
  }

  std::span<const LightBounds> lights_;
  std::vector<uint32_t> order_;
  LightTree tree_;
};

}  // namespace

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

LightBounds merged(const LightBounds& a, const LightBounds& b) {
  LightBounds out;
  out.low = glm::min(a.low, b.low);
  out.high = glm::max(a.high, b.high);
  out.power = a.power + b.power;
  merge_cones(a, b, out);
  return out;
}

LightTree build_light_tree(std::span<const LightBounds> lights) {
  return Builder(lights).run();
}

}  // namespace kiloband
