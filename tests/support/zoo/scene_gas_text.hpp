// Gases and plumes of the zoo's scenes, as text.
#pragma once

#include "tests/support/scene_text.hpp"

namespace kiloband::scene_text {

/// Gases inside each other, in glass, in glass whose index depends on wavelength; in an atmosphere.
inline Text gases() {
  const Text null = bsdf("null");
  const Text box = step("scale", "x='0.5' y='0.3' z='0.4'") + turn("y", "20");
  return gas("atmosphere", "450:0.15, 550:0.02, 650:0.3", "1900") +
         shape("cube", box + translate("-0.3 0.4 -0.1"),
               null + gas("interior", "450:0.3, 550:2, 650:0.1", "2100")) +
         ball("-0.35 0.42 -0.1", "0.2", null + gas("interior", "450:3, 650:0.1")) +
         ball("0.5 0.3 0.2", "0.35", bsdf("dielectric") + gas("interior", "450:0.1, 650:4")) +
         ball("-0.5 -0.6 0.2", "0.35",
              bsdf("roughdielectric", text("int_material", "glass.txt") + roughness("ggx", "0.3")) +
                  gas("interior", "450:1.5, 650:0.2", "1800")) +
         mesh("gem.obj", scale("0.4") + translate("0.4 -0.5 0"),
              null + gas("interior", "450:5, 550:0.5, 650:2", "2000"));
}

/// A jet and a grid of temperatures in an atmosphere.
inline Text plumes() {
  const Text null = bsdf("null");
  const Text jet = text("field", "jet") + real("temperature", "2300") + real("ambient", "700") +
                   real("radius", "0.08") + real("spread", "0.15") + real("length", "1.6") +
                   to_world(turn("y", "80") + translate("-0.8 0.2 0"));
  const Text grid = text("field", "grid") + text("nodes", "4 3 5") + text("filename", "plume.txt") +
                    real("scale", "1.5") +
                    to_world(translate("-0.5 -0.5 -0.5") + step("scale", "x='0.8' y='0.6' z='0.5'") +
                             translate("0.1 -0.6 0.2"));
  return shape("cube", step("scale", "x='0.95' y='0.4' z='0.5'") + translate("0 0.3 0"), null + plume(jet)) +
         shape("cube", step("scale", "x='0.45' y='0.35' z='0.3'") + translate("0.1 -0.6 0.2"),
               null + plume(grid)) +
         gas("atmosphere", "450:0.1, 650:0.02", "1500");
}

}  // namespace kiloband::scene_text
