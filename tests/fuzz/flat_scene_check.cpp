#include "tests/fuzz/flat_scene_check.hpp"

#include <algorithm>
#include <cmath>

#include "scene/compile/flat_scene.hpp"
#include "scene/read/reader.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace kiloband::fuzz {
namespace {

bool finite(const std::vector<KbFloat3>& vectors) {
  return std::ranges::all_of(vectors, [](const KbFloat3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  });
}

void check_geometry(const FlatScene& scene) {
  const std::size_t vertices = scene.positions.size();
  promise(std::ranges::all_of(scene.triangles, [&](uint32_t i) { return i + 1 < vertices; }),
          "a triangle without its vertices");
  for (const KbShape& shape : scene.shapes)
    promise(shape.surface < scene.surfaces.size(), "a shape without a surface");
  promise(finite(scene.positions) && finite(scene.normals), "a vertex that is not finite");
  promise(std::isfinite(scene.scene_radius), "a scene without an end");
  promise(std::ranges::all_of(scene.area_cdf, [](float p) { return p >= 0 && p <= 1; }),
          "areas that are no probabilities");
}

void check_light(const FlatScene& scene) {
  const std::size_t trees = scene.first_tree_light.empty() ? 0 : 1;  // whose share comes first
  promise(scene.emitter_cdf.size() == scene.emitters.size() + 1 + trees, "emitters without probabilities");
  promise(std::ranges::is_sorted(scene.emitter_cdf), "probabilities that descend");
  for (const double scale : scene.channel_scale)
    promise(std::isfinite(scale) && scale > 0, "a channel without a scale");
  for (const SpectrumRow& row : scene.spectra) {
    promise(std::isfinite(row.bound), "a spectrum without a bound");
    promise(std::ranges::all_of(row.table.values, [](double v) { return std::isfinite(v); }),
            "a spectrum that is not finite");
  }
}

}  // namespace

void flatten_and_check(const SceneDescription& description, const ChannelList& channels) {
  const FlatScene scene = *compile_scene(description, {channels, {}, {}});
  promise(scene.channels.size() == channels.size() && scene.channel_scale.size() == channels.size(),
          "channels got lost");
  check_geometry(scene);
  check_light(scene);
}

void flatten_and_check(const std::string& elements, const ChannelList& channels) {
  const std::string text = "<scene version='3.0.0'><sensor type='perspective'/>" + elements + "</scene>";
  flatten_and_check(read_scene_text(text, "scene.xml", scratch_folder()), channels);
}

}  // namespace kiloband::fuzz
