// Checkpoints: the held film of an unfinished render, to go on from later.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "film/spectral_film.hpp"
#include "render/backend.hpp"
#include "scene/derived_channels.hpp"
#include "scene/flat_scene.hpp"

namespace kiloband {

/// A number that differs (but for 1 in 2^64) if anything differs that samples depend on: scene data,
/// channels, guide bands, camera, sampling settings, instruction set, size. The number of samples is not part
/// of it: a render may be extended.
uint64_t render_fingerprint(const FlatScene& scene, const SamplingSettings& sampling, const std::string& isa,
                            const DerivedChannels& derived);

/// Writes the film to `file`, whole or not at all, with a checksum. throws DeviceError
void write_checkpoint(const std::filesystem::path& file, const SpectralFilm& film, uint64_t fingerprint);

/// Whether there is something under that name.
/// throws InputError  that cannot be said: the name is too long, or a folder of its path may not be entered
bool checkpoint_exists(const std::filesystem::path& file);

/// How many replicates the film in `file` has; nothing: there is no such file, or its number is damaged.
/// throws InputError  it is no checkpoint, or as checkpoint_exists()
std::optional<uint32_t> checkpoint_replicates(const std::filesystem::path& file);

/// Fills a fresh film from `file` and returns the number of pixel samples it holds.
/// throws InputError  missing, damaged (checksum), or of another render (fingerprint)
uint64_t read_checkpoint(const std::filesystem::path& file, SpectralFilm& film, uint64_t fingerprint);

}  // namespace kiloband
