#include "backend_images.hpp"

#include <numeric>

#include "src_cpu/cpu_backend.hpp"

namespace kiloband::test {

std::unique_ptr<Backend> make_zoo_backend(const std::string& name, const FlatScene& scene,
                                          const DerivedChannels& derived, const SamplingSettings& settings,
                                          opencl::Options options) {
  if (name == "cpu")
    return cpu::make_backend(std::make_shared<const FlatScene>(scene), derived, settings, {});
  options.method = opencl::find_method(name.substr(name.find(':') + 1)).value();
  return opencl::make_backend(std::make_shared<const FlatScene>(scene), derived, settings, options);
}

std::vector<std::string> zoo_names() {
  std::vector<std::string> names;
  for (const ZooScene& scene : scene_zoo()) names.push_back(scene.name);
  return names;
}

PixelRect film_rect(const FlatScene& scene) {
  return {scene.film.crop_x, scene.film.crop_y, scene.film.crop_width, scene.film.crop_height};
}

Image render_part(Backend& backend, const PixelRect& rect, uint32_t replicates, uint32_t samples) {
  Image image;
  image.width = rect.width;
  image.height = rect.height;
  image.replicates = replicates;
  image.channels = backend.film_scale().size();
  SpectralFilm film(rect, {image.channels, replicates, true, true});
  std::vector<uint32_t> blocks(film.blocks().size());
  std::iota(blocks.begin(), blocks.end(), 0u);
  const std::atomic<bool> stop{false};
  for (uint32_t r = 0; r < replicates; ++r) backend.render(film, {r, 0, samples}, blocks, stop, {});
  std::vector<float> means(image.channels);
  for (uint32_t r = 0; r < replicates; ++r) {
    for (std::size_t p = 0; p < image.pixels(); ++p) {
      film.replicate_mean(r, p, means);
      image.means.insert(image.means.end(), means.begin(), means.end());
      image.samples.push_back(film.replicate_samples(r, p));
    }
  }
  const BackendStatistics done = backend.statistics();
  image.invalid = done.first_invalid;
  image.invalid_samples = done.invalid_samples;
  image.paths = done.paths;
  return image;
}

Image render_image(Backend& backend, const FlatScene& scene, uint32_t replicates, uint32_t samples) {
  return render_part(backend, film_rect(scene), replicates, samples);
}

}  // namespace kiloband::test
