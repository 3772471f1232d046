#include "src_gpu/geometry/bvh_builder.hpp"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <thread>
#include <type_traits>

#include "base/error.hpp"
#include "base/foreign_order.hpp"
#include "base/threads.hpp"
#include "src_gpu/geometry/bvh_primitives.hpp"

namespace kiloband::opencl {
namespace {

constexpr unsigned kMaxDepth = 64;   // Embree's builder adds up to 8 levels of forced leaves, then fails
constexpr float kTraversalCost = 1;  // of a node, relative to kIntersectionCost of a primitive
constexpr float kIntersectionCost = 1;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// ---- the tree as Embree's builder makes it, in its own memory -------------------------------------------

struct BuildNode {
  uint32_t count;  // inner: children; leaf: primitives
  bool leaf;
};
struct BuildInner : BuildNode {
  BuildNode* children[KB_BVH_WIDTH];
  Box boxes[KB_BVH_WIDTH];
};
struct BuildLeaf : BuildNode {
  uint32_t primitives[KB_BVH_LEAF];
};

/// The callbacks run on threads of TBB's, of which each follows those that made what it reads.
char build_order;

void* create_node(RTCThreadLocalAllocator allocator, unsigned children, void*) {
  const ForeignOrder order(build_order);
  auto* node = static_cast<BuildInner*>(rtcThreadLocalAlloc(allocator, sizeof(BuildInner), 16));
  node->count = children;
  node->leaf = false;
  return node;
}

void set_children(void* node, void** children, unsigned count, void*) {
  const ForeignOrder order(build_order);
  auto* inner = static_cast<BuildInner*>(node);
  for (unsigned i = 0; i < count; ++i) inner->children[i] = static_cast<BuildNode*>(children[i]);
}

void set_boxes(void* node, const RTCBounds** bounds, unsigned count, void*) {
  const ForeignOrder order(build_order);
  auto* inner = static_cast<BuildInner*>(node);
  for (unsigned i = 0; i < count; ++i) {
    const RTCBounds& b = *bounds[i];
    inner->boxes[i] = {{b.lower_x, b.lower_y, b.lower_z}, {b.upper_x, b.upper_y, b.upper_z}};
  }
}

/// Ids are sorted: their order in Embree's array depends on its threads.
void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t count,
                  void*) {
  const ForeignOrder order(build_order);
  auto* leaf = static_cast<BuildLeaf*>(rtcThreadLocalAlloc(allocator, sizeof(BuildLeaf), 16));
  leaf->count = static_cast<uint32_t>(count);
  leaf->leaf = true;
  for (std::size_t i = 0; i < count; ++i) leaf->primitives[i] = primitives[i].primID;
  std::sort(leaf->primitives, leaf->primitives + count);
  return leaf;
}

// ---- Embree's handles -----------------------------------------------------------------------------------

struct Release {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCBVH bvh) const { rtcReleaseBVH(bvh); }
};
template <class T>
using Handle = std::unique_ptr<std::remove_pointer_t<T>, Release>;

std::vector<RTCBuildPrimitive> build_input(const std::vector<KbPrimitive>& primitives, const FlatScene& scene,
                                           const std::vector<Box>& groups) {
  std::vector<RTCBuildPrimitive> input(primitives.size());  // 32-byte aligned, as the type is
  for (std::size_t i = 0; i < input.size(); ++i) {
    const Box box = primitive_box(primitives[i], scene, groups);
    input[i] = {box.low[0],  box.low[1],  box.low[2],  0,
                box.high[0], box.high[1], box.high[2], static_cast<unsigned>(i)};
  }
  return input;
}

Box box_of(const std::vector<RTCBuildPrimitive>& input) {
  Box box = {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (const RTCBuildPrimitive& p : input) {
    const float low[3] = {p.lower_x, p.lower_y, p.lower_z}, high[3] = {p.upper_x, p.upper_y, p.upper_z};
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], low[axis]);
      box.high[axis] = std::max(box.high[axis], high[axis]);
    }
  }
  return box;
}

/// input is reordered. The tree lives as long as `bvh`. nullptr: Embree failed
const BuildNode* build_tree(RTCBVH bvh, std::vector<RTCBuildPrimitive>& input) {
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
  arguments.maxBranchingFactor = KB_BVH_WIDTH;
  arguments.maxDepth = kMaxDepth;
  arguments.maxLeafSize = KB_BVH_LEAF;
  arguments.traversalCost = kTraversalCost;
  arguments.intersectionCost = kIntersectionCost;
  arguments.bvh = bvh;
  arguments.primitives = input.data();
  arguments.primitiveCount = arguments.primitiveArrayCapacity = input.size();
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_boxes;
  arguments.createLeaf = create_leaf;
  const ForeignOrder order(build_order);
  order.pass();
  const void* root = rtcBuildBVH(&arguments);
  order.pass();
  return static_cast<const BuildNode*>(root);
}

// ---- flattening -----------------------------------------------------------------------------------------

/// One unit in the last place outward: a flat box has a thickness, so that rays within its plane do not fall
/// through the rounding of its two slabs.
void set_box(KbBvhNode& node, uint32_t child, const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    node.plane[axis][child] = std::nextafter(box.low[axis], -kInfinity);
    node.plane[3 + axis][child] = std::nextafter(box.high[axis], kInfinity);
  }
}

