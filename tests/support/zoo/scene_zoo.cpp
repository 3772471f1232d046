#include "tests/support/zoo/scene_zoo.hpp"

#include <stdexcept>

#include "tests/support/scene_text.hpp"
#include "tests/support/zoo/scene_gas_text.hpp"
#include "tests/support/zoo/scene_lamp_text.hpp"
#include "tests/support/zoo/scene_room_text.hpp"
#include "tests/support/zoo/scene_surface_text.hpp"

namespace kiloband::test {
namespace {

using namespace scene_text;

// ---- the scenes' parts ----

Text boxes() {
  return shape("cube",
               step("scale", "x='0.3' y='0.55' z='0.3'") + turn("y", "20") + translate("-0.35 -0.45 -0.3"),
               diffuse("0.6")) +
         mesh("gem.obj", scale("0.45") + translate("0.4 -0.5 0.3"), diffuse("450:0.7, 650:0.3"));
}

Text metals() {
  return ball("-0.6 0.4 -0.2", "0.3", metal("conductor")) +
         ball("0 0.4 -0.2", "0.3", metal("roughconductor", roughness("ggx", "0.25"))) +
         ball("0.6 0.4 -0.2", "0.3", metal("roughconductor", roughness("beckmann", "0.25"))) +
         ball("-0.6 -0.5 0.1", "0.3", metal("roughconductor", roughness("ggx", "0.1", "0.4"))) +
         ball("0 -0.5 0.1", "0.3", metal("roughconductor", roughness("beckmann", "0.4", "0.15"))) +
         mesh(
             "gem.obj", scale("0.3") + translate("0.6 -0.5 0.1"),
             metal("roughconductor", roughness("ggx", "0.3") + number("boolean", "sample_visible", "false")));
}

Text glasses() {
  return ball("-0.55 0.4 -0.2", "0.35",
              bsdf("dielectric", spectrum("specular_transmittance", "450:0.9, 650:0.6"))) +
         ball("0.4 0.4 -0.2", "0.35", bsdf("roughdielectric", roughness("ggx", "0.3"))) +
         ball("-0.5 -0.5 0.1", "0.35",
              bsdf("roughdielectric", roughness("beckmann", "0.2") + real("int_ior", "1.8"))) +
         shape("cube", scale("0.3") + turn("y", "30") + translate("0.4 -0.65 0.1"),
               bsdf("roughdielectric", roughness("ggx", "0.2", "0.5")));
}

Text plastics() {
  const Text colour = "<rgb name='diffuse_reflectance' value='0.6, 0.3, 0.2'/>";
  return ball("-0.5 0.4 -0.2", "0.4", bsdf("plastic", colour)) +
         ball("0.5 0.4 -0.2", "0.4", bsdf("plastic", colour + yes("nonlinear"))) +
         ball("-0.5 -0.5 0.1", "0.4", bsdf("roughplastic", colour + roughness("beckmann", "0.2"))) +
         ball("0.5 -0.5 0.1", "0.4",
              bsdf("roughplastic",
                   roughness("ggx", "0.3") + yes("nonlinear") +
                       bitmap("diffuse_reflectance", "colours.ppm", "repeat", "bilinear", scale("3"))));
}

Text sheets() {
  const Text two = bsdf("twosided", diffuse("450:0.8, 650:0.2") + bsdf("plastic"));
  const Text holes = bitmap("opacity", "grey.pgm", "repeat", "nearest", scale("2"));
  return rectangle(scale("0.4") + turn("y", "150") + translate("-0.5 0.4 0"), two) +
         rectangle(scale("0.4") + turn("x", "-30") + translate("0.5 0.4 0"), bsdf("mask", holes + two)) +
         shape("disk", scale("0.4") + translate("-0.5 -0.5 0.2"),
               bsdf("mask", real("opacity", "0.6") + diffuse("0.7"))) +
         ball("0.5 -0.5 0", "0.4", bsdf("mask", real("opacity", "0.7") + bsdf("dielectric"))) +
         shape("rectangle", scale("0.3") + translate("0 0 0.3"), yes("flip_normals") + diffuse("0.8")) +
         mesh("gem.obj", scale("0.3") + translate("0 -0.2 -0.5"),
              yes("flip_normals") + bsdf("twosided", metal("conductor")));
}

Text pictures() {
  const auto paper = [](const Text& wrap, const Text& filter, const Text& to_uv) {
    return bsdf("diffuse", bitmap("reflectance", "colours.ppm", wrap, filter, to_uv));
  };
  return floor(paper("repeat", "bilinear", scale("2.7") + turn("z", "25"))) +
         back(paper("mirror", "bilinear", scale("3.1") + step("translate", "x='-0.7' y='0.3'"))) +
         left(paper("clamp", "bilinear", scale("1.9") + step("translate", "x='-0.4' y='-0.4'"))) +
         right(bsdf("diffuse", checkerboard("reflectance", scale("3") + turn("z", "20")))) +
         ceiling(paper("mirror", "nearest", scale("2.3"))) +
         ball("-0.4 -0.4 0", "0.4",
              bsdf("twosided", paper("repeat", "nearest", step("scale", "x='4' y='2'")))) +
         ball("0.4 -0.4 0", "0.4",
              bsdf("roughconductor", roughness("ggx", "0.3") + bitmap("specular_reflectance", "colours.ppm",
                                                                      "clamp", "nearest", scale("2"))));
}

Text glowing_shapes() {
  const Text black = diffuse("0.1");
  return ball("-0.6 0.5 0", "0.2", black + lamp("450:2, 650:5")) +
         shape("disk", scale("0.25") + turn("x", "40") + translate("0 0.6 0"), black + lamp("450:6, 650:3")) +
         shape("cylinder",
               step("scale", "x='0.1' y='0.1' z='0.8'") + turn("y", "90") + translate("0.1 -0.2 0.2"),
               black + lamp("4")) +
         mesh("gem.obj", scale("0.25") + translate("0.6 0.3 0"), black + lamp("450:5, 550:1, 650:5")) +
         rectangle(
             scale("0.4") + turn("x", "-60") + translate("-0.4 -0.6 0.3"),
             black + emitter("area", bitmap("radiance", "colours.ppm", "repeat", "bilinear", scale("1.5"))));
}

/// Bands of reflectance, mixtures, and a lamp of bands.
Text spectral_pictures() {
  const Text bands = text("filename", "bands.exr");
  const Text mixtures = text("weights", "colours.ppm") + spectrum("endmember_0", "450:0.3, 650:0.1") +
                        spectrum("endmember_1", "450:0.1, 550:0.4, 650:0.1") + spectrum("endmember_2", "0.2");
  const auto paper = [](const Text& source, const Text& wrap, const Text& filter, const Text& to_uv) {
    return bsdf("diffuse", spectral_bitmap("reflectance", source, wrap, filter, to_uv));
  };
  return floor(paper(bands, "repeat", "bilinear", scale("2.7") + turn("z", "25"))) +
         back(paper(mixtures, "mirror", "bilinear", scale("3.1"))) +
         left(paper(bands, "clamp", "nearest", scale("1.9"))) + right(diffuse("450:0.2, 650:0.7")) +
         ball("-0.4 -0.4 0", "0.4",
              bsdf("plastic",
                   spectral_bitmap("diffuse_reflectance", mixtures, "repeat", "bilinear", scale("2")))) +
         ball("0.4 -0.4 0", "0.4",
              bsdf("roughconductor",
                   roughness("ggx", "0.3") +
                       spectral_bitmap("specular_reflectance", bands, "mirror", "bilinear", scale("2")))) +
         rectangle(scale("0.4") + turn("x", "60") + translate("-0.3 0.7 0.3"),
                   diffuse("0.1") + emitter("area", spectral_bitmap("radiance", text("filename", "glow.hdr"),
                                                                    "repeat", "bilinear", scale("1.5"))));
}

Text analytic_shapes() {
  return shape("cylinder",
               step("scale", "x='0.3' y='0.3' z='0.9'") + turn("x", "-70") + translate("-0.5 -0.5 0"),
               bsdf("twosided", bsdf("plastic"))) +
         shape("disk", scale("0.5") + turn("y", "-30") + translate("0.5 0.4 -0.3"), metal("roughconductor")) +
         ball("0.4 -0.5 0.2", "0.35", bsdf("dielectric")) +
         shape("sphere", scale("0.3") + translate("-0.4 0.5 0"),
               yes("flip_normals") + bsdf("twosided", diffuse("0.8")));
}

/// Materials by name: metals, and a flint glass.
Text named_materials() {
  return ball("-0.6 0.4 -0.2", "0.35", bsdf("conductor", text("metal", "Al"))) +
         ball("0.5 0.4 -0.2", "0.35", bsdf("roughconductor", text("metal", "Au") + roughness("ggx", "0.2"))) +
         ball("-0.3 -0.5 0.2", "0.4", bsdf("dielectric", text("int_material", "SF11"))) +
         ball("0.6 -0.6 0", "0.3",
              bsdf("roughconductor", text("metal", "Ti") + roughness("beckmann", "0.3")));
}

/// Spheres one behind the other and a shell: chains of refractions.
Text lenses() {
  const Text glass = bsdf("dielectric");
  return ball("-0.5 -0.3 0.3", "0.45", glass) + ball("0.45 0 0.4", "0.5", glass) +
         ball("0.45 0 0.4", "0.35", bsdf("dielectric", text("int_ior", "air") + text("ext_ior", "bk7"))) +
         ball("-0.2 0.5 -0.4", "0.4", glass);
}

/// Panes one behind the other, coloured, dispersive, masked.
Text panes() {
  const Text window = scale("0.5"), coloured = spectrum("specular_transmittance", "450:0.9, 650:0.5");
  return rectangle(window + turn("y", "25") + translate("-0.4 0.3 0.4"), bsdf("thindielectric", coloured)) +
         rectangle(window + turn("y", "-155") + translate("-0.3 0.2 0"),
                   bsdf("thindielectric", real("int_ior", "1.9"))) +
         rectangle(window + turn("y", "-35") + translate("0.5 0.1 0.4"),
                   dispersive("thindielectric", coloured)) +
         ball("0.5 -0.5 0", "0.35", dispersive("thindielectric")) +
         ball("-0.5 -0.6 0.2", "0.3", bsdf("mask", real("opacity", "0.6") + bsdf("thindielectric")));
}

/// Blends of every kind, in each other, in masks, on two sides.
Text blends() {
  const auto blend = [](const Text& weight, const Text& parts) { return bsdf("blendbsdf", weight + parts); };
  const Text half = real("weight", "0.5"), quarter = real("weight", "0.25");
  const Text picture = bitmap("weight", "grey.pgm", "repeat", "bilinear", scale("2"));
  const Text red = diffuse("450:0.2, 650:0.8"), gold = metal("roughconductor", roughness("ggx", "0.2"));
  const Text coat = bsdf("roughplastic", roughness("ggx", "0.2"));
  return ball("-0.6 0.4 -0.2", "0.35", blend(picture, red + gold)) +
         ball("0.1 0.4 -0.2", "0.35", blend(quarter, bsdf("dielectric") + red)) +
         ball("0.7 0.4 -0.2", "0.3", blend(half, coat + blend(picture, metal("conductor") + red))) +
         rectangle(scale("0.35") + turn("y", "150") + translate("-0.5 -0.5 0.2"),
                   bsdf("twosided", blend(picture, red + gold) + blend(quarter, coat + red))) +
         ball("0.3 -0.5 0.2", "0.3", bsdf("mask", real("opacity", "0.7") + blend(half, red + gold))) +
         ball("0.8 -0.6 0", "0.25",
              blend(half, dispersive("roughdielectric", roughness("ggx", "0.2")) +
                              bsdf("mask", real("opacity", "0.5") + red)));
}

Text instance(const Text& group, const Text& steps) {
  return shape("instance", steps, "<ref id='" + group + "'/>");
}

/// Groups in groups, mirrored, stretched and flattened: smooth and flat meshes, glass, bumps, pictures, analytic shapes.
Text instances() {
  const Text group = "<shape type='shapegroup' id='";
  const Text coat =
      bsdf("bumpmap", real("scale", "0.02") + bitmap("map", "colours.ppm", "repeat", "bilinear", scale("1")) +
                          bsdf("plastic"));
  return group + "stones'>" + mesh("gem.obj", scale("0.25") + translate("0 0.1 0"), bsdf("dielectric")) +
         shape("cube", scale("0.12") + turn("y", "30") + translate("0.35 0 0"), coat) +
         rectangle(scale("0.2") + turn("x", "-50") + translate("-0.3 0 0.1"),
                   bsdf("twosided", metal("roughconductor", roughness("ggx", "0.2", "0.5")))) +
         "</shape>" + group + "pair'>" + instance("stones", translate("0 0.2 0")) +
         instance("stones",
                  step("scale", "x='-0.8' y='0.5' z='0.8'") + turn("z", "20") + translate("0 -0.2 0.1")) +
         "</shape>" + group + "balls'>" + ball("0 0 0", "0.15", metal("conductor")) +
         rectangle(scale("0.15") + translate("0.3 0 0"), yes("flip_normals") + diffuse("450:0.8, 650:0.3")) +
         "</shape>" + instance("pair", translate("-0.4 0 0")) +
         instance("pair", turn("y", "100") + turn("x", "15") + translate("0.45 -0.1 -0.2")) +
         instance("stones",
                  step("scale", "x='1' y='0.05' z='1'") + turn("z", "-30") + translate("0.3 0.6 0.2")) +
         instance("balls", turn("y", "180") + translate("0.2 -0.7 0.4")) +
         instance("balls",
                  step("scale", "x='-1.2' y='1.2' z='1.2'") + turn("z", "40") + translate("-0.5 0.6 0.2"));
}

/// What files store otherwise and means the same: merged shapes, strips, surfaces split at creases, mixtures.
Text stored_otherwise() {
  const Text mixture = bsdf("mixturebsdf", text("weights", "0.5, 0.2, 0.1") + diffuse("450:0.8, 650:0.2") +
                                               bsdf("plastic") + metal("conductor"));
  return "<shape type='merge'>" + ball("-0.5 0.4 -0.2", "0.3", mixture) +
         ball("0.3 0.5 0", "0.2", diffuse("0.3") + lamp("450:3, 650:5")) + "</shape>" +
         mesh("gem.obj", scale("0.4") + translate("0.5 -0.5 0.2"),
              real("max_smooth_angle", "30") + diffuse("0.7")) +
         shape("ply", scale("0.4") + translate("-0.4 -0.5 0.1"),
               text("filename", "strip.ply") + bsdf("plastic"));
}

/// One ray, to a ball of glass among others.
Text meter() {
  return object(
      "sensor", "radiancemeter",
      "<point name='origin' x='0.1' y='0.2' z='4.3'/><vector name='direction' x='-0.5' y='0.15' z='-4.5'/>" +
          film(size(1, 1), "box"));
}

/// Walls of mirrors, a mirroring ball between them.
Text mirrors() {
  const Text mirror = bsdf("conductor", spectrum("specular_reflectance", "450:0.95, 650:0.9"));
  return floor(diffuse("0.5")) + back(mirror) + left(mirror) + right(mirror) + ceiling(mirror) +
         rectangle(scale("1.1") + turn("y", "180") + translate("0 0 4.5"), mirror) +
         ball("0.3 -0.5 0", "0.45", metal("conductor")) +
         ball("-0.5 0.3 0.2", "0.15", diffuse("0") + lamp("450:8, 650:5"));
}

/// Hot and warm things of all materials, in a warm room.
Text hot_things() {
  const Text base = spectrum("diffuse_reflectance", "450:0.3, 650:0.6");
  return ball("-0.1 0 0.3", "0.15",
              bsdf("blendbsdf", real("weight", "0.3") + diffuse("0.3") + metal("conductor")) +
                  thermal("2350")) +
         rectangle(scale("0.2") + translate("0.4 0 0.4"),
                   bsdf("thindielectric", spectrum("specular_transmittance", "0.7")) + thermal("2250")) +
         ball("-0.6 0.4 -0.2", "0.3", metal("roughconductor", roughness("ggx", "0.3")) + thermal("2400")) +
         ball("0 0.4 -0.2", "0.3", metal("roughconductor", roughness("beckmann", "0.1", "0.4"))) +
         ball("0.6 0.4 -0.2", "0.3", metal("conductor") + thermal("2200")) +
         ball("-0.6 -0.5 0.1", "0.3", bsdf("roughplastic", base + roughness("ggx", "0.2"))) +
         ball("0 -0.5 0.1", "0.3",
              bsdf("roughdielectric", roughness("ggx", "0.3") + spectrum("specular_transmittance", "0.8"))) +
         rectangle(scale("0.3") + turn("y", "30") + translate("0.6 -0.5 0.1"),
                   bsdf("twosided", bsdf("plastic", base) + diffuse("0.4")) + thermal("2300"));
}

/// Temperatures by image and by vertex, on pictures and on metal.
Text heated_shapes() {
  const Text by_vertex = emitter("thermal", text("temperature_attribute", "kelvin"));
  const Text by_image =
      emitter("thermal", bitmap("temperature", "kelvin.pfm", "clamp", "bilinear", scale("1")));
  const Text picture =
      bsdf("diffuse", bitmap("reflectance", "colours.ppm", "repeat", "bilinear", scale("2")));
  return rectangle(scale("0.45") + turn("y", "20") + translate("-0.5 0.4 0"), picture + by_image) +
         rectangle(scale("0.4") + turn("x", "-40") + translate("0.5 -0.5 0.2"),
                   bsdf("mask", real("opacity", "0.7") + diffuse("0.2")) + by_image) +
         shape("ply", scale("0.4") + translate("0.5 0.4 -0.2"),
               text("filename", "hot.ply") + metal("roughconductor", roughness("ggx", "0.3")) + by_vertex) +
         shape("ply", scale("0.4") + turn("x", "-60") + translate("-0.4 -0.5 0.2"),
               text("filename", "hot.ply") + bsdf("twosided", picture) + by_vertex);
}

const Text kEnvmap = emitter("envmap", text("filename", "sky.pfm") + real("scale", "0.8") +
                                           to_world(turn("y", "70") + turn("x", "15")));

const Text kSpectralSky = emitter("spectral_envmap", text("filename", "bright.exr") + real("scale", "0.8") +
                                                         to_world(turn("y", "70") + turn("x", "15")));

Text crop_window() {
  return size(70, 56) + crop(18, 11, 32, 32);
}

std::vector<ZooScene> make_scenes() {
  const Text lit_room = room() + ceiling_lamp();
  const Text objects = floor(diffuse("0.6")) + analytic_shapes();
  constexpr Chains kLong = Chains::kSpecular, kCurved = Chains::kCurved;
  return {
      {"diffuse_room", scene(8, perspective(small_film("gaussian")) + lit_room + boxes())},
      {"metals", scene(6, perspective(small_film("tent")) + lit_room + metals()), kCurved},
      {"glasses", scene(10, perspective(small_film("box")) + lit_room + glasses() + sky("0.5")), kCurved},
      {"plastics", scene(6, perspective(small_film("gaussian")) + lit_room + plastics()), kCurved},
      {"sheets", scene(8, perspective(small_film("tent")) + lit_room + sheets()), kCurved},
      {"pictures", scene(6, perspective(small_film("gaussian")) + pictures() + ceiling_lamp())},
      {"spectral_pictures",
       scene(6, perspective(small_film("gaussian")) + spectral_pictures() + ceiling_lamp())},
      {"spectral_sky", scene(6, thinlens(small_film("gaussian")) + objects + kSpectralSky)},
      {"glowing_shapes", scene(5, perspective(small_film("box")) + room() + glowing_shapes())},
      {"constant_sky", scene(6, thinlens(small_film("tent")) + objects + sky("450:0.8, 650:1.2"))},
      {"envmap", scene(6, thinlens(small_film("gaussian")) + objects + kEnvmap)},
      {"delta_lights", scene(5, orthographic(small_film("box")) + room() + boxes() + delta_lights())},
      {"projected_lights", scene(5, perspective(small_film("box")) + room() + boxes() + projected_lights())},
      {"suns",
       scene(6, perspective(small_film("gaussian")) + floor(diffuse("0.5")) + suns() + sky("0.2") + metals() +
                    ball("0 0.1 0.5", "0.25", bsdf("dielectric")) +
                    ball("0.6 0.9 0", "0.2", bsdf("roughdielectric", roughness("ggx", "0.2")))),
       kCurved},
      {"analytic_shapes", scene(8, orthographic(small_film("tent")) + lit_room + analytic_shapes()), kCurved},
      {"prism",
       scene(10,
             perspective(small_film("gaussian")) + lit_room +
                 mesh("prism.obj", scale("0.7"), dispersive("dielectric")),
             ""),
       kCurved},
      {"rough_dispersion",
       scene(10, perspective(small_film("gaussian")) + lit_room +
                     ball("0 -0.2 0", "0.6", dispersive("roughdielectric", roughness("ggx", "0.2")))),
       kCurved},
      {"panes", scene(10, perspective(small_film("gaussian")) + lit_room + panes()), kCurved},
      {"blends", scene(8, perspective(small_film("gaussian")) + lit_room + blends() + sky("0.3")), kCurved},
      {"roughness_maps", scene(6, perspective(small_film("tent")) + lit_room + roughness_maps() + sky("0.3")),
       kCurved},
      {"principled", scene(7, perspective(small_film("tent")) + lit_room + principled(true) + sky("0.3")),
       kCurved},
      {"principled_dispersion",
       scene(7, perspective(small_film("box")) + lit_room + principled(false) +
                    ball("0.1 -0.1 0.3", "0.2", dispersive("dielectric"))),
       kCurved},
      {"attributes", scene(6, perspective(small_film("tent")) + lit_room + attributes() + sky("0.3"))},
      {"bumps",
       scene(5, perspective(small_film("gaussian")) + left(diffuse("0.5")) + right(diffuse("0.5")) +
                    ceiling(diffuse("0.5")) + bumps() + ceiling_lamp() + sky("0.3")),
       kCurved},
      {"instances", scene(6, perspective(small_film("gaussian")) + lit_room + instances() + sky("0.3")),
       kCurved},
      {"instances_in_gas",
       scene(5, perspective(small_film("box")) + lit_room + instances() +
                    gas("atmosphere", "450:0.1, 650:0.4") + delta_lights()),
       kCurved},
      {"stored_otherwise",
       scene(6, perspective(small_film("tent")) + lit_room + stored_otherwise() + sky("0.3")), kCurved},
      {"many_lights",
       scene(5, perspective(small_film("gaussian")) + room() + boxes() + small_lamps() + glowing_shapes() +
                    delta_lights() + sky("0.1")),
       kCurved},
      {"meter", scene(8, meter() + lit_room + glasses() + sky("0.5")), kCurved},
      {"named_materials", scene(8, perspective(small_film("gaussian")) + lit_room + named_materials()),
       kCurved},
      {"gases", scene(8, thinlens(small_film("tent")) + lit_room + gases() + delta_lights() + sky("0.5")),
       kCurved},
      {"plumes", scene(4, perspective(small_film("box")) + lit_room + plumes() + sky("0.3")), Chains::kPlume},
      {"mirror_box", scene(50, perspective(small_film("box")) + mirrors()), kLong},
      {"lenses", scene(50, perspective(small_film("gaussian")) + lit_room + lenses()), kLong},
      {"unlimited_depth",
       scene(-1, perspective(small_film("gaussian")) + floor(diffuse("0.95")) + back(diffuse("0.95")) +
                     left(diffuse("0.9")) + right(diffuse("0.95")) + ceiling(diffuse("0.95")) + boxes() +
                     sky("0.7"))},
      {"mitchell", scene(6, thinlens(small_film("mitchell")) + pictures() + ceiling_lamp())},
      {"lanczos", scene(8, perspective(small_film("lanczos")) + lit_room + gases() + sky("0.5")), kCurved},
      {"crop_window",
       scene(6, perspective(small_film("gaussian", crop_window())) + lit_room + metals() + glasses()),
       kCurved},
      {"thermal", scene(6, perspective(small_film("gaussian")) + room() + hot_things() + thermal("1900")),
       kCurved},
      {"temperature_field",
       scene(6, perspective(small_film("gaussian")) + room() + ceiling_lamp() + heated_shapes())},
      {"hidden_emitters",
       scene(6, thinlens(small_film("box")) + objects + glowing_shapes() + kEnvmap, yes("hide_emitters"))},
  };
}

}  // namespace

const std::vector<ZooScene>& scene_zoo() {
  static const std::vector<ZooScene> scenes = make_scenes();
  return scenes;
}

const ZooScene& zoo_scene(const std::string& name) {
  for (const ZooScene& scene : scene_zoo()) {
    if (scene.name == name) return scene;
  }
  throw std::out_of_range("no scene '" + name + "' in the zoo");
}

}  // namespace kiloband::test
