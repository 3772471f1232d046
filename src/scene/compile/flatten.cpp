#include <fmt/format.h>

#include "scene/compile/flattener.hpp"

namespace kiloband {
namespace {

FlatScene scene_with_channels(const CompileOptions& options) {
  FlatScene scene;
  scene.channels = options.channels;
  scene.guide = options.guide.empty() ? options.channels : options.guide;
  return scene;
}

}  // namespace

void store_transform(const Transform& transform, float (&out)[12]) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      out[4 * row + column] = static_cast<float>(transform[column][row]);
    }
  }
}

Flattener::Flattener(const SceneDescription& description, const CompileOptions& options)
    : in_(description), options_(options), out_(scene_with_channels(options)), spectra_(out_, options.sink) {}

FlatScene Flattener::run() {
  out_.film = in_.sensor.film;
  out_.integrator = in_.integrator;
  check_places();
  set_origin();
  add_shapes();
  add_instances();
  compute_bounds();
  add_emitters();
  select_emitters();
  add_media();
  set_channel_scales();
  set_camera();
  set_channel_bins();
  add_spares();
  return std::move(out_);
}

/// See FlatScene.
void Flattener::add_spares() {
  out_.positions.push_back({0, 0, 0});
  if (!out_.normals.empty()) out_.normals.push_back({0, 0, 0});
  if (!out_.triangles.empty()) out_.triangles.push_back(0);
  if (!out_.principled_maps.empty())
    out_.principled_maps.resize(out_.materials.size() * KB_PRINCIPLED_MAPPED, KB_NONE);
}

std::shared_ptr<FlatScene> compile_scene_to_move(const SceneDescription& scene,
                                                 const CompileOptions& options) {
  if (options.channels.empty()) throw InputError("no channel to render");
  return std::make_shared<FlatScene>(Flattener(scene, options).run());
}

std::shared_ptr<const FlatScene> compile_scene(const SceneDescription& scene, const CompileOptions& options) {
  return compile_scene_to_move(scene, options);
}

std::vector<std::string> SceneFeatures::names() const {
  std::vector<std::string> present;
#define KB_ADD_NAME(macro, member, name) \
  if (member) present.emplace_back(name);
  KB_SCENE_FEATURES(KB_ADD_NAME)
#undef KB_ADD_NAME
  return present;
}

}  // namespace kiloband
