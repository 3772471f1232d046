// A render that goes on while it is looked at.
#pragma once

#include <memory>

#include "viewer/api/viewed_image.hpp"
#include "viewer/live/live_settings.hpp"

namespace kiloband::viewer {

/// Of a pixel; LiveFilm::most_samples().
inline constexpr uint64_t kMostLiveSamples = 15120;

/// Compiles and renders on a thread of its own; what goes wrong there is told by status().
std::unique_ptr<ViewedImage> start_live_render(LiveOptions options);

}  // namespace kiloband::viewer
