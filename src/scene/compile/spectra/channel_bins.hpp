// Reflectances in a few bins of channels, for scenes with dispersion.
#pragma once

#include "scene/compile/flat_scene.hpp"

namespace kiloband {

/// Where the channel that survives a dispersive refraction is chosen by what each can still carry, the
/// reflectances on the path so far are followed in a few bins of channels: FlatScene::channel_bins.
void set_channel_bins(FlatScene& scene);

}  // namespace kiloband
