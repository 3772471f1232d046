// Lamps that are no surfaces, for the scenes of the zoo.
#pragma once

#include "tests/support/scene_text.hpp"

namespace kiloband::scene_text {

inline Text delta_lights() {
  return emitter("point", "<point name='position' x='-0.5' y='0.6' z='0.3'/>" +
                              spectrum("intensity", "450:0.4, 650:0.9")) +
         emitter("spot", real("cutoff_angle", "35") + real("beam_width", "20") +
                             spectrum("intensity", "450:3, 650:1") +
                             to_world(lookat("0.6, 0.8, 0.8", "0.2, -0.6, -0.2"))) +
         emitter("directional", "<vector name='direction' x='0.3' y='-1' z='-0.6'/>" +
                                    spectrum("irradiance", "450:0.5, 650:0.8"));
}

/// Spots and projectors that throw pictures: colours, values, squares, bands, a spectrum; one partly on things beside and behind it.
/// Without falloff, whose edge, where values are small differences of angles, delta_lights() has.
inline Text projected_lights() {
  const Text down = to_world(lookat("0.6, 0.8, 0.8", "0.2, -0.6, -0.2"));
  const Text across = to_world(lookat("-0.8, 0.7, 0.9", "0.4, -0.5, -0.6"));
  const auto spot = [&](const Text& place, const Text& picture) {
    return emitter("spot", real("cutoff_angle", "40") + real("beam_width", "40") + place + picture);
  };
  const auto projector = [](const Text& place, const Text& fov, const Text& power, const Text& picture) {
    return emitter("projector", real("fov", fov) + real("scale", power) + place + picture);
  };
  const Text intensity = spectrum("intensity", "450:3, 650:1");
  return spot(down, intensity + bitmap("texture", "colours.ppm", "repeat", "bilinear", scale("1.7"))) +
         spot(across, intensity + checkerboard("texture", scale("3") + turn("z", "20"))) +
         spot(across,
              spectral_bitmap("texture", text("filename", "glow.hdr"), "clamp", "nearest", scale("1"))) +
         projector(down, "70", "0.7", bitmap("irradiance", "colours.ppm", "clamp", "bilinear", scale("1"))) +
         projector(across, "25", "1.2", spectrum("irradiance", "450:0.5, 650:0.8")) +
         projector(to_world(lookat("0, 0.2, 0.3", "0.9, -0.6, 0.2")), "90", "0.01",
                   "<spectrum name='irradiance' type='d65'>" +
                       bitmap("value", "grey.pgm", "repeat", "nearest", scale("2")) + "</spectrum>");
}

/// Enough of them for a light tree: balls and disks, high and low, a spot that looks up, a hot pane.
inline Text small_lamps() {
  Text lamps = rectangle(scale("0.08") + turn("y", "60") + translate("-0.8 0.1 0.5"),
                         diffuse("0.2") + thermal("2600")) +
               emitter("spot", real("cutoff_angle", "110") + spectrum("intensity", "450:0.1, 650:0.3") +
                                   to_world(lookat("0.7, -0.8, 0.6", "0.2, 0.6, -0.2")));
  for (int i = 0; i < 28; ++i) {
    const Text place = std::to_string(-0.75 + 0.25 * (i % 7)) + " " +
                       std::to_string(0.85 - 0.3 * (i / 7) - 0.02 * (i % 3)) + " " +
                       std::to_string(0.6 - 0.17 * (i % 5));
    const Text light = diffuse("0.1") + lamp(i % 3 == 0   ? "450:9, 650:3"
                                             : i % 3 == 1 ? "450:2, 650:25"
                                                          : "6");
    lamps +=
        i % 2 == 0
            ? ball(place, "0.02", light)
            : shape("disk", scale("0.03") + turn("x", std::to_string(40 + 30 * i)) + translate(place), light);
  }
  return lamps;
}

/// One of a moderate radius, two narrow ones of which one lies within it, seen by all kinds of surfaces.
inline Text suns() {
  const auto sun = [](const Text& direction, const Text& degrees, const Text& irradiance) {
    return emitter("directional", "<vector name='direction' value='" + direction + "'/>" +
                                      real("angular_radius", degrees) + spectrum("irradiance", irradiance));
  };
  return sun("0.3 -1 -0.6", "9", "450:0.5, 650:0.8") + sun("0.32 -1 -0.62", "0.8", "450:0.3, 650:0.1") +
         sun("-0.6 -0.7 -0.2", "2.5", "450:0.1, 650:0.6");
}

}  // namespace kiloband::scene_text
