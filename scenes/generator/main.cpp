// generate_scenes OUT_DIR [SCENE]...: writes OUT_DIR/SCENE/ with the scene file, its spectra,
// meshes and textures.
#include <algorithm>
#include <iostream>
#include <stdexcept>

#include "scenes/generator/scenes.hpp"

namespace kiloband::generator {
namespace {

std::string names() {
  std::string text;
  for (const KnownScene& scene : known_scenes()) text += (text.empty() ? "" : ", ") + scene.name;
  return text;
}

/// Writes the scene and prints its parts with their triangles.
void write(const KnownScene& scene, const std::string& out) {
  std::size_t total = 0;
  for (const WrittenPart& part : write_scene(scene.make(), KILOBAND_SCENES_DIR, out)) {
    std::cout << "  " << part.name << " " << part.triangles << "\n";
    total += part.triangles;
  }
  std::cout << out << "/" << scene.name << "/" << scene.name << ".xml: " << total << " triangles\n";
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments[0].starts_with("-")) {
    std::cerr << "usage: generate_scenes OUT_DIR [SCENE]...\nscenes: " << names() << " (default: all)\n";
    return 2;
  }
  const std::vector<std::string> wanted(arguments.begin() + 1, arguments.end());
  for (const std::string& name : wanted) {
    const auto same = [&](const KnownScene& scene) { return scene.name == name; };
    if (std::none_of(known_scenes().begin(), known_scenes().end(), same)) {
      std::cerr << "error: unknown scene '" << name << "'; there are " << names() << "\n";
      return 2;
    }
  }
  for (const KnownScene& scene : known_scenes()) {
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), scene.name) != wanted.end()) {
      write(scene, arguments[0]);
    }
  }
  return 0;
}

}  // namespace
}  // namespace kiloband::generator

int main(int count, char** arguments) {
  try {
    return kiloband::generator::run({arguments + 1, arguments + count});
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << "\n";
    return 3;
  }
}
