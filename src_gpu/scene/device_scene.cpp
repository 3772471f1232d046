#include "src_gpu/scene/device_scene.hpp"

#include <algorithm>
#include <utility>

#include "src_gpu/scene/scene_arguments.hpp"

namespace kiloband::opencl {
namespace {

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

DeviceScene upload_scene(DeviceMemory& memory, const FlatScene& scene) {
  DeviceScene device = scene_arguments<DeviceBuffer>(
      scene, [&](const char* name, const auto& values) { return memory.upload(name, values); });
  device.texel_values = upload_texel_values(memory, scene);
  return device;
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
