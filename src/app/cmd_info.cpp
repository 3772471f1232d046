// kiloband info SCENE.xml: what the scene contains.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <memory>

#include "app/commands.hpp"
#include "app/render_options.hpp"
#include "film/spectral_film.hpp"
#include "render/session.hpp"
#include "scene/flat_scene.hpp"

namespace kiloband {
namespace {

const char* name_of(uint32_t emitter_type) {
  static constexpr const char* kNames[] = {"area", "constant", "envmap", "point", "spot", "directional"};
  return kNames[emitter_type];
}

const char* name_of_material(uint32_t type) {
  static constexpr const char* kNames[] = {"diffuse",         "conductor", "roughconductor", "dielectric",
                                           "roughdielectric", "plastic",   "roughplastic"};
  return kNames[type];
}

void print_channels(const LoadedScene& loaded) {
  const Channel range = hull(loaded.channels);
  fmt::print("channels     {} from {:g} to {:g} nm\n", loaded.channels.size(), range.min_nm, range.max_nm);
  const Channel guide = hull(loaded.guide);
  fmt::print("guide bands  {} from {:g} to {:g} nm\n", loaded.guide.size(), guide.min_nm, guide.max_nm);
  for (const auto& [name, response] : loaded.description.sensor.film.responses)
    fmt::print("response     {}\n", name);
}

void print_contents(const FlatScene& scene) {
  fmt::print("shapes       {} ({} triangles, {} vertices)\n", scene.shapes.size(), scene.triangles.size() / 3,
             scene.positions.size() - 1);
  fmt::print("bsdfs        {}\n", scene.materials.size());
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    fmt::print("  {:<16} {}\n", name_of_material(scene.materials[m].type), scene.material_names[m]);
  }
  fmt::print("emitters     {}\n", scene.emitters.size());
  for (std::size_t e = 0; e < scene.emitters.size(); ++e) {
    const std::string& name = scene.emitter_names[e];
    fmt::print("  {:<16} {}selected with probability {:.3g}\n", name_of(scene.emitters[e].type),
               name.empty() ? "" : name + ", ", scene.emitters[e].select_pdf);
  }
  std::size_t entries = 0;
  for (const SpectrumRow& row : scene.spectra) entries += row.table.values.size();
  fmt::print("spectra      {} ({} table entries)\n", scene.spectra.size(), entries);
  fmt::print("textures     {} ({} texels)\n", scene.textures.size(), scene.texels.size());
  fmt::print("features     {}\n", fmt::join(scene.features.names(), ", "));
}

double mebibytes(double bytes) {
  return bytes / (1024.0 * 1024.0);
}

void print_memory(const FlatScene& scene, std::size_t derived, uint64_t samples) {
  const double pixels = static_cast<double>(scene.film.crop_width) * scene.film.crop_height;
  const std::size_t channels = scene.channels.size() + derived;
  const auto film = [&](bool variance) {
    FilmOptions options{channels, 16, variance, false};
    options.parts = replicates_in_parts(samples, options.replicates);
    return mebibytes(pixels * static_cast<double>(SpectralFilm::bytes_per_pixel(options)));
  };
  fmt::print("image        {} x {} pixels\n", scene.film.crop_width, scene.film.crop_height);
  fmt::print("film         {:.1f} MiB, with variance {:.1f} MiB (beyond 1024 MiB strips are streamed)\n",
             film(false), film(true));
  fmt::print("path vertex  {} bytes; textured values: {} bytes each, stored two to a {}-byte slot\n",
             sizeof(KbPathVertex), sizeof(KbTextureSample), 2 * sizeof(KbTextureSample));
}

int info(const SceneOptions& options) {
  const DiagnosticSink sink = print_diagnostics(false);
  check_scene_file(options.scene);
  const LoadedScene loaded = load_scene(options, sink);
  const FlatScene scene = flatten(loaded.description, {loaded.channels, loaded.guide, sink});
  fmt::print("scene        {}\n", options.scene);
  print_contents(scene);
  print_channels(loaded);
  print_memory(scene, loaded.description.sensor.film.responses.size(),
               loaded.description.sensor.sample_count);
  const Integrator& integrator = scene.integrator;
  fmt::print("integrator   max_depth {}, rr_depth {}, {} samples per pixel\n", integrator.max_depth,
             integrator.rr_depth, loaded.description.sensor.sample_count);
  return kDone;
}

}  // namespace

Command add_info(CLI::App& program) {
  auto options = std::make_shared<SceneOptions>();
  CLI::App* command = program.add_subcommand("info", "Show what a scene contains and needs");
  options->add_to(*command);
  return [options] { return info(*options); };
}

}  // namespace kiloband
