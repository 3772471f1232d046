// Images of the zoo's scenes on any backend, with the means of all replicates.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "film/spectral_film.hpp"
#include "render/backend.hpp"
#include "src_gpu/opencl_backend.hpp"
#include "tests/support/scene_zoo.hpp"

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

/// The film's crop window.
PixelRect film_rect(const FlatScene& scene);

/// An image by replicates, film units (equal on all backends).
struct Image {
  uint32_t width = 0, height = 0, replicates = 0;
  std::size_t channels = 0;            // derived ones included
  std::vector<float> means;            // [replicate][pixel][channel]
  std::vector<uint64_t> samples;       // [replicate][pixel]
  std::vector<InvalidSample> invalid;  // the first
  uint64_t invalid_samples = 0, paths = 0;

  std::size_t pixels() const { return std::size_t{width} * height; }
  float at(uint32_t replicate, std::size_t pixel, std::size_t channel) const {
    return means[(replicate * pixels() + pixel) * channels + channel];
  }
};

/// Renders `samples` samples of every replicate in every pixel.
Image render_image(Backend& backend, const FlatScene& scene, uint32_t replicates, uint32_t samples);
/// The same of a part of the film, in film coordinates.
Image render_part(Backend& backend, const PixelRect& rect, uint32_t replicates, uint32_t samples);

}  // namespace kiloband::test
