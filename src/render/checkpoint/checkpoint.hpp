// Checkpoints: the sums of an unfinished render, to go on from later with the same bits.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "film/spectral_film.hpp"
#include "render/checkpoint/fingerprint.hpp"

namespace kiloband {

/// What a checkpoint says about itself.
struct CheckpointOutline {
  uint64_t fingerprint = 0;
  PixelRect rect;
  uint64_t channels = 0;
  uint32_t replicates = 0;
  SumRule rule;
  uint32_t most_samples = 0;   // of a replicate in a pixel, invalid ones included
  uint64_t pixel_samples = 0;  // of all replicates and pixels, invalid ones included
};

/// Writes the sums of a film that holds them to `file`, whole or not at all, with checksums. What stood there
/// stays until it is replaced.
/// throws DeviceError
void write_checkpoint(const std::filesystem::path& file, const SpectralFilm& film, uint64_t fingerprint);

/// Reads the beginning of `file`: not the sums.
/// Never waits (named pipes) and allocates no more than the file is long.
/// throws InputError  missing, no regular file, of another version, damaged
CheckpointOutline checkpoint_outline(const std::filesystem::path& file);
/// Whether there is something under that name.
/// throws InputError  that cannot be said: the name is too long, or a folder of its path may not be entered
bool checkpoint_exists(const std::filesystem::path& file);
/// How many replicates the film in `file` has; nothing: there is no such file.
/// throws as checkpoint_outline(), checkpoint_exists()
std::optional<uint32_t> checkpoint_replicates(const std::filesystem::path& file);

/// Fills a fresh film that holds sums from `file` and returns the number of pixel samples in it.
/// throws InputError  missing, no regular file, of another version, of another render (fingerprint), damaged:
///                    sizes, checksums, counts that no deal of samples gives, sums that no samples add up to.
///                    Then the film is spoilt
uint64_t read_checkpoint(const std::filesystem::path& file, SpectralFilm& film, uint64_t fingerprint);

/// To be called before a render that saves itself in `file` begins. resume: it goes on from what is there.
/// throws InputError   what is there is no regular file, or exists although the render does not resume
///        DeviceError  nothing can be written there
void check_checkpoint_file(const std::filesystem::path& file, bool resume);

}  // namespace kiloband
