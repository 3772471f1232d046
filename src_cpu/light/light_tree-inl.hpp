// The walk down the light tree (shared/light_tree.h has the mathematics).
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_LIGHT_TREE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_LIGHT_TREE_INL
#undef KILOBAND_LIGHT_TREE_INL
#else
#define KILOBAND_LIGHT_TREE_INL
#endif

#include "scene/compile/flat_scene.hpp"
#include "src_cpu/lanes/lane_access-inl.hpp"
#include "src_cpu/lanes/lane_math-inl.hpp"
#include "src_cpu/lanes/vector3-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// What choosing reads of a node, and where its right child is.
struct LightNode {
  V3 centre, axis;
  F power, cos_cone, sin_cone, radius2;
  U right, light;
};
KB_INLINE LightNode gather_light_node(const KbLightNode* nodes, U index) {
  static_assert(offsetof(KbLightNode, axis) == 16 && offsetof(KbLightNode, sin_cone) == 32);
  const Addresses at(nodes, index);
  U a[4], b[4], c[4];
  at.load(0, a);
  at.load(16, b);
  at.load(32, c);
  const auto vector = [](const U(&w)[4]) KB_LAMBDA {
    return V3{as_floats(w[0]), as_floats(w[1]), as_floats(w[2])};
  };
  return {vector(a), vector(b), as_floats(a[3]), as_floats(b[3]), as_floats(c[0]), as_floats(c[1]),
          c[2],      c[3]};
}

/// The cosine of max(0, a - b) for angles of at most pi, and its sine.
struct Turn {
  F cosine, sine;
};
KB_INLINE Turn turn_back(Turn a, Turn b) {
  const M none = a.cosine >= b.cosine;
  return {select(none, F(1), a.cosine * b.cosine + a.sine * b.sine),
          select(none, F(0), a.sine * b.cosine - a.cosine * b.sine)};
}

/// What a node counts at a point: >= 0.
KB_INLINE F importance(const LightNode& node, V3 point) {
  const V3 to_node = node.centre - point;
  const F distance2 = dot(to_node, to_node);
  const F beyond = max(distance2, node.radius2);
  const F cosine = min(max(-dot(node.axis, to_node) / sqrt(distance2), F(-1)), F(1));
  const F seen2 = node.radius2 / beyond;  // the squared sine of the angle under which it is seen
  const Turn off_cone = turn_back({cosine, sqrt(F(1) - cosine * cosine)}, {node.cos_cone, node.sin_cone});
  const Turn least = turn_back(off_cone, {sqrt(F(1) - seen2), sqrt(seen2)});
  const M everywhere = (distance2 <= node.radius2) | (node.cos_cone <= F(-1));
  return node.power * select(everywhere, F(1), max(least.cosine, F(0))) / beyond;
}

/// A walk down the tree, at `node` with n steps left, each of probability `step`.
struct LightWalk {
  U node;
  F n, step;
  U splits;
};
KB_INLINE LightWalk begin_light_walk(const FlatScene& scene) {
  return {U(0u), F(scene.emitter_cdf[1] * 0x1p24f), F(0x1p-24f), U(0u)};
}

/// Which lanes' steps are split before they go on.
KB_INLINE M split_steps(LightWalk& walk, M going) {
  const M few = going & (walk.n < F(KB_LIGHT_STEPS)) & !(walk.splits == U(KB_LIGHT_SPLITS));
  walk.n = select(few, walk.n * F(KB_LIGHT_FINER), walk.n);
  walk.step = select(few, walk.step * F(1 / KB_LIGHT_FINER), walk.step);
  walk.splits = walk.splits + select(few, U(1u), U(0u));
  return few;
}

/// How many of the steps go to the left child.
KB_INLINE F left_steps(const LightNode& left, const LightNode& right, F n, V3 point) {
  const F a = importance(left, point), b = importance(right, point);
  const F share = a / (a + b);
  const F p = select((share >= F(0)) & (share <= F(1)), share, F(0.5f));
  return max(min(floor(n * p), n - F(1)), F(1));
}

/// A light and the probability with which it is chosen.
struct ChosenTreeLight {
  U light;
  F probability;
};
/// u: which of the 2^24 steps, below the tree's share; v: the bits that split steps.
KB_INLINE ChosenTreeLight choose_tree_light(const FlatScene& scene, V3 point, F u, F v, M active) {
  const KbLightNode* nodes = scene.light_nodes.data();
  LightWalk walk = begin_light_walk(scene);
  F k = u * F(0x1p24f);
  U bits = to_words(v * F(0x1p24f));
  LightNode here = gather_light_node(nodes, walk.node);
  for (;;) {
    const M going = active & !(here.right == U(KB_NONE));
    if (!any(going)) break;
    const M few = split_steps(walk, going);
    k = select(few, k * F(KB_LIGHT_FINER) + to_floats(shift_right<16>(bits)), k);
    bits = select(few, shift_left<8>(bits) & U(0xffffffu), bits);
    const U first = select(going, walk.node + U(1u), walk.node);
    const U second = select(going, here.right, walk.node);
    const LightNode left = gather_light_node(nodes, first), right = gather_light_node(nodes, second);
    const F given = left_steps(left, right, walk.n, point);
    const M goes_left = k < given;
    walk.n = select(going, select(goes_left, given, walk.n - given), walk.n);
    k = select(going & !goes_left, k - given, k);
    walk.node = select(goes_left, first, second);
    here.right = select(going, select(goes_left, left.right, right.right), here.right);
    here.light = select(going, select(goes_left, left.light, right.light), here.light);
  }
  return {here.light, walk.n * walk.step};
}

/// The probability with which the light of a leaf is chosen. leaf: of active lanes
KB_INLINE F tree_probability(const FlatScene& scene, V3 point, U leaf, M active) {
  const KbLightNode* nodes = scene.light_nodes.data();
  LightWalk walk = begin_light_walk(scene);
  U right_child = gather_light_node(nodes, walk.node).right;
  for (;;) {
    const M going = active & !(walk.node == leaf) & !(right_child == U(KB_NONE));
    if (!any(going)) break;
    split_steps(walk, going);
    const U first = select(going, walk.node + U(1u), walk.node);
    const U second = select(going, right_child, walk.node);
    const LightNode left = gather_light_node(nodes, first), right = gather_light_node(nodes, second);
    const F given = left_steps(left, right, walk.n, point);
    const M goes_left = has_bits(leaf - second, 0x80000000u);  // leaf < second: both are below 2^31
    walk.n = select(going, select(goes_left, given, walk.n - given), walk.n);
    walk.node = select(goes_left, first, second);
    right_child = select(going, select(goes_left, left.right, right.right), right_child);
  }
  return select(active, walk.n * walk.step, F(0));
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
