// The flattened scene on the device, in the order of KB_SCENE_PARAMS (kernels/base/scene.clh).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "shared/pipeline.h"
#include "shared/spectra_layout.h"
#include "src_gpu/device/kernel.hpp"
#include "src_gpu/device/memory.hpp"
#include "src_gpu/geometry/bvh_builder.hpp"
#include "src_gpu/scene/channel_tables.hpp"

namespace kiloband::gpu {

/// The macros that specialise kernels for the scene: KB_SPECIALISED and KB_HAS_* for each feature. With
/// `specialised` false: none, everything is compiled in.
std::vector<std::string> scene_defines(const SceneFeatures& features, bool specialised);

/// What kernels read of a scene beside its arrays.
KbSceneConstants scene_constants(const FlatScene& scene);

/// The scene's arrays in device memory.
class DeviceScene {
 public:
  static constexpr uint32_t kArguments = 24;

  /// throws DeviceOutOfMemory naming the array that does not fit; DeviceLost, DeviceError
  DeviceScene(DeviceMemory& memory, const FlatScene& scene);

  /// Sets the kernel's arguments first .. first + kArguments - 1. The scene must outlive its launches.
  void bind(Kernel& kernel, uint32_t first) const;

  const DeviceBuffer<KbShape>& shapes() const { return shapes_; }
  const DeviceBuffer<KbMaterial>& materials() const { return materials_; }
  const DeviceBuffer<KbTexture>& textures() const { return textures_; }
  const DeviceBuffer<KbFloat4>& texels() const { return texels_; }
  const DeviceBuffer<float>& texel_values() const { return texel_values_; }
  const DeviceBuffer<float>& channel_bins() const { return channel_bins_; }

 private:
  DeviceBuffer<KbSceneConstants> constants_;
  DeviceBuffer<KbMaterial> materials_;
  DeviceBuffer<float> tables_;
  DeviceBuffer<KbSurface> surfaces_;
  DeviceBuffer<KbShape> shapes_;
  DeviceBuffer<KbTexture> textures_;
  DeviceBuffer<KbCheckerboard> checkerboards_;
  DeviceBuffer<KbFloat4> texels_;
  DeviceBuffer<float>
      texel_values_;  // of spectral textures; not among KB_SCENE_PARAMS: only evaluation reads them
  DeviceBuffer<float> texel_bounds_, spectrum_bounds_;
  DeviceBuffer<KbFloat3> normals_;
  DeviceBuffer<KbFloat2> uvs_;
  DeviceBuffer<KbFloat3> positions_;
  DeviceBuffer<uint32_t> triangles_;
  DeviceBuffer<float> area_cdf_;
  DeviceBuffer<KbEmitter> emitters_;
  DeviceBuffer<float> emitter_cdf_, envmap_marginal_, envmap_rows_;
  DeviceBuffer<KbMedium> media_;
  DeviceBuffer<KbFloat2> plume_nodes_;
  DeviceBuffer<uint32_t> interiors_;
  DeviceBuffer<KbFloat2> filter_table_;
  DeviceBuffer<float> channel_bins_;
  DeviceBuffer<KbThermal> thermals_;
};

/// The acceleration structure in device memory.
struct DeviceBvh {
  DeviceBvh(DeviceMemory& memory, const Bvh& bvh);

  DeviceBuffer<KbBvhNode> nodes;
  DeviceBuffer<KbPrimitive> primitives;
};

/// The spectra in device memory.
struct DeviceSpectra {
  DeviceSpectra(DeviceMemory& memory, const ChannelTables& spectra);

  DeviceBuffer<KbSpectraLayout> layout;
  DeviceBuffer<float> nodes;
  DeviceBuffer<KbChannelTable> tables;
  DeviceBuffer<uint32_t> materials;  // rows of optical constants, by material
  DeviceBuffer<KbCover> cover;
  DeviceBuffer<KbCoverBreak> cover_breaks;
};

}  // namespace kiloband::gpu
