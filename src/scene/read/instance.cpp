// <shape type="shapegroup"> and <shape type="instance">
#include "scene/read/context.hpp"

namespace kiloband {
namespace {

/// What instances cannot repeat: lights are listed one by one, media follow the shapes that bound them.
void check_member(const ObjectReader& group, const Node& node, const Shape& shape) {
  const auto refuse = [&](const std::string& what) {
    fail(node.place, group.label() + ": a shape of a group cannot " + what +
                         ": write it into the scene, outside the group");
  };
  if (shape.emitter || shape.thermal) refuse("emit");
  if (shape.interior) refuse("have an interior medium");
  if (std::holds_alternative<NullBsdf>(shape.bsdf->model)) refuse("have a null bsdf");
}

/// The shapes of a group, those of merges one by one.
std::vector<Node*> members(const ObjectReader& group) {
  std::vector<Node*> found;
  for (Node* member : group.nested("shape")) {
    if (member->type != "merge") {
      found.push_back(member);
      continue;
    }
    const std::vector<Node*> merged = merged_shapes(*member);
    found.insert(found.end(), merged.begin(), merged.end());
  }
  return found;
}

}  // namespace

std::vector<Node*> merged_shapes(Node& node) {
  const ObjectReader object(node);
  std::vector<Node*> shapes = object.nested("shape");
  if (shapes.empty()) object.fail_here("has no shapes");
  for (const Node* shape : shapes)
    if (shape->type == "merge" || shape->type == "shapegroup" || shape->type == "instance")
      fail(shape->place, object.label() + ": shapes of type " + shape->type + " cannot be merged");
  object.finish();
  return shapes;
}

std::shared_ptr<const ShapeGroup> read_shape_group(ReadContext& context, Node& node) {
  const ObjectReader object(node);
  const auto [known, is_new] = context.groups.try_emplace(&node);
  if (!is_new && !known->second) object.fail_here("contains an instance of itself");
  if (!is_new) return known->second;
  const auto forget = [&] { context.groups.erase(&node); };
  try {
    auto group = std::make_shared<ShapeGroup>();
    group->id = node.id;
    group->position = node.place.position();
    for (Node* member : members(object)) {
      if (member->type == "shapegroup")
        fail(member->place, object.label() + ": a group in a group: write an instance of it");
      if (member->type == "instance") {
        group->instances.push_back(read_instance(context, *member));
        group->has_analytic_shapes |= group->instances.back().group->has_analytic_shapes;
      } else {
        group->shapes.push_back(read_shape(context, *member));
        check_member(object, *member, group->shapes.back());
        group->has_analytic_shapes |= !std::holds_alternative<MeshShape>(group->shapes.back().geometry);
      }
    }
    if (group->shapes.empty() && group->instances.empty()) object.fail_here("has no shapes");
    object.finish();
    return context.groups[&node] = group;
  } catch (...) {
    forget();
    throw;
  }
}

Instance read_instance(ReadContext& context, Node& node) {
  const ObjectReader object(node);
  Instance instance;
  instance.id = node.id;
  instance.position = node.place.position();
  instance.to_world = object.get_transform("to_world");
  Node* group = object.nested_one("shape");
  if (!group || group->type != "shapegroup")
    object.fail_here("needs one shape of type 'shapegroup', or a reference to one");
  instance.group = read_shape_group(context, *group);
  if (instance.group->has_analytic_shapes && !is_similarity(glm::dmat3(instance.to_world)))
    object.fail_at("to_world",
                   "to_world must not stretch or shear a group with spheres, disks or cylinders: use meshes");
  object.finish();
  return instance;
}

}  // namespace kiloband
