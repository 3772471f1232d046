// Every bsdf: defaults and parameters.
#include <gtest/gtest.h>

#include "spectral/materials/materials.hpp"
#include "support.hpp"

namespace kiloband::test::test_bsdfs {
namespace {

std::shared_ptr<const Bsdf> bsdf_of(const std::string& bsdf,
                                    const std::filesystem::path& folder = "/nonexistent") {
  return read(scene(R"(<shape type="sphere">)" + bsdf + "</shape>" + kSensor + kLight), folder)
      .shapes.at(0)
      .bsdf;
}

template <typename Model>
Model model_of(const std::string& bsdf, const std::filesystem::path& folder = "/nonexistent") {
  return std::get<Model>(bsdf_of(bsdf, folder)->model);
}

double value(const Texture& texture) {
  return std::get<Spectrum>(texture)(550);
}

TEST(SceneBsdf, ShapesWithoutBsdfAreGreyAndEmittersBlack) {
  EXPECT_EQ(value(model_of<DiffuseBsdf>("").reflectance), 0.5);
  EXPECT_EQ(value(model_of<DiffuseBsdf>(R"(<emitter type="area"/>)").reflectance), 0);
}

TEST(SceneBsdf, ConductorDefaultsToThePerfectMirror) {
  const auto mirror =
      model_of<ConductorBsdf>(R"(<bsdf type="conductor"><string name="material" value="none"/></bsdf>)");
  EXPECT_EQ(mirror.eta(550), 0);
  EXPECT_EQ(mirror.k(550), 1);
  EXPECT_FALSE(mirror.roughness);
}

TEST(SceneBsdf, RoughnessParameters) {
  const auto plain = model_of<ConductorBsdf>(R"(<bsdf type="roughconductor"/>)");
  ASSERT_TRUE(plain.roughness);
  EXPECT_EQ(plain.roughness->distribution, Microfacet::kBeckmann);
  EXPECT_EQ(plain.roughness->alpha_u, 0.1);
  EXPECT_TRUE(plain.roughness->sample_visible);
  const auto brushed = model_of<ConductorBsdf>(
      R"(<bsdf type="roughconductor"><float name="alpha_u" value="0.3"/><float name="alpha_v" value="0.05"/>)"
      R"(<string name="distribution" value="GGX"/><boolean name="sample_visible" value="false"/></bsdf>)");
  EXPECT_EQ(brushed.roughness->distribution, Microfacet::kGgx);
  EXPECT_EQ(brushed.roughness->alpha_u, 0.3);
  EXPECT_EQ(brushed.roughness->alpha_v, 0.05);
  EXPECT_FALSE(brushed.roughness->map_u || brushed.roughness->map_v);
  EXPECT_FALSE(brushed.roughness->sample_visible);
}

TEST(SceneBsdf, RoughnessMayBeABitmap) {
  const TemporaryFolder folder;
  folder.write("map.pgm", "P2\n2 1\n255\n0 255\n");
  const auto map = [](const char* name) {
    return "<texture type='bitmap' name='" + std::string(name) +
           "'><string name='filename' value='map.pgm'/></texture>";
  };
  const auto even =
      model_of<ConductorBsdf>("<bsdf type='roughconductor'>" + map("alpha") + "</bsdf>", folder.path());
  ASSERT_TRUE(even.roughness->map_u);
  EXPECT_EQ(even.roughness->map_u, even.roughness->map_v);
  const auto glass = model_of<DielectricBsdf>(
      "<bsdf type='roughdielectric'>" + map("alpha_v") + "<float name='alpha_u' value='0.3'/></bsdf>",
      folder.path());
  EXPECT_FALSE(glass.roughness->map_u);
  EXPECT_EQ(glass.roughness->alpha_u, 0.3);
  EXPECT_TRUE(glass.roughness->map_v);
}

TEST(SceneBsdf, DielectricIndices) {
  const auto glass = model_of<DielectricBsdf>(R"(<bsdf type="dielectric"/>)");
  EXPECT_EQ(glass.int_ior(550), 1.5046);
  EXPECT_EQ(glass.ext_ior(550), 1.000277);
  const auto other = model_of<DielectricBsdf>(
      R"(<bsdf type="roughdielectric"><string name="int_ior" value="diamond"/><float name="ext_ior" value="1.1"/></bsdf>)");
  EXPECT_EQ(other.int_ior(550), 2.419);
  EXPECT_EQ(other.ext_ior(550), 1.1);
  EXPECT_TRUE(other.roughness);
}

TEST(SceneBsdf, PanesAreDielectrics) {
  const auto pane = model_of<DielectricBsdf>(R"(<bsdf type="thindielectric"/>)");
  EXPECT_TRUE(pane.thin);
  EXPECT_EQ(pane.int_ior(550), 1.5046);
  EXPECT_EQ(pane.ext_ior(550), 1.000277);
  EXPECT_EQ(value(pane.specular_reflectance), 1);
  EXPECT_EQ(value(pane.specular_transmittance), 1);
  EXPECT_FALSE(pane.roughness);
  EXPECT_FALSE(model_of<DielectricBsdf>(R"(<bsdf type="dielectric"/>)").thin);
}

TEST(SceneBsdf, BlendsKeepTheOrder) {
  const auto blend = model_of<BlendBsdf>(
      R"(<bsdf type="blendbsdf"><float name="weight" value="0.3"/><bsdf type="plastic"/><bsdf type="diffuse"/></bsdf>)");
  EXPECT_EQ(value(blend.weight), 0.3);
  EXPECT_TRUE(std::holds_alternative<PlasticBsdf>(blend.first->model));
  EXPECT_TRUE(std::holds_alternative<DiffuseBsdf>(blend.second->model));
}

std::string mixture(const std::string& weights, const std::string& bsdfs) {
  return R"(<bsdf type="mixturebsdf"><string name="weights" value=")" + weights + "\"/>" + bsdfs + "</bsdf>";
}

const std::string kThree = R"(<bsdf type="plastic"/><bsdf type="conductor"/><bsdf type="diffuse"/>)";

TEST(SceneBsdf, MixturesAreBlendsInsideEachOther) {
  // Plastic 0.2, conductor 0.3, diffuse 0.5: of the second blend the diffuse one has 0.5 / 0.8.
  for (const char* weights : {"0.2, 0.3, 0.5", "0.4 0.6 1"}) {
    const auto outer = model_of<BlendBsdf>(mixture(weights, kThree));
    EXPECT_NEAR(value(outer.weight), 0.8, 1e-15);
    EXPECT_TRUE(std::holds_alternative<PlasticBsdf>(outer.first->model));
    const auto inner = std::get<BlendBsdf>(outer.second->model);
    EXPECT_NEAR(value(inner.weight), 0.625, 1e-15);
    EXPECT_TRUE(std::holds_alternative<ConductorBsdf>(inner.first->model));
    EXPECT_EQ(value(std::get<DiffuseBsdf>(inner.second->model).reflectance), 0.5);
  }
}

TEST(SceneBsdf, WhatAMixtureLeavesIsAbsorbed) {
  const auto outer = model_of<BlendBsdf>(mixture("0.25", R"(<bsdf type="plastic"/>)"));
  EXPECT_EQ(value(outer.weight), 0.75);
  EXPECT_TRUE(std::holds_alternative<PlasticBsdf>(outer.first->model));
  EXPECT_EQ(value(std::get<DiffuseBsdf>(outer.second->model).reflectance), 0);
}

TEST(SceneBsdf, MixturesOfOneAndWeightsOfZero) {
  EXPECT_EQ(value(model_of<DiffuseBsdf>(mixture("1", R"(<bsdf type="diffuse"/>)")).reflectance), 0.5);
  const auto outer = model_of<BlendBsdf>(mixture("1, 0, 0", kThree));
  EXPECT_EQ(value(outer.weight), 0);
  EXPECT_TRUE(std::holds_alternative<PlasticBsdf>(outer.first->model));
  EXPECT_EQ(value(std::get<BlendBsdf>(outer.second->model).weight), 0);
}

TEST(SceneBsdf, MitsubasNamesOfConductors) {
  for (const std::string name : {"Au", "W", "Ni_palik"}) {
    Messages messages;
    const auto description =
        read(scene(R"(<shape type="sphere"><bsdf type="roughconductor"><string name="material" value=")" +
                   name + R"("/></bsdf></shape>)" + kSensor + kLight),
             "/nonexistent", {}, messages.lines());
    const auto& metal = std::get<ConductorBsdf>(description.shapes.at(0).bsdf->model);
    const auto own = find_metal(name.substr(0, 2) == "Ni" ? "Ni" : name);
    EXPECT_EQ(metal.eta(550), own->n(550)) << name;
    EXPECT_EQ(metal.k(550), (*own->k)(550)) << name;
    ASSERT_EQ(messages.texts.size(), 1u);
    EXPECT_EQ(messages.texts[0], "scene.xml:2:81: note: roughconductor bsdf: material '" + name +
                                     "': n and k are kiloband's own data of this metal");
  }
  const std::string beyond = R"(<bsdf type="conductor"><string name="material" value="Pd"/>)";
  EXPECT_EQ(model_of<ConductorBsdf>(beyond + "</bsdf>").k(15000), 0);
  EXPECT_GT(model_of<ConductorBsdf>(beyond + R"(<boolean name="extrapolate" value="true"/></bsdf>)").k(15000),
            1);
}

