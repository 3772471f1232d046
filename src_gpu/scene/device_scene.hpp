// The compiled scene on the device.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "shared/pipeline.h"
#include "shared/spectra_layout.h"
#include "src_gpu/device/kernel_groups.hpp"
#include "src_gpu/device/memory.hpp"
#include "src_gpu/geometry/bvh_builder.hpp"
#include "src_gpu/scene/channel_tables.hpp"

namespace kiloband::opencl {

/// The macros that specialise kernels for the scene: KB_SPECIALISED and KB_HAS_* for each feature. With
/// `specialised` false: none, everything is compiled in.
std::vector<std::string> scene_defines(const SceneFeatures& features, bool specialised);

/// The scene's arrays, the acceleration structure and the spectra in device memory.
using DeviceScene = SceneArguments::Of<DeviceBuffer>;
using DeviceBvh = BvhArguments::Of<DeviceBuffer>;
using DeviceSpectra = SpectraArguments::Of<DeviceBuffer>;

/// throws, all three: DeviceOutOfMemory naming the array that does not fit; DeviceLost, DeviceError
DeviceScene upload_scene(DeviceMemory& memory, const FlatScene& scene);
DeviceBvh upload_bvh(DeviceMemory& memory, const Bvh& bvh);
DeviceSpectra upload_spectra(DeviceMemory& memory, const ChannelTables& spectra);

}  // namespace kiloband::opencl
