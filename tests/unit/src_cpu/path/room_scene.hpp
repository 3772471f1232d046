// Scenes of the renderer's tests, as text.
#pragma once

#include <string>

#include "tests/support/render_harness.hpp"
#include "tests/support/scene_text.hpp"

namespace kiloband::test {

using namespace scene_text;

/// Full film and the part of it that is rendered, pixels.
struct FilmSize {
  int width, height;
  int crop_x = 0, crop_y = 0, crop_width = 0, crop_height = 0;  // crop_width 0: all
};

std::string film_text(const FilmSize& size);
/// Perspective camera at (0, 0, 4) looking along -z.
std::string camera_text(const FilmSize& size);

std::string rough_plastic();

/// A lit room with meshes and analytic shapes and every kind of path vertex but dispersive ones: diffuse,
/// checkerboard, plastics, conductors, glass, a mask; an area light, a point light and a constant sky
/// (the front is open).
std::string room_parts();
/// room_parts() before the camera; 4 channels and a response, 16 samples in 4 replicates.
RenderSpec room_spec(const FilmSize& size);

}  // namespace kiloband::test