TEST(SceneBsdf, OpticalConstantsFromFiles) {
  const TemporaryFolder folder;
  folder.write("glass.txt", "400 1.6\n800 1.5\n");
  folder.write("metal.txt", "400 0.5 3\n800 0.7 5\n");
  const auto glass = model_of<DielectricBsdf>(
      R"(<bsdf type="dielectric"><string name="int_material" value="glass.txt"/></bsdf>)", folder.path());
  EXPECT_NEAR(glass.int_ior(600), 1.55, 1e-12);
  EXPECT_EQ(glass.ext_ior(600), 1.000277);
  const auto metal = model_of<ConductorBsdf>(
      R"(<bsdf type="roughconductor"><string name="metal" value="metal.txt"/></bsdf>)", folder.path());
  EXPECT_NEAR(metal.eta(600), 0.6, 1e-12);
  EXPECT_NEAR(metal.k(600), 4, 1e-12);
  folder.write("power.csv", "nm,n (W/m2/um)\n500,1.5\n700,1.5\n");  // was 0.0015
  const std::string eta =
      R"(<bsdf type="conductor"><spectrum name="eta" filename="power.csv"/><spectrum name="k" value="3"/></bsdf>)";
  EXPECT_NE(error_of(folder, [&] { read(complete_scene(eta), folder.path()); })
                .find("must be numbers without a unit"),
            std::string::npos);
}

