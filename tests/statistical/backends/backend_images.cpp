#include "backend_images.hpp"

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

Image render_part(Backend& backend, const PixelRect& rect, uint32_t replicates, uint32_t samples) {
  const std::vector<double> film_units(backend.film_scale().size(), 1);
  SpectralFilm film(rect, {film_units.size(), replicates, true, true});
  validation::render_replicates(backend, film, replicates, samples, {});
  const BackendStatistics done = backend.statistics();
  return {validation::image_of(film, rect, replicates, film_units), done.first_invalid, done.invalid_samples,
          done.paths};
}

Image render_image(Backend& backend, const FlatScene& scene, uint32_t replicates, uint32_t samples) {
  return render_part(backend, film_rect(scene), replicates, samples);
}

}  // namespace kiloband::test
