// Shapes and instances to records, vertices and triangles. Internal to src/scene.
#pragma once

#include <map>
#include <vector>

#include "scene/compile/light/emitters.hpp"
#include "scene/compile/material/surfaces.hpp"

namespace kiloband {

class ShapeCompiler {
 public:
  ShapeCompiler(const CompileContext& context, SurfaceCompiler& surfaces, ThermalCompiler& thermal,
                EmitterCompiler& emitters);

  /// The scene's own, with the lights that they are.
  /// throws InputError  more than indices can name, or what their bsdfs say
  void add_shapes();
  void add_instances();
  /// FlatScene::scene_radius of what was added.
  void set_radius();
  /// By record.
  const std::vector<const Shape*>& sources() const { return sources_; }

 private:
  struct FlatMesh {
    const Shape* shape;
    KbShape record;  // without transforms
  };
  /// A group whose meshes are stored.
  struct FlatGroup {
    uint32_t index = KB_NONE;  // of FlatScene::groups
    glm::dvec3 middle{0};      // of the group's coordinates: where those of its meshes begin
    std::vector<FlatMesh> meshes;
  };
  KbShape begin_shape(const Shape& shape, uint32_t heat);
  void add_record(const KbShape& record, const Shape& shape, const std::string& instance);
  void add_analytic(const Shape& shape, uint32_t heat, const Transform& to_world,
                    const std::string& instance);
  void add_mesh(KbShape& record, const Shape& shape, const Transform& to_world);
  void add_areas(KbShape& record, const Shape& shape);
  // instances.cpp
  const FlatGroup& flat_group(const ShapeGroup& group);
  /// to_world: of the scene, m
  void add_instance(const Instance& instance, const Transform& to_world);

  const SceneDescription& in_;
  FlatScene& out_;
  CurrentMesh& current_;
  GroupExtents& extents_;
  SurfaceCompiler& surfaces_;
  ThermalCompiler& thermal_;
  EmitterCompiler& emitters_;
  std::vector<const Shape*> sources_;
  std::size_t plain_positions_ = 0;  // those that follow are of groups, in coordinates of their own
  std::map<const ShapeGroup*, FlatGroup> flat_groups_;
};

}  // namespace kiloband
