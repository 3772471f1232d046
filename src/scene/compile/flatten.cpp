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
  compute_bounds();
  add_emitters();
  select_emitters();
  add_media();
  set_channel_scales();
  set_camera();
  set_channel_bins();
  out_.positions.push_back({0, 0, 0});  // see FlatScene
  return std::move(out_);
}

std::shared_ptr<const FlatScene> compile_scene(const SceneDescription& scene, const CompileOptions& options) {
  if (options.channels.empty()) throw InputError("no channel to render");
  return std::make_shared<const FlatScene>(Flattener(scene, options).run());
}

std::vector<std::string> SceneFeatures::names() const {
  const std::pair<const char*, bool> all[] = {{"diffuse", diffuse},
                                              {"conductor", conductor},
                                              {"roughconductor", rough_conductor},
                                              {"dielectric", dielectric},
                                              {"roughdielectric", rough_dielectric},
                                              {"plastic", plastic},
                                              {"roughplastic", rough_plastic},
                                              {"twosided", two_sided},
                                              {"mask", mask},
                                              {"blend", blend},
                                              {"dispersion", dispersion},
                                              {"bitmap", bitmap},
                                              {"checkerboard", checkerboard},
                                              {"spectral texture", spectral_texture},
                                              {"area light", area_light},
                                              {"constant environment", constant_light},
                                              {"environment map", envmap_light},
                                              {"delta light", delta_light},
                                              {"analytic shapes", analytic_shapes},
                                              {"thermal emission", thermal},
                                              {"energy compensation", compensation},
                                              {"temperature field", temperature_field},
                                              {"gas", gas},
                                              {"plume", plume}};
  std::vector<std::string> present;
  for (const auto& [name, is_present] : all) {
    if (is_present) present.emplace_back(name);
  }
  return present;
}

}  // namespace kiloband
