#include "backend_images.hpp"

#include "scene/read/reader.hpp"
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

FlatScene scene_beyond_floats(uint32_t width, uint32_t height) {
  constexpr const char* kScene = R"(<scene version='3.0.0'>
<integrator type='path'><integer name='max_depth' value='2'/></integrator>
<sensor type='orthographic'>
 <transform name='to_world'><scale value='1e-9'/><lookat origin='0,0,1' target='0,0,0' up='0,1,0'/></transform>
 <film type='hdrfilm'><rfilter type='box'/></film>
</sensor>
<shape type='rectangle'/>
<emitter type='point'><point name='position' x='0' y='0' z='1e-18'/><spectrum name='intensity' value='0.01'/></emitter>
<emitter type='directional'><vector name='direction' x='0' y='0' z='-1'/>
 <spectrum name='irradiance' value='2'/></emitter></scene>)";
  ReadOptions options;
  options.film_size = {width, height};
  return *compile_scene(read_scene_text(kScene, "invalid.xml", ".", options),
                        {parse_channels("500:600:4"), {}, {}});
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
