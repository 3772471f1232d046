// Gases: elements, their defaults, files of absorption coefficients, messages.
#include <gtest/gtest.h>

#include "spectral/files/spectrum_files.hpp"
#include "support.hpp"

namespace kiloband::test::test_media {
namespace {

const std::string kAbsorption = R"(<spectrum name="absorption" value="0.5"/>)";
const std::string kNull = R"(<bsdf type="null"/>)";

SceneDescription with_atmosphere(const std::string& content,
                                 const std::filesystem::path& folder = "/nonexistent") {
  return read(complete_scene("<medium name=\"atmosphere\" " + content + "</medium>"), folder);
}

TEST(SceneMedium, AbsorbingGas) {
  const SceneDescription cold = with_atmosphere("type=\"absorbing\">" + kAbsorption);
  ASSERT_TRUE(cold.atmosphere);
  EXPECT_EQ(cold.atmosphere->absorption(4500), 0.5);
  EXPECT_EQ(cold.atmosphere->scale, 1);
  EXPECT_FALSE(cold.atmosphere->temperature_k);
  EXPECT_EQ(cold.atmosphere->spectrum, GasSpectrum::kSampled);
  const SceneDescription hot = with_atmosphere(
      "type=\"absorbing\" id=\"air\">" + kAbsorption +
      R"(<float name="temperature" value="300"/><float name="scale" value="2.5"/><string name="spectral" value="correlated_k"/>)");
  EXPECT_EQ(hot.atmosphere->id, "air");
  EXPECT_EQ(hot.atmosphere->temperature_k, 300);
  EXPECT_EQ(hot.atmosphere->scale, 2.5);
  EXPECT_EQ(hot.atmosphere->spectrum, GasSpectrum::kCorrelatedK);
}

TEST(SceneMedium, InteriorsAreSharedByReference) {
  const SceneDescription scene = read(complete_scene(
      "<medium type=\"absorbing\" id=\"gas\">" + kAbsorption + "</medium><shape type=\"sphere\">" + kNull +
      "<ref name=\"interior\" id=\"gas\"/></shape><shape type=\"cube\">" + kNull +
      "<ref name=\"interior\" id=\"gas\"/></shape>"));
  EXPECT_FALSE(scene.atmosphere);
  ASSERT_TRUE(scene.shapes.at(0).interior);
  EXPECT_EQ(scene.shapes[0].interior, scene.shapes[1].interior);
  EXPECT_FALSE(scene.shapes[2].interior);
  EXPECT_TRUE(std::holds_alternative<NullBsdf>(scene.shapes[0].bsdf->model));
}

TEST(SceneMedium, GasThatEmitsIsALight) {
  const std::string gas = "<medium type=\"absorbing\" name=\"atmosphere\">" + kAbsorption;
  const std::string hot = gas + R"(<float name="temperature" value="300"/></medium>)";
  EXPECT_EQ(error_of(scene(kSensor + kSphere + hot)), "accepted");
  EXPECT_EQ(error_of(scene(kSensor + kSphere + gas + "</medium>")),
            "scene.xml:1:2: error: scene: has no emitter");
}

TEST(SceneMedium, Plumes) {
  const TemporaryFolder folder;
  folder.write("plume.txt", "temperature scale\n500 1\n600 2\n700 3\n800 4\n900 5\n1000 6\n1100 7\n1200 0\n");
  const SceneDescription jet = with_atmosphere(
      "type=\"plume\">" + kAbsorption +
      R"(<float name="temperature" value="1500"/><float name="ambient" value="290"/><float name="radius" value="0.4"/>)"
      R"(<float name="length" value="12"/><float name="spread" value="0.1"/><transform name="to_world"><translate x="3"/></transform>)");
  const auto& field = std::get<JetField>(jet.atmosphere->field);
  EXPECT_EQ(field.temperature_k, 1500);
  EXPECT_EQ(field.ambient_k, 290);
  EXPECT_EQ(field.radius, 0.4);
  EXPECT_EQ(field.length, 12);
  EXPECT_EQ(field.spread, 0.1);
  EXPECT_EQ(field.to_world[3].x, 3);
  const SceneDescription lattice = with_atmosphere(
      "type=\"plume\">" + kAbsorption +
          R"(<string name="field" value="grid"/><string name="nodes" value="2 2 2"/><string name="filename" value="plume.txt"/>)",
      folder.path());
  const auto& grid = std::get<GridField>(lattice.atmosphere->field);
  EXPECT_EQ(grid.nodes, (std::array<uint32_t, 3>{2, 2, 2}));
  ASSERT_EQ(grid.values.size(), 8u);
  EXPECT_EQ(grid.values[1].temperature_k, 600);
  EXPECT_EQ(grid.values[7].scale, 0);
}

TEST(SceneMedium, FilesOfAbsorptionSayTheirUnit) {
  const TemporaryFolder folder;
  const auto at_4500 = [&](const std::string& text) {
    return read_spectrum_file(folder.write("gas.txt", text), ValueKind::kAbsorption)(4500);
  };
  EXPECT_DOUBLE_EQ(at_4500("4000 2\n5000 4\n"), 3);
  EXPECT_DOUBLE_EQ(at_4500("wavelength_nm,absorption (1/m)\n4000,2\n5000,4\n"), 3);
  EXPECT_DOUBLE_EQ(at_4500("wavelength_nm,kappa_cm-1\n4000,2\n5000,4\n"), 300);
  EXPECT_DOUBLE_EQ(at_4500("# absorption coefficient in cm^-1\n4000 2\n5000 4\n"), 300);
  EXPECT_DOUBLE_EQ(at_4500("# absorption coefficient in m-1\n4000 2\n5000 4\n"), 3);
  EXPECT_DOUBLE_EQ(at_4500("# units {\"absorbance\": \"\", \"abscoeff\": \"cm-1\"}\n4000 2\n5000 4\n"), 300);
  // RADIS, which does not always say it: the axis is in nm here.
  EXPECT_DOUBLE_EQ(
      at_4500("# abscoeff (2 points)\n# wavenum_max 2500 cm-1\n# wavenum_min 2000 cm-1\n4000 2\n5000 4\n"),
      300);
  EXPECT_NEAR(at_4500("wavenumber,abscoeff\n# abscoeff cm-1\n2000,4\n2500,2\n"), 300, 1e-9);
}

/// Inside <shape type="sphere"> with a null bsdf.
std::string in_sphere(const std::string& content) {
  return complete_scene("<shape type=\"sphere\">" + kNull + content + "</shape>");
}
std::string medium(const std::string& attributes, const std::string& content) {
  return complete_scene("<medium name=\"atmosphere\" " + attributes + ">" + content + "</medium>");
}

TEST(SceneMedium, WrongInputIsNamed) {
  const TemporaryFolder folder;
  folder.write("short.txt", "500 1\n600 2\n");
  folder.write("cold.txt", "500 1\n600 2\n700 3\n0 4\n900 5\n1000 6\n1100 7\n1200 0\n");
  folder.write("minus.txt", "500 1\n600 2\n700 3\n800 4\n900 5\n1000 -6\n1100 7\n1200 0\n");
  const std::string grid =
      kAbsorption + R"(<string name="field" value="grid"/><string name="nodes" value="2 2 2"/>)";
  expect_messages(
      {
          {"unknown type", medium(R"(type="heterogeneous")", ""),
           "scene.xml:2:33: error: medium type 'heterogeneous' is not supported: nothing scatters in a volume "
           "here; 'absorbing' is a medium that absorbs"},
          {"scattering in Mitsuba's medium",
           medium(R"(type="homogeneous")", R"(<rgb name="albedo" value="0, 0.1, 0"/>)"),
           "scene.xml:2:72: error: homogeneous medium: albedo: nothing scatters in a volume here: must be 0"},
          {"no absorption", medium(R"(type="absorbing")", ""),
           "scene.xml:2:2: error: absorbing medium: parameter 'absorption' is missing"},
          {"negative absorption",
           medium(R"(type="absorbing")", R"(<spectrum name="absorption" value="400:1, 500:-2"/>)"),
           "scene.xml:2:79: error: absorbing medium: absorption -2 at 500 nm: must be >= 0"},
          {"emission as absorption",
           medium(
               R"(type="absorbing")",
               R"(<spectrum name="absorption" type="planck"><float name="temperature" value="300"/></spectrum>)"),
           "scene.xml:2:78: error: planck spectrum describes emission: not allowed as an absorption"},
          {"temperature 0",
           medium(R"(type="absorbing")", kAbsorption + R"(<float name="temperature" value="0"/>)"),
           "scene.xml:2:118: error: absorbing medium: temperature 0: must be > 0 K"},
          {"negative scale",
           medium(R"(type="absorbing")", kAbsorption + R"(<float name="scale" value="-1"/>)"),
           "scene.xml:2:112: error: absorbing medium: scale -1: must be >= 0"},
          {"scattering", medium(R"(type="absorbing")", kAbsorption + R"(<float name="albedo" value="0.5"/>)"),
           "scene.xml:2:98: error: absorbing medium: unknown parameter 'albedo'"},
          {"phase function", medium(R"(type="absorbing")", kAbsorption + R"(<phase type="isotropic"/>)"),
           "scene.xml:2:86: error: absorbing medium: a phase is not allowed here"},
          {"phase of the scene", complete_scene(R"(<phase type="isotropic"/>)"),
           "scene.xml:2:2: error: <phase> is not supported: gases do not scatter"},
          {"unknown treatment",
           medium(R"(type="absorbing")", kAbsorption + R"(<string name="spectral" value="exact"/>)"),
           "scene.xml:2:116: error: absorbing medium: spectral 'exact': must be one of sampled, "
           "correlated_k"},
          {"two atmospheres",
           medium(R"(type="absorbing")",
                  kAbsorption + R"(</medium><medium type="absorbing" name="atmosphere">)"),
           "scene.xml:2:125: error: scene: parameter 'atmosphere' is given twice"},
          {"medium of the scene with another name",
           complete_scene("<medium type=\"absorbing\" name=\"air\">" + kAbsorption + "</medium>"),
           "scene.xml:2:32: error: a medium of the scene must be named 'atmosphere', not 'air'"},
          {"exterior", in_sphere("<medium type=\"absorbing\" name=\"exterior\">" + kAbsorption + "</medium>"),
           "scene.xml:2:42: error: sphere shape: a medium must be named 'interior'; what is outside is the "
           "medium around the "
           "shape, or the atmosphere"},
          {"without a name", in_sphere("<medium type=\"absorbing\">" + kAbsorption + "</medium>"),
           "scene.xml:2:42: error: sphere shape: a medium must be named 'interior'"},
          {"null bsdf that emits", in_sphere(R"(<emitter type="area"/>)"),
           "scene.xml:2:2: error: sphere shape: a shape with a null bsdf cannot emit"},
          {"null bsdf that is hot",
           in_sphere(R"(<emitter type="thermal"><float name="temperature" value="300"/></emitter>)"),
           "scene.xml:2:2: error: sphere shape: a shape with a null bsdf cannot emit"},
          {"null bsdf in a twosided", complete_scene(R"(<bsdf type="twosided"><bsdf type="null"/></bsdf>)"),
           "scene.xml:2:2: error: twosided bsdf: the nested null bsdf transmits light"},
          {"jet without a radius",
           medium(
               R"(type="plume")",
               kAbsorption + R"(<float name="temperature" value="900"/><float name="ambient" value="300"/>)"),
           "scene.xml:2:2: error: plume medium: parameter 'radius' is missing"},
          {"nodes",
           medium(R"(type="plume")",
                  kAbsorption + R"(<string name="field" value="grid"/><string name="nodes" value="2 1 2"/>)"),
           "scene.xml:2:144: error: plume medium: nodes 1: must be a whole number >= 2"},
          {"two numbers of nodes",
           medium(R"(type="plume")",
                  kAbsorption + R"(<string name="field" value="grid"/><string name="nodes" value="2 2"/>)"),
           "scene.xml:2:144: error: plume medium: nodes: expected 3 numbers, found 2"},
          {"number of nodes",
           medium(R"(type="plume")", grid + R"(<string name="filename" value="short.txt"/>)"),
           "scene.xml:2:183: error: short.txt: 2 nodes: must be 8"},
          {"cold node", medium(R"(type="plume")", grid + R"(<string name="filename" value="cold.txt"/>)"),
           "scene.xml:2:183: error: cold.txt:4: temperature 0: must be > 0 K"},
          {"negative node",
           medium(R"(type="plume")", grid + R"(<string name="filename" value="minus.txt"/>)"),
           "scene.xml:2:183: error: minus.txt:6: scale -6: must be >= 0"},
      },
      folder);
}

TEST(SceneMedium, WhatHasNoEffectIsReported) {
  Messages messages;
  read(complete_scene("<medium type=\"absorbing\" id=\"gas\">" + kAbsorption + "</medium>"), "/nonexistent",
       {}, messages.lines());
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_EQ(messages.texts[0],
            "scene.xml:2:2: warning: medium 'gas': is not part of a shape and has no effect");
  messages.texts.clear();
  read(complete_scene("<shape type=\"sphere\"><medium type=\"absorbing\" name=\"interior\">" + kAbsorption +
                      "</medium></shape>"),
       "/nonexistent", {}, messages.lines());
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_EQ(
      messages.texts[0],
      "scene.xml:2:2: warning: sphere shape: its bsdf is opaque, so that its interior medium has no effect");
}

TEST(SceneMedium, NormalsAgainstTheWindingAreReported) {
  const TemporaryFolder folder;
  folder.write(
      "mesh.obj",
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 -1\nf 1//1 2//1 3//1\nf 1//2 3//2 4//2\n");
  Messages messages;
  for (const std::string bsdf : {"dielectric", "null"})
    read(complete_scene("<shape type=\"obj\"><string name=\"filename\" value=\"mesh.obj\"/><bsdf type=\"" +
                        bsdf + "\"/><medium type=\"absorbing\" name=\"interior\">" + kAbsorption +
                        "</medium></shape>"),
         folder.path(), {}, messages.lines());
  ASSERT_EQ(messages.texts.size(), 1u);  // a null boundary has no inside of its own
  EXPECT_EQ(messages.texts[0],
            "scene.xml:2:2: warning: obj shape: the vertex normals of 1 of 2 triangles point against their "
            "winding: "
            "the winding says where its interior medium is, the normals say what is inside for its bsdf");
}

}  // namespace
}  // namespace kiloband::test::test_media