/// Children that no ray enters: their boxes are empty along every axis.
KbBvhNode empty_node() {
  KbBvhNode node{};
  const Box empty = {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (uint32_t child = 0; child < KB_BVH_WIDTH; ++child) {
    set_box(node, child, empty);
    node.child[child] = KB_BVH_NO_CHILD;
  }
  return node;
}

/// Depth first, in the order of the children.
class Flattener {
 public:
  Flattener(const std::vector<KbPrimitive>& source, Bvh& bvh) : source_(source), bvh_(bvh) {
    bvh.primitives.reserve(bvh.primitives.size() + source.size());
  }

  void add_root(const BuildNode& root, const Box& box) {
    if (!root.leaf) {
      add_inner(static_cast<const BuildInner&>(root), 1);
      return;
    }
    const std::size_t at = bvh_.nodes.size();
    bvh_.nodes.push_back(empty_node());
    bvh_.depth = std::max(bvh_.depth, 1u);
    set_box(bvh_.nodes[at], 0, box);
    add_child(at, 0, root, 1);
  }

 private:
  void add_child(std::size_t parent, uint32_t slot, const BuildNode& child, uint32_t depth) {
    const auto index = static_cast<uint32_t>(child.leaf ? bvh_.primitives.size() : bvh_.nodes.size());
    bvh_.nodes[parent].child[slot] = child.leaf ? KB_BVH_LEAF_OF(index, child.count) : index;
    if (!child.leaf) return add_inner(static_cast<const BuildInner&>(child), depth + 1);
    const auto& leaf = static_cast<const BuildLeaf&>(child);
    for (uint32_t i = 0; i < leaf.count; ++i) bvh_.primitives.push_back(source_[leaf.primitives[i]]);
  }

  void add_inner(const BuildInner& inner, uint32_t depth) {
    const std::size_t at = bvh_.nodes.size();
    bvh_.nodes.push_back(empty_node());
    bvh_.depth = std::max(bvh_.depth, depth);
    for (uint32_t i = 0; i < inner.count; ++i) {
      set_box(bvh_.nodes[at], i, inner.boxes[i]);
      add_child(at, i, *inner.children[i], depth);
    }
  }

  const std::vector<KbPrimitive>& source_;
  Bvh& bvh_;
};

[[noreturn]] void fail(RTCDevice device) {
  throw DeviceError(fmt::format("Embree: building the acceleration structure failed (error {})",
                                static_cast<int>(rtcGetDeviceError(device))));
}

/// TBB, which Embree runs on, ends the process where it cannot have its threads.
void check_threads(int threads) {
  const unsigned all = threads > 0 ? static_cast<unsigned>(threads) : std::thread::hardware_concurrency();
  require_threads(std::max(2u, all) - 1, "Embree", "use fewer processors (taskset)");
}

/// Appends trees to a Bvh.
class Builder {
 public:
  Builder(const FlatScene& scene, int threads, const std::vector<Box>& groups)
      : scene_(scene), groups_(groups), threads_(threads) {}

  /// Returns the root's number.
  uint32_t add(const std::vector<KbPrimitive>& primitives) {
    if (bvh_.primitives.size() + primitives.size() > KB_BVH_MAX_PRIMITIVES)
      throw DeviceError(fmt::format("acceleration structure: {} primitives: at most {} fit its indices",
                                    bvh_.primitives.size() + primitives.size(), KB_BVH_MAX_PRIMITIVES));
    const auto root = static_cast<uint32_t>(bvh_.nodes.size());
    if (primitives.empty()) {
      bvh_.nodes.push_back(empty_node());
      bvh_.depth = std::max(bvh_.depth, 1u);
      return root;
    }
    const Handle<RTCBVH> tree(rtcNewBVH(device()));
    if (!tree) fail(device());
    std::vector<RTCBuildPrimitive> input = build_input(primitives, scene_, groups_);
    const BuildNode* top = build_tree(tree.get(), input);
    if (!top) fail(device());
    Flattener(primitives, bvh_).add_root(*top, box_of(input));
    return root;
  }

  Bvh finish(const std::vector<uint32_t>& roots) {
    for (KbPrimitive& primitive : bvh_.primitives)
      if (primitive.analytic == KB_PRIMITIVE_INSTANCE) primitive.primitive = roots[primitive.primitive];
    return std::move(bvh_);
  }

 private:
  RTCDevice device() {
    if (device_) return device_.get();
    check_threads(threads_);
    device_.reset(rtcNewDevice(fmt::format("threads={}", threads_).c_str()));
    if (!device_) fail(nullptr);
    return device_.get();
  }

  const FlatScene& scene_;
  const std::vector<Box>& groups_;
  int threads_;
  Handle<RTCDevice> device_;
  Bvh bvh_;
};

Box box_of(const std::vector<KbPrimitive>& primitives, const FlatScene& scene) {
  return box_of(build_input(primitives, scene, {}));
}

}  // namespace

Bvh build_bvh(const FlatScene& scene, int threads) {
  std::vector<std::vector<KbPrimitive>> groups;
  std::vector<Box> boxes;
  for (const MeshGroup& group : scene.groups) {
    groups.push_back(collect_group(scene, group));
    boxes.push_back(box_of(groups.back(), scene));
  }
  Builder builder(scene, threads, boxes);
  builder.add(collect_primitives(scene, boxes));
  std::vector<uint32_t> roots;
  for (const std::vector<KbPrimitive>& group : groups) roots.push_back(builder.add(group));
  return builder.finish(roots);
}

}  // namespace kiloband::opencl