TEST(SceneBsdf, BuiltInMaterials) {
  const auto glass = model_of<DielectricBsdf>(
      R"(<bsdf type="dielectric"><string name="int_material" value="n-bk7"/><string name="ext_material" value="water"/></bsdf>)");
  EXPECT_NEAR(glass.int_ior(587.5618), 1.51680, 5e-6);
  EXPECT_NEAR(glass.ext_ior(589.3), 1.33335, 2e-5);
  EXPECT_EQ(glass.int_ior(2600), 0);
  const auto metal = model_of<ConductorBsdf>(
      R"(<bsdf type="roughconductor"><string name="metal" value="Al"/><boolean name="extrapolate" value="true"/></bsdf>)");
  EXPECT_EQ(metal.eta(60), metal.eta(metal.eta.data_range()->min_nm));
  EXPECT_GT(metal.k(60), 0);
}

/// A file of that name comes before the built-in material.
TEST(SceneBsdf, FilesComeBeforeBuiltInNames) {
  const TemporaryFolder folder;
  folder.write("SF11", "400 1.6\n800 1.5\n");
  const auto glass = model_of<DielectricBsdf>(
      R"(<bsdf type="dielectric"><string name="int_material" value="SF11"/></bsdf>)", folder.path());
  EXPECT_NEAR(glass.int_ior(600), 1.55, 1e-12);
}

