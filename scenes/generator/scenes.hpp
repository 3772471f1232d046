// The scenes that the generator knows.
#pragma once

#include "scenes/generator/image.hpp"
#include "scenes/generator/mesh.hpp"

namespace kiloband::generator {

struct Scene {
  std::string name;  // folder below scenes/ with the scene file and its spectra
  Parts parts;
  Images images;
};

/// What the generator can make, by name.
struct KnownScene {
  std::string name;
  Scene (*make)();
};
const std::vector<KnownScene>& known_scenes();

struct WrittenPart {
  std::string name;
  std::size_t triangles;
};
/// Writes out/NAME/: the files of committed/NAME (scene file, spectra),
/// then meshes/PART.ply and textures/IMAGE.
/// throws std::runtime_error  a file cannot be written or is missing
std::vector<WrittenPart> write_scene(const Scene& scene, const std::filesystem::path& committed,
                                     const std::filesystem::path& out);

Scene conference();
Scene statues();
Scene aircraft();

}  // namespace kiloband::generator
