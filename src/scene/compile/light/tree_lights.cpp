// The lights of the light tree (shared/light_tree.h): what of a scene's emitters they are and where they lie.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/compile/light/emitters.hpp"
#include "scene/compile/light/lattice_cdf.hpp"
#include "scene/compile/light/light_tree.hpp"
#include "scene/compile/record_vectors.hpp"
#include "scene/compile/shape_bounds.hpp"

namespace kiloband {
namespace {

/// Fewer lights than this are chosen by power alone: as measured, the walk down the tree costs more than it saves.
constexpr std::size_t kFewestTreeLights = 16;

glm::dvec3 column(const float (&m)[12], int i) {
  return {m[i], m[4 + i], m[8 + i]};
}

bool in_tree(uint32_t type) {
  return type == KB_EMITTER_AREA || type == KB_EMITTER_THERMAL || type == KB_EMITTER_POINT ||
         type == KB_EMITTER_SPOT || type == KB_EMITTER_PROJECTOR;
}
bool on_shape(uint32_t type) {
  return type == KB_EMITTER_AREA || type == KB_EMITTER_THERMAL;
}

/// Shines where its vertex normals point to, which may lean away from its own.
LightBounds triangle_bounds(const FlatScene& scene, const KbShape& shape, uint32_t triangle) {
  const uint32_t* index = &scene.triangles[3 * (std::size_t{shape.first_triangle} + triangle)];
  const glm::dvec3 p0 = to_glm(scene.positions[index[0]]), p1 = to_glm(scene.positions[index[1]]),
                   p2 = to_glm(scene.positions[index[2]]);
  LightBounds bounds;
  bounds.low = glm::min(p0, glm::min(p1, p2));
  bounds.high = glm::max(p0, glm::max(p1, p2));
  const glm::dvec3 normal = glm::cross(p1 - p0, p2 - p0);
  const double length = glm::length(normal);
  if ((shape.flags & KB_SHAPE_LIT_BOTH_SIDES) || !(length > 0)) return bounds;
  bounds.axis = normal * ((kb_winding_is_turned(shape.flags) ? -1 : 1) / length);
  bounds.cone = 0;
  for (int i = 0; i < 3 && (shape.flags & KB_SHAPE_HAS_NORMALS); ++i) {
    const glm::dvec3 n = to_glm(scene.normals[index[i]]);
    bounds.cone =
        std::max(bounds.cone, glm::length(n) > 0 ? angle_between(bounds.axis, n) : std::numbers::pi);
  }
  return bounds;
}

double triangle_area(const FlatScene& scene, const KbShape& shape, uint32_t triangle) {
  const uint32_t* index = &scene.triangles[3 * (std::size_t{shape.first_triangle} + triangle)];
  const glm::dvec3 p0 = to_glm(scene.positions[index[0]]);
  return 0.5 * glm::length(glm::cross(to_glm(scene.positions[index[1]]) - p0,
                                      to_glm(scene.positions[index[2]]) - p0));
}

LightBounds shape_bounds(const KbShape& shape) {
  LightBounds bounds;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = analytic_interval(shape, axis);
    bounds.low[axis] = low;
    bounds.high[axis] = high;
  }
  if (shape.type != KB_SHAPE_DISK || (shape.flags & KB_SHAPE_LIT_BOTH_SIDES)) return bounds;
  const glm::dvec3 normal = glm::cross(column(shape.to_world, 0), column(shape.to_world, 1));
  const double turn = shape.flags & KB_SHAPE_FLIP_NORMALS ? -1 : 1;
  const double same = glm::dot(normal, column(shape.to_world, 2)) < 0 ? -1 : 1;
  bounds.axis = glm::normalize(normal) * turn * same;
  bounds.cone = 0;
  return bounds;
}

/// Points shine everywhere, spots up to their cutoff, projectors to their front.
LightBounds position_bounds(const KbEmitter& emitter) {
  LightBounds bounds;
  bounds.low = bounds.high = column(emitter.to_world, 3);
  if (emitter.type == KB_EMITTER_POINT) return bounds;
  bounds.axis = glm::normalize(column(emitter.to_world, 2));
  bounds.cone =
      emitter.type == KB_EMITTER_SPOT ? std::max(0.0, emitter.cutoff_angle - std::numbers::pi / 2) : 0;
  return bounds;
}

struct TreeLights {
  std::vector<LightBounds> bounds;  // of those that can be chosen
  std::vector<uint32_t> lights;     // which they are
};

}  // namespace

std::size_t EmitterCompiler::tree_light_count() const {
  std::size_t count = 0;
  for (const KbEmitter& emitter : out_.emitters) {
    if (!in_tree(emitter.type)) continue;
    const bool mesh = on_shape(emitter.type) && out_.shapes[emitter.shape].type == KB_SHAPE_MESH;
    count += mesh ? out_.shapes[emitter.shape].triangle_count : 1;
  }
  return count;
}

bool EmitterCompiler::wants_light_tree() const {
  const LightSelection selection = in_.integrator.light_selection;
  if (selection == LightSelection::kPower) return false;
  const std::size_t count = tree_light_count();
  return count > (selection == LightSelection::kTree ? 1 : kFewestTreeLights - 1) &&
         count <= kMaxLatticeItems;
}

/// shares: of the emitters; those of the tree become 0. Returns theirs together.
double EmitterCompiler::add_light_tree(std::vector<double>& shares) {
  TreeLights tree;
  double whole = 0;
  const auto add = [&](LightBounds bounds, uint32_t emitter, uint32_t triangle, double area, double share) {
    if (share > 0) {
      bounds.power = share;
      tree.lights.push_back(static_cast<uint32_t>(out_.tree_lights.size()));
      tree.bounds.push_back(bounds);
    }
    out_.tree_lights.push_back({emitter, triangle, KB_NONE, static_cast<float>(area)});
  };
  for (uint32_t e = 0; e < out_.emitters.size(); ++e) {
    const KbEmitter& emitter = out_.emitters[e];
    out_.first_tree_light.push_back(static_cast<uint32_t>(out_.tree_lights.size()));
    if (!in_tree(emitter.type)) continue;
    whole += shares[e];
    if (!on_shape(emitter.type)) {
      add(position_bounds(emitter), e, 0, 0, shares[e]);
    } else if (const KbShape& shape = out_.shapes[emitter.shape]; shape.type != KB_SHAPE_MESH) {
      add(shape_bounds(shape), e, 0, shape.area, shares[e]);
    } else {
      double sum = 0;
      for (uint32_t i = 0; i < shape.triangle_count; ++i) sum += triangle_area(out_, shape, i);
      for (uint32_t i = 0; i < shape.triangle_count; ++i) {
        const double area = triangle_area(out_, shape, i);
        add(triangle_bounds(out_, shape, i), e, i, area, sum > 0 ? shares[e] * (area / sum) : 0);
      }
    }
    shares[e] = 0;
  }
  LightTree built = build_light_tree(tree.bounds);
  for (std::size_t i = 0; i < tree.lights.size(); ++i)
    out_.tree_lights[tree.lights[i]].leaf = built.leaves[i];
  for (KbLightNode& node : built.nodes) {
    if (node.light != KB_NONE) node.light = tree.lights[node.light];
  }
  out_.light_nodes = std::move(built.nodes);
  out_.features.light_tree = true;
  return whole;
}

}  // namespace kiloband
