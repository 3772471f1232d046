// Scenes of the renderer's tests, as text.
#pragma once

#include <string>

#include "tests/support/render_harness.hpp"

namespace kiloband::test {

/// Full film and the part of it that is rendered, pixels.
struct FilmSize {
  unsigned width, height;
  unsigned crop_x = 0, crop_y = 0, crop_width = 0, crop_height = 0;  // crop_width 0: all
};

/// <scene> around the parts. max_depth -1: no limit
std::string scene_text(int max_depth, const std::string& parts, bool hide_emitters = false);
std::string film_text(const FilmSize& size);
/// Perspective camera at (0, 0, 4) looking along -z.
std::string camera_text(const FilmSize& size);

/// A lit room with meshes and analytic shapes and every kind of path vertex but dispersive ones: diffuse,
/// checkerboard, plastics, conductors, glass, a mask; an area light, a point light and a constant sky
/// (the front is open).
std::string room_parts();
/// room_parts() before the camera; 4 channels and a response, 16 samples in 4 replicates.
RenderSpec room_spec(const FilmSize& size);

}  // namespace kiloband::test
