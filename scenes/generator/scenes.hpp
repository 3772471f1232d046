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

Scene conference();
Scene statues();
Scene aircraft();

}  // namespace kiloband::generator
