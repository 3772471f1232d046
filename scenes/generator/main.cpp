// generate_scenes OUT_DIR [SCENE]...: writes OUT_DIR/SCENE/ with the scene file, its spectra, meshes and
// textures.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <stdexcept>

#include "scenes/generator/scenes.hpp"

namespace kiloband::generator {
namespace {

namespace fs = std::filesystem;

/// Committed files of the scene, then what is computed. Prints a line for each mesh.
void write_scene(const Scene& scene, const fs::path& out) {
  const fs::path folder = out / scene.name;
  fs::create_directories(folder);
  fs::copy(fs::path(KILOBAND_SCENES_DIR) / scene.name, folder,
           fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  fs::create_directories(folder / "meshes");
  fs::create_directories(folder / "textures");
  std::size_t total = 0;
  for (const auto& [name, part] : scene.parts) {
    const Mesh mesh = in_single_precision(part);
    write_ply(mesh, folder / "meshes" / (name + ".ply"));
    std::cout << scene.name << "/" << name << " " << mesh.triangles.size() << "\n";
    total += mesh.triangles.size();
  }
  for (const auto& [name, image] : scene.images) write_image(image, folder / "textures" / name);
  std::cout << scene.name << " " << total << " triangles\n";
}

int run(int count, char** arguments) {
  if (count < 2 || arguments[1][0] == '-') {
    std::cerr << "usage: generate_scenes OUT_DIR [aircraft|conference|statues]...\n";
    return 2;
  }
  const std::vector<std::pair<std::string, Scene (*)()>> known{
      {"aircraft", aircraft}, {"conference", conference}, {"statues", statues}};
  std::vector<std::string> wanted(arguments + 2, arguments + count);
  for (const std::string& name : wanted) {
    if (std::none_of(known.begin(), known.end(), [&](const auto& k) { return k.first == name; })) {
      std::cerr << "error: unknown scene '" << name << "'; there are aircraft, conference, statues\n";
      return 2;
    }
  }
  for (const auto& [name, make] : known) {
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end()) {
      write_scene(make(), arguments[1]);
    }
  }
  return 0;
}

}  // namespace
}  // namespace kiloband::generator

int main(int count, char** arguments) {
  try {
    return kiloband::generator::run(count, arguments);
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << "\n";
    return 3;
  }
}
