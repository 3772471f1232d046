// Images of the zoo's scenes on any backend, with the means of all replicates.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "film/spectral_film.hpp"
#include "render/backend.hpp"
#include "src_gpu/opencl_backend.hpp"
#include "tests/support/zoo/scene_zoo.hpp"
#include "validation/suite/rendering.hpp"

namespace kiloband::test {

/// "cpu", "opencl:pt", "opencl:dpept-path" or "opencl:dpept-batch", without the device; kernels are the
/// general ones unless `options` says otherwise: one program serves all scenes.
std::unique_ptr<Backend> make_zoo_backend(const std::string& name, const FlatScene& scene,
                                          const DerivedChannels& derived, const SamplingSettings& settings,
                                          opencl::Options options = {.specialised = false});

/// The three methods' backend names.
inline const std::vector<std::string> kOpenclMethods{"opencl:pt", "opencl:dpept-path", "opencl:dpept-batch"};

/// Names of all scenes, for parameterised tests.
std::vector<std::string> zoo_names();

/// A lamp 1e-18 m before a wall: a sample that selects it is beyond floats, and leaves the mean. Others meet the directional
/// light, which is far brighter and so is selected nearly always.
FlatScene scene_beyond_floats(uint32_t width, uint32_t height);

using validation::film_rect;

/// In film units, which are equal on all backends; derived channels included.
struct Image : stats::ReplicateImage {
  std::vector<InvalidSample> invalid;  // the first
  uint64_t invalid_samples = 0, paths = 0;
};

/// Renders `samples` samples of every replicate in every pixel.
Image render_image(Backend& backend, const FlatScene& scene, uint32_t replicates, uint32_t samples);
/// The same of a part of the film, in film coordinates.
Image render_part(Backend& backend, const PixelRect& rect, uint32_t replicates, uint32_t samples);

}  // namespace kiloband::test