TEST(SceneBsdf, Plastic) {
  const auto plastic = model_of<PlasticBsdf>(R"(<bsdf type="plastic"/>)");
  EXPECT_EQ(plastic.int_ior, 1.49);
  EXPECT_EQ(plastic.ext_ior, 1.000277);
  EXPECT_EQ(value(plastic.diffuse_reflectance), 0.5);
  EXPECT_EQ(value(plastic.specular_reflectance), 1);
  EXPECT_FALSE(plastic.nonlinear);
  const auto rough = model_of<PlasticBsdf>(
      R"(<bsdf type="roughplastic"><float name="alpha" value="0.2"/><boolean name="nonlinear" value="true"/></bsdf>)");
  EXPECT_EQ(rough.roughness->alpha_v, 0.2);
  EXPECT_TRUE(rough.nonlinear);
}

TEST(SceneBsdf, TwoSidedAndMask) {
  const auto two = model_of<TwoSidedBsdf>(
      R"(<bsdf type="twosided"><bsdf type="diffuse" id="a"/><bsdf type="plastic" id="b"/></bsdf>)");
  EXPECT_EQ(two.front->id, "a");
  EXPECT_EQ(two.back->id, "b");
  const auto one = model_of<TwoSidedBsdf>(R"(<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>)");
  EXPECT_EQ(one.back, nullptr);
  const auto mask = model_of<MaskBsdf>(
      R"(<bsdf type="mask"><float name="opacity" value="0.25"/><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></bsdf>)");
  EXPECT_EQ(value(mask.opacity), 0.25);
  EXPECT_TRUE(std::holds_alternative<TwoSidedBsdf>(mask.nested->model));
}

/// Neither the channels of an image nor its guide bands may change what is where: the luminance and the mean of the data ask for none.
TEST(SceneBsdf, SpectraAsSharesAreOneNumber) {
  const auto share_of = [](const std::string& opacity, std::string* warnings) {
    Messages messages;
    const SceneDescription scene = read(complete_scene("<shape type=\"disk\"><bsdf type=\"mask\">" + opacity +
                                                       "<bsdf type=\"diffuse\"/></bsdf></shape>"),
                                        "/nonexistent", {}, messages.lines());
    for (const std::string& text : messages.texts) *warnings += text + "\n";
    return value(std::get<MaskBsdf>(scene.shapes.at(0).bsdf->model).opacity);
  };
  struct Case {
    std::string opacity;
    double share, tolerance;
    std::string warning;
  };
  const std::vector<Case> cases = {
      {R"(<spectrum name="opacity" value="0.5"/>)", 0.5, 0, ""},
      {R"(<rgb name="opacity" value="0.5"/>)", 0.5, 0, ""},
      {R"(<spectrum name="opacity" value="400:0, 700:1"/>)", 0.5, 1e-12,
       "the mean of its data, 0.5, is taken"},
      {R"(<spectrum name="opacity" value="8000:0.2, 9000:0.2, 10000:0.6"/>)", 0.3, 1e-12, "0.3, is taken"},
      {R"(<rgb name="opacity" value="0.9, 0.3, 0.1"/>)", 0.2126 * 0.9 + 0.7152 * 0.3 + 0.0722 * 0.1, 2e-3,
       "mask bsdf: opacity: one number for all wavelengths: its luminance, 0.41"}};
  for (const Case& c : cases) {
    std::string warnings;
    EXPECT_NEAR(share_of(c.opacity, &warnings), c.share, c.tolerance) << c.opacity;
    EXPECT_EQ(warnings.empty(), c.warning.empty()) << warnings;
    EXPECT_NE(warnings.find(c.warning), std::string::npos) << warnings;
  }
}

TEST(SceneBsdf, CheckerboardsAreSharedThroughReferences) {
  const SceneDescription result = read(complete_scene(
      R"(<texture type="checkerboard" id="board"><rgb name="color0" value="0.9"/></texture>)"
      R"(<shape type="disk"><bsdf type="diffuse"><ref id="board" name="reflectance"/></bsdf></shape>)"
      R"(<shape type="disk"><bsdf type="diffuse"><ref id="board" name="reflectance"/></bsdf></shape>)"));
  using Board = std::shared_ptr<const CheckerboardTexture>;
  const auto board = [&](std::size_t i) {
    return std::get<Board>(std::get<DiffuseBsdf>(result.shapes.at(i).bsdf->model).reflectance);
  };
  EXPECT_EQ(board(0), board(1));
  EXPECT_EQ(board(0)->id, "board");
  EXPECT_EQ(board(0)->color0(550), 0.9);
  EXPECT_EQ(board(0)->color1(550), 0.2);
}

