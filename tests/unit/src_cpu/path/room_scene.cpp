#include "room_scene.hpp"

namespace kiloband::test {
namespace {

std::string walls() {
  return rectangle(
             turn("x", -90) + translate(0, -1, 0),
             bsdf("diffuse", "<texture type='checkerboard' name='reflectance'><transform name='to_uv'>" +
                                 step("scale", "x='3' y='3'") + "</transform></texture>")) +
         rectangle(turn("x", 90) + translate(0, 1, 0), diffuse("500:0.7, 600:0.8")) +
         rectangle(
             translate(0, 0, -1),
             bsdf("plastic", number("rgb", "diffuse_reflectance", "0.6, 0.3, 0.2") + yes("nonlinear"))) +
         rectangle(turn("y", 90) + translate(-1, 0, 0), diffuse("500:0.1, 550:0.6, 600:0.2")) +
         rectangle(turn("y", -90) + translate(1, 0, 0), rough_plastic());
}

std::string objects() {
  return shape("sphere", number("point", "center", "0.45, -0.6, 0.2") + real("radius", 0.38) +
                             bsdf("roughconductor", real("alpha", 0.2) + spectrum("eta", "500:0.9, 600:0.2") +
                                                        spectrum("k", "500:2.1, 600:3"))) +
         shape("sphere",
               number("point", "center", "-0.45, 0.2, 0.3") + real("radius", 0.3) + bsdf("dielectric")) +
         shape("cube", scale(0.25, 0.4, 0.25) + turn("y", 25) + translate(-0.4, -0.6, -0.2),
               bsdf("roughdielectric", real("alpha", 0.3))) +
         shape("disk", scale("0.35") + translate(0.4, 0.4, 0.5),
               bsdf("mask", real("opacity", 0.6) + diffuse("500:0.2, 600:0.9")));
}

}  // namespace

std::string rough_plastic() {
  return bsdf("roughplastic", real("alpha", 0.2));
}

std::string film_text(const FilmSize& its) {
  return film(size(its.width, its.height) +
                  (its.crop_width > 0 ? crop(its.crop_x, its.crop_y, its.crop_width, its.crop_height) : ""),
              "gaussian");
}

std::string camera_text(const FilmSize& its) {
  return object("sensor", "perspective",
                real("fov", 40) + to_world(lookat("0, 0, 4", "0, 0, 0")) + film_text(its));
}

std::string room_parts() {
  return walls() + objects() +
         rectangle(scale("0.4") + turn("x", 90) + translate(0, 0.99, 0), lamp("500:2, 530:9, 600:4")) +
         emitter("point",
                 number("point", "position", "0, 0.3, 0.9") + spectrum("intensity", "500:0.3, 600:0.6")) +
         sky(0.2);
}

RenderSpec room_spec(const FilmSize& its) {
  RenderSpec spec;
  spec.xml = scene(6, camera_text(its) + room_parts());
  spec.responses = {{"sum", Spectrum::constant(1)}};
  spec.spp = 16;
  spec.sampling.replicates = 4;
  spec.sampling.seed = 5;
  spec.threads = 1;
  return spec;
}

}  // namespace kiloband::test
