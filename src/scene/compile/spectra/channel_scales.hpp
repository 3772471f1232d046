// The scales of channels, by the largest values that anything in the scene emits.
#pragma once

#include <span>

#include "scene/compile/flat_scene.hpp"
#include "scene/compile/material/thermal.hpp"
#include "scene/compile/texture/textures.hpp"

namespace kiloband {

/// FlatScene::channel_scale. All rows and textures are there.
void set_channel_scales(FlatScene& scene, const EmissionPeaks& peaks, std::span<const Heat> heats);

}  // namespace kiloband
