// Scenes flattened, and what every flat scene must keep to.
#pragma once

#include <string>

#include "scene/description/description.hpp"

namespace kiloband::fuzz {

/// throws std::logic_error  the flat scene breaks a promise of flat_scene.hpp
void flatten_and_check(const SceneDescription& description, const ChannelList& channels);

/// The same for a scene of these elements with a camera;
/// file names are relative to the folder of scratch files.
void flatten_and_check(const std::string& elements, const ChannelList& channels);

}  // namespace kiloband::fuzz
