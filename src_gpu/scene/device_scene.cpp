#include "src_gpu/scene/device_scene.hpp"

#include <algorithm>
#include <utility>

#include "film/filter_table.hpp"

namespace kiloband::opencl {
namespace {

/// The gaussian filter's table; other filters read none.
std::vector<KbFloat2> filter_nodes(const KbCamera& camera) {
  if (camera.filter != KB_FILTER_GAUSSIAN) return {};
  return make_gaussian_filter_table(static_cast<double>(camera.filter_radius) / camera.filter_stddev);
}

std::vector<float> bounds_of_rows(const FlatScene& scene) {
  std::vector<float> bounds;
  for (const SpectrumRow& row : scene.spectra) bounds.push_back(row.bound);
  return bounds;
}

/// The spectral texels of all textures, each at its first_value.
DeviceBuffer<float> upload_texel_values(DeviceMemory& memory, const FlatScene& scene) {
  uint64_t floats = 0;
  for (std::size_t t = 0; t < scene.spectral_texels.size(); ++t) {
    if (!scene.spectral_texels[t]) continue;
    const uint64_t first = uint64_t{scene.textures[t].first_value} * KB_VALUE_UNIT;
    floats = std::max(floats, first + scene.spectral_texels[t]->size());
  }
  DeviceBuffer<float> buffer = memory.allocate<float>("spectral texels", floats);
  for (std::size_t t = 0; t < scene.spectral_texels.size(); ++t) {
    if (!scene.spectral_texels[t]) continue;
    buffer.upload(std::span<const float>(*scene.spectral_texels[t]),
                  uint64_t{scene.textures[t].first_value} * KB_VALUE_UNIT);
  }
  return buffer;
}

}  // namespace

std::vector<std::string> scene_defines(const SceneFeatures& f, bool specialised) {
  if (!specialised) return {};
  std::vector<std::string> defines{"KB_SPECIALISED"};
#define KB_ADD_DEFINE(macro, member, name) \
  defines.push_back(std::string("KB_HAS_" #macro "=") + (f.member ? "1" : "0"));
  KB_SCENE_FEATURES(KB_ADD_DEFINE)
#undef KB_ADD_DEFINE
  return defines;
}

KbSceneConstants scene_constants(const FlatScene& scene) {
  KbSceneConstants c{};
  c.camera = scene.camera;
  c.channels = static_cast<uint32_t>(scene.channels.size());
  c.emitter_count = static_cast<uint32_t>(scene.emitters.size());
  c.environment = scene.environment;
  c.max_depth = scene.integrator.max_depth < 0 ? KB_NONE : static_cast<uint32_t>(scene.integrator.max_depth);
  c.rr_depth = static_cast<uint32_t>(scene.integrator.rr_depth);
  c.hide_emitters = scene.integrator.hide_emitters ? 1 : 0;
  c.unit_row = scene.unit_row;
  c.envmap_width = scene.envmap.width;
  c.envmap_height = scene.envmap.height;
  c.atmosphere = scene.atmosphere;
  std::ranges::copy(scene.camera_media, c.camera_media);
  c.gas = scene.features.gas ? 1 : 0;
  if (scene.camera.filter == KB_FILTER_GAUSSIAN)
    c.filter_ratio = scene.camera.filter_radius / scene.camera.filter_stddev;
  return c;
}

DeviceScene upload_scene(DeviceMemory& memory, const FlatScene& scene) {
  return {
      .constants = memory.upload("scene constants", std::vector{scene_constants(scene)}),
      .materials = memory.upload("materials", scene.materials),
      .tables = memory.upload("tables", scene.tables),
      .surfaces = memory.upload("surfaces", scene.surfaces),
      .shapes = memory.upload("shapes", scene.shapes),
      .textures = memory.upload("textures", scene.textures),
      .checkerboards = memory.upload("checkerboards", scene.checkerboards),
      .texels = memory.upload("texels", scene.texels),
      .texel_values = upload_texel_values(memory, scene),
      .texel_bounds = memory.upload("texel bounds", scene.texel_bounds),
      .spectrum_bounds = memory.upload("spectrum bounds", bounds_of_rows(scene)),
      .normals = memory.upload("normals", scene.normals),
      .uvs = memory.upload("texture coordinates", scene.uvs),
      .positions = memory.upload("positions", scene.positions),
      .triangles = memory.upload("triangles", scene.triangles),
      .area_cdf = memory.upload("area distribution", scene.area_cdf),
      .emitters = memory.upload("emitters", scene.emitters),
      .emitter_cdf = memory.upload("emitter distribution", scene.emitter_cdf),
      .envmap_marginal = memory.upload("environment rows", scene.envmap.marginal_cdf),
      .envmap_rows = memory.upload("environment distribution", scene.envmap.row_cdf),
      .media = memory.upload("media", scene.media),
      .plume_nodes = memory.upload("plumes", scene.plume_nodes),
      .interiors = memory.upload("interiors", scene.interiors),
      .filter_table = memory.upload("filter table", filter_nodes(scene.camera)),
      .channel_bins = memory.upload("reflectances by channel bins", scene.channel_bins),
      .thermals = memory.upload("thermal emission", scene.thermals),
  };
}

DeviceBvh upload_bvh(DeviceMemory& memory, const Bvh& bvh) {
  return {.nodes = memory.upload("acceleration structure", bvh.nodes),
          .primitives = memory.upload("primitives", bvh.primitives)};
}

DeviceSpectra upload_spectra(DeviceMemory& memory, const ChannelTables& spectra) {
  return {.layout = memory.upload("spectra layout", std::vector{spectra.layout}),
          .nodes = memory.upload("spectra", spectra.nodes),
          .tables = memory.upload("spectra rows", spectra.tables),
          .material_rows = memory.upload("rows of materials", spectra.material_rows),
          .cover = memory.upload("channel cover", spectra.cover),
          .cover_breaks = memory.upload("breaks of channel cover", spectra.cover_breaks)};
}

}  // namespace kiloband::opencl
