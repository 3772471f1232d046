#include <fmt/format.h>

#include "scene/compile/camera.hpp"
#include "scene/compile/media.hpp"
#include "scene/compile/place.hpp"
#include "scene/compile/shapes.hpp"
#include "scene/compile/spectra/channel_bins.hpp"
#include "scene/compile/spectra/channel_scales.hpp"

namespace kiloband {
namespace {

FlatScene scene_with_channels(const CompileOptions& options) {
  FlatScene scene;
  scene.channels = options.channels;
  scene.guide = options.guide.empty() ? options.channels : options.guide;
  return scene;
}

/// See FlatScene.
void add_spares(FlatScene& scene) {
  scene.positions.push_back({0, 0, 0});
  if (!scene.normals.empty()) scene.normals.push_back({0, 0, 0});
  if (!scene.triangles.empty()) scene.triangles.push_back(0);
  if (!scene.principled_maps.empty())
    scene.principled_maps.resize(scene.materials.size() * KB_PRINCIPLED_MAPPED, KB_NONE);
}

/// Each kind of thing has a compiler of its own that adds to the one scene. Shapes come first: with them their surfaces,
/// materials and textures, and how large the scene is, which lights without a shape depend on.
FlatScene flatten(const SceneDescription& description, const CompileOptions& options) {
  FlatScene scene = scene_with_channels(options);
  scene.film = description.sensor.film;
  scene.integrator = description.integrator;
  SpectrumTableBuilder spectra(scene, options.sink);
  CurrentMesh mesh;
  GroupExtents extents;
  const CompileContext context{description, options, scene, spectra, mesh, extents};
  TextureCompiler textures(context);
  MaterialCompiler materials(context, textures);
  ThermalCompiler thermal(context, textures, materials);
  SurfaceCompiler surfaces(context, textures, materials, thermal);
  EmitterCompiler emitters(context, textures, thermal);
  ShapeCompiler shapes(context, surfaces, thermal, emitters);

  check_places(description, extents, options.sink);
  scene.origin = origin_of(description, extents);
  shapes.add_shapes();
  shapes.add_instances();
  shapes.set_radius();
  emitters.add_emitters();
  emitters.select_emitters();
  MediumCompiler(context, shapes.sources()).add_media();
  set_channel_scales(scene, textures.peaks(), thermal.heats());
  set_camera(scene, description.sensor);
  set_channel_bins(scene);
  add_spares(scene);
  return scene;
}

}  // namespace

std::shared_ptr<FlatScene> compile_scene_to_move(const SceneDescription& scene,
                                                 const CompileOptions& options) {
  if (options.channels.empty()) throw InputError("no channel to render");
  return std::make_shared<FlatScene>(flatten(scene, options));
}

std::shared_ptr<const FlatScene> compile_scene(const SceneDescription& scene, const CompileOptions& options) {
  return compile_scene_to_move(scene, options);
}

std::vector<std::string> SceneFeatures::names() const {
  std::vector<std::string> present;
#define KB_ADD_NAME(macro, member, name) \
  if (member) present.emplace_back(name);
  KB_SCENE_FEATURES(KB_ADD_NAME)
  KB_SCENE_NOTES(KB_ADD_NAME)
#undef KB_ADD_NAME
  return present;
}

}  // namespace kiloband
