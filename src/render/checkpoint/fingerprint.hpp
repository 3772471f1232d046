// Which render a checkpoint belongs to.
#pragma once

#include <cstdint>
#include <string>

#include "render/backend.hpp"
#include "scene/compile/flat_scene.hpp"
#include "scene/description/derived_channels.hpp"

namespace kiloband {

/// A number that differs (but for 1 in 2^64) if anything differs that samples depend on: scene data,
/// channels, guide bands, camera, sampling settings, arithmetic, size. The number of samples is not part
/// of it: a render may be extended.
uint64_t render_fingerprint(const FlatScene& scene, const SamplingSettings& sampling,
                            const std::string& arithmetic, const DerivedChannels& derived);

/// What the last bits of a backend's samples depend on: instruction set, or device, driver and method.
std::string arithmetic_of(const Backend& backend);

}  // namespace kiloband
