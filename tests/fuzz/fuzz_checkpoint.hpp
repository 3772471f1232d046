// The film whose checkpoints are fuzzed.
#pragma once

#include <filesystem>

namespace kiloband::fuzz {

/// A checkpoint of that film with some samples in it.
void write_small_checkpoint(const std::filesystem::path& file);

}  // namespace kiloband::fuzz