TEST(SceneBsdf, NamesAndFilesThatAreNearlyRight) {
  expect_messages({
      {"material in capitals",
       complete_scene(R"xml(<bsdf type="dielectric"><string name="int_ior" value="BK7"/></bsdf>)xml"),
       "scene.xml:2:55: error: dielectric bsdf: int_ior: unknown material 'BK7'; did you mean 'bk7'?"},
      {"part of a glass's name",
       complete_scene(R"xml(<bsdf type="dielectric"><string name="int_material" value="bk7"/></bsdf>)xml"),
       "scene.xml:2:60: error: dielectric bsdf: int_material: 'bk7' is neither a built-in transparent "
       "material nor a file; did you mean 'N-BK7'?"},
      {"missing file that is to be continued",
       complete_scene(
           R"xml(<bsdf type="conductor"><string name="metal" value="no.yml"/><boolean name="extrapolate" value="true"/></bsdf>)xml"),
       "scene.xml:2:52: error: file 'no.yml' not found"},
      {"missing spectrum that is to be continued",
       complete_scene(
           R"xml(<bsdf type="diffuse"><spectrum type="file" name="reflectance"><string name="filename" value="no.spd"/><boolean name="extrapolate" value="true"/></spectrum></bsdf>)xml"),
       "scene.xml:2:94: error: file 'no.spd' not found"},
  });
}

/// What is raw are numbers: three of them are no spectrum, whatever asks for one. Numbers may be the luminance of three.
TEST(SceneBsdf, RawBitmapsOfThreeChannelsAreNoSpectra) {
  const TemporaryFolder folder;
  folder.write("red.ppm", "P3\n1 1\n255\n230 26 26\n");
  folder.write("grey.pgm", "P2\n1 1\n255\n26\n");
  const auto image = [](const std::string& name, const std::string& file, bool raw = true) {
    return "<texture type='bitmap' name='" + name + "'><string name='filename' value='" + file +
           "'/><boolean name='raw' value='" + (raw ? "true" : "false") + "'/></texture>";
  };
  const auto message = [&](const std::string& in_shape, const std::string& in_scene = "") {
    return error_of(scene("<shape type='sphere'>" + in_shape + "</shape>" + in_scene + kSensor + kLight),
                    folder.path());
  };
  const auto surface = [](const std::string& type, const std::string& contents) {
    return "<bsdf type='" + type + "'>" + contents + "</bsdf>";
  };
  const std::string rule =
      ": 'red.ppm' is raw and has three channels, which are no spectrum: leave raw out, or give it one channel";
  const auto refused = [&](const std::string& said, const std::string& name) {
    EXPECT_NE(said.find(name + rule), std::string::npos) << said;
  };
  refused(message(surface("diffuse", image("reflectance", "red.ppm"))), "error: diffuse bsdf: reflectance");
  refused(message(surface("plastic", image("diffuse_reflectance", "red.ppm"))), "diffuse_reflectance");
  refused(message(surface("principled", image("base_color", "red.ppm"))), "base_color");
  refused(message("<emitter type='area'>" + image("radiance", "red.ppm") + "</emitter>"), "radiance");
  refused(message("", "<emitter type='projector'>" + image("irradiance", "red.ppm") + "</emitter>"),
          "irradiance");
  refused(message("", "<emitter type='spot'>" + image("texture", "red.ppm") + "</emitter>"), "texture");
  for (const std::string& accepted :
       {surface("diffuse", image("reflectance", "grey.pgm")),
        surface("diffuse", image("reflectance", "red.ppm", false)),
        surface("mask", image("opacity", "red.ppm") + surface("diffuse", "")),
        surface("blendbsdf", image("weight", "red.ppm") + surface("diffuse", "") + surface("plastic", "")),
        surface("roughconductor", image("alpha", "red.ppm")),
        surface("principled", image("roughness", "red.ppm")),
        surface("bumpmap", image("height", "red.ppm") + surface("diffuse", "")),
        surface("normalmap", image("normalmap", "red.ppm") + surface("diffuse", ""))})
    EXPECT_EQ(message(accepted), "accepted") << accepted;
}

}  // namespace
}  // namespace kiloband::test::test_bsdfs
