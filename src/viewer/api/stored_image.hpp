// A cube from a file, as a page looks at it.
#pragma once

#include <filesystem>
#include <memory>

#include "viewer/api/viewed_image.hpp"

namespace kiloband::viewer {

/// Reads the whole cube: into memory up to `memory_bytes`, else into a scratch file.
/// threads: that may compute what is shown
/// throws InputError, DeviceError
std::unique_ptr<ViewedImage> open_stored_image(const std::filesystem::path& file, std::size_t memory_bytes,
                                               unsigned threads, const DiagnosticSink& sink);

}  // namespace kiloband::viewer
