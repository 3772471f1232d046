// kiloband info SCENE.xml: what the scene contains; --materials: the built-in materials; --check FOLDER: which scenes load.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <iterator>
#include <memory>

#include "app/check_scenes.hpp"
#include "app/commands.hpp"
#include "app/console/standard_output.hpp"
#include "app/options/render_options.hpp"
#include "film/spectral_film.hpp"
#include "render/session.hpp"
#include "scene/compile/flat_scene.hpp"
#include "spectral/materials/materials.hpp"
#include "src_gpu/path/path_memory.hpp"

namespace kiloband {
namespace {

double mebibytes(double bytes) {
  return bytes / (1024.0 * 1024.0);
}

const char* name_of(uint32_t emitter_type) {
  static constexpr const char* kNames[] = {"area",        "constant", "envmap", "point",    "spot",
                                           "directional", "thermal",  "sun",    "projector"};
  static_assert(std::size(kNames) == KB_EMITTER_PROJECTOR + 1);
  return kNames[emitter_type];
}

const char* name_of_material(uint32_t type) {
  static constexpr const char* kNames[] = {"diffuse",         "conductor", "roughconductor", "dielectric",
                                           "roughdielectric", "plastic",   "roughplastic",   "principled"};
  static_assert(std::size(kNames) == KB_MATERIAL_COUNT);
  return kNames[type];
}

void print_channels(const LoadedScene& loaded) {
  const Channel range = hull(loaded.channels);
  answer("channels     {} from {:g} to {:g} nm\n", loaded.channels.size(), range.min_nm, range.max_nm);
  const Channel guide = hull(loaded.guide);
  answer("guide bands  {} from {:g} to {:g} nm\n", loaded.guide.size(), guide.min_nm, guide.max_nm);
  for (const auto& [name, response] : loaded.description.sensor.film.responses)
    answer("response     {}\n", name);
}

const char* name_of_medium(uint32_t type) {
  static constexpr const char* kNames[] = {"no gas", "absorbing", "plume (grid)", "plume (jet)"};
  return kNames[type];
}

void print_media(const FlatScene& scene) {
  answer("media        {}\n", scene.media.size());
  for (std::size_t m = 0; m < scene.media.size(); ++m) {
    const KbMedium& medium = scene.media[m];
    std::size_t knots = 0;
    if (medium.row != KB_NONE) knots = scene.spectra[medium.row].absorption->mu.size();
    answer("  {:<16} {}{}{}, {} points of absorption in all channels\n", name_of_medium(medium.type),
           scene.medium_names[m], m == scene.atmosphere ? ", the atmosphere" : "",
           medium.emit_row == KB_NONE ? "" : fmt::format(", up to {:g} K", medium.reference_k), knots);
  }
}

void print_contents(const FlatScene& scene) {
  answer("shapes       {} ({} triangles, {} vertices)\n", scene.shapes.size(), scene.triangles.size() / 3,
         scene.positions.size() - 1);
  if (!scene.instances.empty())
    answer("instances    {} of {} groups\n", scene.instances.size(), scene.groups.size());
  answer("bsdfs        {}\n", scene.materials.size());
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    answer("  {:<16} {}\n", name_of_material(scene.materials[m].type), scene.material_names[m]);
  }
  answer("emitters     {}\n", scene.emitters.size());
  for (std::size_t e = 0; e < scene.emitters.size(); ++e) {
    const std::string& name = scene.emitter_names[e];
    answer("  {:<16} {}selected with probability {:.3g}\n", name_of(scene.emitters[e].type),
           name.empty() ? "" : name + ", ", scene.emitters[e].select_pdf);
  }
  std::size_t entries = 0;
  for (const SpectrumRow& row : scene.spectra) entries += row.table.values.size();
  answer("spectra      {} ({} table entries)\n", scene.spectra.size(), entries);
  if (scene.features.gas) print_media(scene);
  answer("textures     {} ({} texels)\n", scene.textures.size(), scene.texel_bounds.size());
  std::size_t values = 0;
  for (const SpectralTexels& texels : scene.spectral_texels) values += texels ? texels->size() : 0;
  if (values > 0)
    answer("spectral     {:.1f} MiB of bands and weights\n", mebibytes(4.0 * static_cast<double>(values)));
  answer("features     {}\n", fmt::join(scene.features.names(), ", "));
}

void print_memory(const FlatScene& scene, std::size_t derived, uint64_t samples) {
  const double pixels = static_cast<double>(scene.film.crop_width) * scene.film.crop_height;
  const std::size_t channels = scene.channels.size() + derived;
  const auto film = [&](bool variance) {
    FilmOptions options{channels, variance ? 16u : 1u, variance, false};
    if (replicates_in_parts(samples, options.replicates)) {
      options.sums = SumRule{};  // the CPU's
      options.most_samples = static_cast<uint32_t>(ReplicatePlan::deal(samples, options.replicates).size(0));
    }
    return mebibytes(pixels * static_cast<double>(SpectralFilm::bytes_per_pixel(options)));
  };
  answer("image        {} x {} pixels\n", scene.film.crop_width, scene.film.crop_height);
  answer("film         {:.1f} MiB, with variance {:.1f} MiB (beyond 1024 MiB strips are streamed)\n",
         film(false), film(true));
  answer("path vertex  {} bytes; textured values: {} bytes each, stored two to a {}-byte entry\n",
         sizeof(KbPathVertex), sizeof(KbTextureSample), 2 * sizeof(KbTextureSample));
}

/// Vertices of the longest path: the last of max_depth segments ends on a light.
/// Unlimited depth: as an example 32.
uint64_t longest_path(const Integrator& integrator) {
  return integrator.max_depth < 0 ? 32 : static_cast<uint64_t>(std::max(integrator.max_depth, 1));
}

/// What a pool of paths takes on an OpenCL device: pt keeps two floats per channel of every path in flight,
/// dpept the vertices of whole paths, whatever the number of channels (figures 4 and 7 of the DPEPT paper).
void print_path_memory(const FlatScene& scene) {
  using opencl::Method;
  const uint64_t vertices = longest_path(scene.integrator);
  const bool textured =
      scene.features.bitmap || scene.features.envmap_light || scene.features.temperature_field;
  const uint64_t entries_each =
      (textured ? 2 : 1) + (scene.features.gas ? 2 : 0);  // gas: a vertex on the way, one for its light
  const uint64_t pt =
      opencl::bytes_per_path(Method::kPt, scene.channels.size(), vertices, entries_each, scene.features);
  const uint64_t dpept = opencl::bytes_per_path(Method::kDpeptBatch, scene.channels.size(), vertices,
                                                entries_each, scene.features);
  answer(
      "opencl path  pt {} bytes with {} channels; dpept-path, dpept-batch {} bytes with {} vertices of {} "
      "bytes\n",
      pt, scene.channels.size(), dpept, vertices, entries_each * sizeof(KbPathVertex));
  answer("opencl pool  paths      pt MiB   dpept MiB\n");
  for (const uint64_t edge : {256, 512, 1024, 2048}) {
    const double paths = static_cast<double>(edge) * static_cast<double>(edge);
    answer("             {:>4}^2 {:>10.1f} {:>11.1f}\n", edge, mebibytes(paths * static_cast<double>(pt)),
           mebibytes(paths * static_cast<double>(dpept)));
  }
}

void print_family(const char* title, const std::vector<BuiltInMaterial>& materials) {
  answer("{:<14}{:>9} {:>9}  substance; source\n", title, "from nm", "to nm");
  for (const BuiltInMaterial& m : materials)
    answer("  {:<12}{:>9.1f} {:>9.0f}  {}; {}\n", m.name, m.min_nm, m.max_nm, m.substance, m.source);
}

int print_materials() {
  print_family("metals", built_in_metals());
  print_family("transparent", built_in_dielectrics());
  return kDone;
}

int info(const SceneOptions& options) {
  if (options.scene.empty()) throw InputError("SCENE is required (see kiloband info --help)");
  const DiagnosticSink sink = print_diagnostics(false);
  check_scene_file(options.scene);
  const LoadedScene loaded = load_scene(options, sink);
  const auto compiled = compile_scene(loaded.description, {loaded.channels, loaded.guide, sink});
  const FlatScene& scene = *compiled;
  answer("scene        {}\n", options.scene);
  print_contents(scene);
  print_channels(loaded);
  print_memory(scene, loaded.description.sensor.film.responses.size(),
               loaded.description.sensor.sample_count);
  print_path_memory(scene);
  const Integrator& integrator = scene.integrator;
  answer("integrator   max_depth {}, rr_depth {}, {} samples per pixel\n", integrator.max_depth,
         integrator.rr_depth, loaded.description.sensor.sample_count);
  return kDone;
}

}  // namespace

Command add_info(CLI::App& program) {
  auto options = std::make_shared<SceneOptions>();
  auto materials = std::make_shared<bool>(false);
  auto folder = std::make_shared<std::string>();
  CLI::App* command = program.add_subcommand("info", "Show what a scene contains and needs");
  options->add_to(*command);
  command->get_option("SCENE")->required(false);
  command->add_flag("--materials", *materials, "list the built-in materials instead")
      ->excludes(command->get_option("SCENE"));
  const CLI::Option* check =
      command
          ->add_option(
              "--check", *folder,
              "say which scenes below a folder load, and what stops the others; exit code 1 if one does not")
          ->type_name("FOLDER")
          ->excludes(command->get_option("SCENE"))
          ->excludes(command->get_option("--materials"));
  return [options, materials, folder, check] {
    if (*materials) return print_materials();
    if (check->count() > 0) return int{check_scenes(*folder, *options) ? kDone : kFailed};
    return info(*options);
  };
}

}  // namespace kiloband
