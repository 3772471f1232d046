// A scene as a folder of files.
#include <filesystem>

#include "scenes/generator/scenes.hpp"

namespace kiloband::generator {

namespace fs = std::filesystem;

const std::vector<KnownScene>& known_scenes() {
  static const std::vector<KnownScene> kScenes{
      {"aircraft", aircraft}, {"conference", conference}, {"statues", statues}};
  return kScenes;
}

std::vector<WrittenPart> write_scene(const Scene& scene, const fs::path& committed, const fs::path& out) {
  const fs::path folder = out / scene.name;
  fs::create_directories(folder);
  fs::copy(committed / scene.name, folder,
           fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  fs::create_directories(folder / "meshes");
  fs::create_directories(folder / "textures");
  std::vector<WrittenPart> written;
  for (const auto& [name, part] : scene.parts) {
    const Mesh mesh = in_single_precision(part);
    write_ply(mesh, folder / "meshes" / (name + ".ply"));
    written.push_back({name, mesh.triangles.size()});
  }
  for (const auto& [name, image] : scene.images) write_image(image, folder / "textures" / name);
  return written;
}

}  // namespace kiloband::generator
