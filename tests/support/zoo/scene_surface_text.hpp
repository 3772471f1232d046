// Surfaces whose properties vary over them, for the scenes of the zoo.
#pragma once

#include "tests/support/scene_text.hpp"

namespace kiloband::scene_text {

/// Bump and normal maps on all shapes and in all that nests, strong enough to turn normals away from the camera.
inline Text bumps() {
  const auto map = [](const Text& wrap, const Text& to_uv, const Text& file = "grey.pgm") {
    return texture("bitmap", "map", text("filename", file) + text("wrap_mode", wrap) + yes("raw"), to_uv);
  };
  const auto bump = [](const Text& height, const Text& contents) {
    return bsdf("bumpmap", real("scale", height) + contents);
  };
  const Text plain = number("boolean", "flip_invalid_normals", "false") +
                     number("boolean", "use_shadowing_function", "false");
  const Text paint = bsdf("roughplastic", roughness("ggx", "0.2")), mirrored = map("mirror", scale("2.7"));
  const Text coat = bump("0.1", mirrored + paint);
  return floor(bump("0.3", map("repeat", scale("2") + turn("z", "25")) + diffuse("0.6"))) +
         back(bsdf("normalmap", map("repeat", scale("3"), "tilts.pfm") + diffuse("450:0.8, 650:0.4"))) +
         ball("-0.6 0.4 -0.2", "0.3",
              bump("0.2", mirrored + metal("roughconductor", roughness("ggx", "0.25", "0.4")))) +
         ball("0 0.4 -0.2", "0.3", bump("-0.02", mirrored + bsdf("dielectric"))) +
         ball("0.6 0.4 -0.2", "0.3",
              bump("0.1",
                   map("clamp", scale("1.5")) + dispersive("roughdielectric", roughness("ggx", "0.2")))) +
         rectangle(scale("0.3") + turn("y", "150") + translate("-0.6 -0.4 0.2"),
                   bsdf("twosided", coat + diffuse("0.5"))) +
         rectangle(scale("0.25") + turn("y", "150") + translate("0 -0.2 0.3"),
                   bump("0.1", mirrored + bsdf("twosided", paint))) +
         shape("disk", scale("0.3") + turn("y", "-30") + translate("0.6 -0.2 0.3"),
               bump("0.2", plain + mirrored +
                               bsdf("blendbsdf", real("weight", "0.5") + paint + metal("conductor")))) +
         shape("cylinder", step("scale", "x='0.1' y='0.1' z='0.5'") + translate("0.2 -0.7 0"),
               bsdf("normalmap", plain + map("mirror", scale("2"), "colours.ppm") +
                                     bsdf("mask", real("opacity", "0.7") + bsdf("plastic")))) +
         mesh("gem.obj", scale("0.3") + translate("-0.1 -0.7 0.4"),
              bump("0.02", map("repeat", scale("1")) + bsdf("plastic")));
}

/// Roughness that varies, along one axis and along both, of metal and glass.
inline Text roughness_maps() {
  const auto rough = [](const Text& type, const Text& alphas) {
    return bsdf(type, text("distribution", "ggx") + alphas);
  };
  const auto map = [](const Text& name, const Text& file, const Text& filter) {
    return texture("bitmap", name, text("filename", file) + text("filter_type", filter) + yes("raw"),
                   scale("2.3"));
  };
  const Text both = map("alpha_u", "grey.pgm", "bilinear") + map("alpha_v", "colours.ppm", "nearest");
  return rectangle(scale("0.5") + turn("y", "20") + translate("-0.45 0.4 0"),
                   rough("roughconductor", map("alpha", "colours.ppm", "bilinear"))) +
         rectangle(scale("0.4") + turn("x", "-40") + translate("0.5 0.4 0"),
                   bsdf("twosided", rough("roughconductor", both))) +
         ball("-0.5 -0.5 0.1", "0.35", rough("roughdielectric", map("alpha", "grey.pgm", "bilinear"))) +
         ball("0.4 -0.5 0.1", "0.35",
              bsdf("mask",
                   real("opacity", "0.8") +
                       bsdf("blendbsdf", real("weight", "0.5") + diffuse("0.5") +
                                             rough("roughconductor", map("alpha_v", "grey.pgm", "nearest") +
                                                                         real("alpha_u", "0.3")))));
}

/// Principled materials, thick and thin, nested; with images as numbers, or numbers alone.
inline Text principled(bool images) {
  const auto map = [images](const Text& name, const Text& file) {
    if (!images) return real(name, name == "eta" ? "1.4" : "0.3");
    return texture("bitmap", name, text("filename", file) + yes("raw"), scale("1.7"));
  };
  const auto thick = [](const Text& contents) { return bsdf("principled", contents); };
  const auto thin = [](const Text& contents) { return bsdf("principledthin", contents); };
  const Text colour = spectrum("base_color", "450:0.2, 550:0.7, 650:0.4");
  const Text coloured = texture("bitmap", "base_color", text("filename", "colours.ppm"), scale("2"));
  const Text many = real("metallic", "0.3") + real("spec_trans", "0.5") + real("anisotropic", "0.7") +
                    real("spec_tint", "0.5") + real("sheen", "0.6") + real("sheen_tint", "0.5") +
                    real("flatness", "0.4") + real("clearcoat", "0.8") + real("clearcoat_gloss", "0.3");
  return ball("-0.6 0.4 -0.2", "0.3",
              thick(colour + map("roughness", "grey.pgm") + map("metallic", "colours.ppm"))) +
         ball("0 0.4 -0.2", "0.3", thick(colour + real("spec_trans", "1") + real("roughness", "0.3"))) +
         ball("0.6 0.4 -0.2", "0.3", thick(coloured + many)) +
         ball("-0.6 -0.5 0", "0.3", thick(colour + many + real("eta", "1.3"))) +
         ball("0 -0.5 0.1", "0.25",
              bsdf("mask",
                   real("opacity", "0.7") + bsdf("blendbsdf", real("weight", "0.5") + metal("conductor") +
                                                                  thick(colour + real("clearcoat", "1"))))) +
         rectangle(scale("0.3") + turn("y", "30") + translate("0.5 -0.4 0.2"),
                   thin(colour + real("diff_trans", "1.2") + real("roughness", "0.3"))) +
         rectangle(scale("0.25") + turn("y", "160") + translate("0.1 0 0.4"),
                   thin(coloured + map("spec_trans", "grey.pgm") + real("spec_tint", "0.3") +
                        real("sheen", "0.5") + map("eta", "above_one.pfm"))) +
         rectangle(scale("0.25") + turn("x", "-60") + translate("-0.3 -0.8 0.5"),
                   bsdf("twosided", thick(colour + real("specular", "0.9"))));
}

/// Attributes of a mesh in all that takes them, in one material for two meshes, in a group, on a lamp.
inline Text attributes() {
  const auto of = [](const Text& name, const Text& attribute) {
    return "<texture name='" + name + "' type='mesh_attribute'>" + text("name", attribute) + "</texture>";
  };
  const auto tinted = [](const Text& steps, const Text& contents) {
    return shape("ply", steps, text("filename", "tinted.ply") + contents);
  };
  const Text group = "<shape type='shapegroup' id='tinted'>";
  const Text paint = bsdf("twosided", bsdf("diffuse", of("reflectance", "vertex_color")));
  return tinted(scale("0.4") + turn("y", "20") + translate("-0.5 0.5 0"), paint) +
         tinted(scale("0.35") + turn("x", "-40") + translate("0.5 0.5 0"),
                bsdf("twosided", bsdf("roughplastic",
                                      roughness("ggx", "0.2") + of("diffuse_reflectance", "face_color")))) +
         tinted(scale("0.4") + turn("y", "160") + translate("-0.5 -0.4 0.2"),
                bsdf("mask", of("opacity", "vertex_w") + paint)) +
         tinted(scale("0.3") + turn("x", "-120") + translate("0.3 -0.8 0.4"),
                diffuse("0.2") + emitter("area", of("radiance", "vertex_color"))) +
         group +
         tinted(scale("0.3"),
                bsdf("twosided", bsdf("blendbsdf", of("weight", "vertex_w") + metal("conductor") +
                                                       bsdf("diffuse", of("reflectance", "face_color"))))) +
         "</shape>" + shape("instance", turn("y", "30") + translate("0.5 -0.3 0.2"), "<ref id='tinted'/>") +
         shape("instance", step("scale", "x='-1' y='0.7' z='1'") + translate("0 0.1 -0.5"),
               "<ref id='tinted'/>");
}

}  // namespace kiloband::scene_text
