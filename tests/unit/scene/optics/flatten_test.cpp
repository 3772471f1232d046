// From thermal emitters to records: what is shared, what is a light, and what is refused with which message.
#include <gtest/gtest.h>

#include "scene/compile/flat_scene.hpp"
#include "scene/read/reader.hpp"
#include "tests/support/messages.hpp"

namespace kiloband::test {
namespace {

const std::string kSensor = R"(<sensor type="perspective"/>)";
const std::string kSky = R"(<emitter type="constant"/>)";
const std::string kPicture = R"(<texture type="checkerboard" name="specular_reflectance"/>)";

std::string thermal(const std::string& kelvin) {
  return R"(<emitter type="thermal"><float name="temperature" value=")" + kelvin + R"("/></emitter>)";
}
std::string sphere(const std::string& content) {
  return R"(<shape type="sphere">)" + content + "</shape>";
}
std::string grey(const std::string& reflectance) {
  return R"(<bsdf type="diffuse"><spectrum name="reflectance" value=")" + reflectance + R"("/></bsdf>)";
}

FlatScene flat_scene(const std::string& body, const std::string& bands = "8000-9000, 9000-10000") {
  const std::string text = "<scene version=\"3.0.0\">\n" + body + kSensor + "</scene>";
  return *compile_scene(read_scene_text(text, "scene.xml", "/nonexistent", {}),
                        {parse_channels(bands), {}, {}});
}

std::string error_of(const std::string& body) {
  return test::error_of([&] { flat_scene(body); });
}

/// An index of refraction of Planck's form is a table as any other.
TEST(Flatten, PlanckSpectraThatEmitNothing) {
  const auto conductor = [](const std::string& eta) {
    return flat_scene(kSky +
                      sphere("<bsdf type=\"conductor\">" + eta + "<float name=\"k\" value=\"3\"/></bsdf>"));
  };
  const FlatScene scene = conductor(
      R"(<spectrum type="planck" name="eta"><float name="temperature" value="3000"/><float name="scale" value="0.001"/></spectrum>)");
  std::size_t tables = 0;
  for (const SpectrumRow& row : scene.spectra) {
    EXPECT_FALSE(row.is_planck);
    tables += !row.table.values.empty();
  }
  EXPECT_EQ(tables, scene.spectra.size());
}

/// Where a number is wanted, of an image's colours it is the luminance.
TEST(Flatten, ColoursAsOpacities) {
  const TemporaryFolder folder;
  const float red[] = {1, 0, 0};
  folder.write("red.pfm", "PF\n1 1\n-1.0\n" + std::string(reinterpret_cast<const char*>(red), sizeof red));
  const std::string text =
      "<scene version=\"3.0.0\">\n" + kSky +
      sphere(
          R"(<bsdf type="mask"><texture type="bitmap" name="opacity"><string name="filename" value="red.pfm"/>)"
          R"(<boolean name="raw" value="true"/></texture><bsdf type="diffuse"/></bsdf>)") +
      kSensor + "</scene>";
  const auto scene = compile_scene(read_scene_text(text, "scene.xml", folder.path(), {}),
                                   {parse_channels("400-500"), {}, {}});
  EXPECT_TRUE(scene->texels.empty());
  ASSERT_EQ(scene->texel_bounds.size(), 1u);
  EXPECT_NEAR(scene->texel_bounds[0], 0.2126, 1e-3);
}

TEST(FlattenThermal, DiffuseSurfacesAreOneRow) {
  const FlatScene scene = flat_scene(sphere(grey("0.3") + thermal("300")));
  ASSERT_EQ(scene.thermals.size(), 2u);  // and the black back
  const KbThermal& front = scene.thermals[scene.surfaces[0].front_thermal];
  EXPECT_EQ(front.type, KB_THERMAL_UNIFORM);
  const SpectrumRow& row = scene.spectra[front.ref[0]];
  EXPECT_TRUE(row.is_planck && row.is_emission);
  EXPECT_EQ(row.temperature_k, 300);
  EXPECT_NEAR(row.table(8500), 0.7, 1e-12);
  const SpectrumRow& back = scene.spectra[scene.thermals[scene.surfaces[0].back_thermal].ref[0]];
  EXPECT_TRUE(back.is_planck && back.table.values.empty());  // Planck's law alone
  EXPECT_TRUE(scene.features.thermal);
  EXPECT_FALSE(scene.features.compensation || scene.features.temperature_field);
}

/// Only what has a temperature of its own is a light; brighter ones are chosen more often.
TEST(FlattenThermal, LightsAreChosenByTheirPower) {
  const FlatScene scene = flat_scene(
      sphere(grey("0.3")) + sphere(thermal("300")) + sphere(thermal("600")) +
      R"(<emitter type="constant"><spectrum name="radiance" value="0"/></emitter>)" + thermal("300"));
  ASSERT_EQ(scene.emitters.size(), 3u);
  EXPECT_EQ(scene.shapes[0].emitter, KB_NONE);
  EXPECT_EQ(scene.emitters[0].type, uint32_t{KB_EMITTER_THERMAL});
  EXPECT_GT(scene.emitters[1].select_pdf, 5 * scene.emitters[0].select_pdf);
  EXPECT_TRUE(scene.shapes[1].flags & KB_SHAPE_LIT_BOTH_SIDES);
}

TEST(FlattenThermal, AmbientTemperatureIsTheEnvironmentUnlessThereIsOne) {
  const FlatScene alone = flat_scene(sphere(grey("0.3")) + thermal("300"));
  ASSERT_NE(alone.environment, KB_NONE);
  EXPECT_EQ(alone.emitters[alone.environment].type, uint32_t{KB_EMITTER_CONSTANT});
  EXPECT_EQ(alone.spectra[alone.emitters[alone.environment].ref].temperature_k, 300);
  EXPECT_EQ(flat_scene(sphere(grey("0.3")) + thermal("0")).environment, KB_NONE);
}

/// Nothing at 0 K, nothing from perfect mirrors and clear glass; an area light keeps to its radiance.
TEST(FlattenThermal, WhatEmitsNothingHasNoRecord) {
  const std::string light = R"(<emitter type="area"><spectrum name="radiance" value="1"/></emitter>)";
  const FlatScene scene =
      flat_scene(sphere(grey("0.3") + thermal("0")) + sphere(R"(<bsdf type="dielectric"/>)") +
                 sphere(R"(<bsdf type="twosided"><bsdf type="conductor"/></bsdf>)") +
                 sphere(grey("0.2") + light) + thermal("300"));
  for (const KbShape& shape : scene.shapes) {
    const KbSurface& surface = scene.surfaces[shape.surface];
    EXPECT_EQ(surface.front_thermal, KB_NONE);
    EXPECT_EQ(surface.back_thermal, KB_NONE);
  }
}

/// One bsdf on a shape that emits and on one that does not: only the former is compensated.
TEST(FlattenThermal, OnlyWhatEmitsIsCompensated) {
  const std::string shared = R"(<bsdf type="roughconductor" id="m"><float name="alpha" value="0.3"/></bsdf>)";
  const FlatScene scene =
      flat_scene(shared + sphere(R"(<ref id="m"/>)") + sphere(R"(<ref id="m"/>)" + thermal("300")));
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_FALSE(scene.materials[0].flags & KB_MATERIAL_COMPENSATED);
  EXPECT_TRUE(scene.materials[1].flags & KB_MATERIAL_COMPENSATED);
  EXPECT_TRUE(scene.features.compensation);
  const std::vector<std::string> names = scene.features.names();
  EXPECT_NE(std::find(names.begin(), names.end(), "energy compensation"), names.end());
  EXPECT_NE(std::find(names.begin(), names.end(), "thermal emission"), names.end());
}

TEST(FlattenThermal, WrongInput) {
  const std::string metal = R"(<spectrum name="eta" value="2"/><spectrum name="k" value="30"/>)";
  EXPECT_EQ(
      error_of(sphere(
          R"(<bsdf type="diffuse" id="p"><spectrum name="reflectance" value="400:0.2, 8500:0.3"/></bsdf>)" +
          thermal("300"))),
      "scene.xml:2:23: error: bsdf 'p': reflectance: data from 400 to 8500 nm do not cover channel 8000-9000 "
      "nm, "
      "where the surface emits thermally: 'extrapolate' would continue them");
  EXPECT_EQ(
      error_of(sphere(R"(<bsdf type="conductor" id="m">)" + metal + kPicture + "</bsdf>" + thermal("300"))),
      "scene.xml:2:23: error: bsdf 'm': specular_reflectance: a metal that emits thermally cannot have a "
      "texture "
      "here");
  EXPECT_EQ(error_of(sphere(R"(<bsdf type="plastic"><boolean name="nonlinear" value="true"/>)"
                            R"(<texture type="checkerboard" name="diffuse_reflectance"/></bsdf>)") +
                     thermal("300")),
            "scene.xml:2:23: error: bsdf: diffuse_reflectance: a nonlinear plastic that emits thermally "
            "cannot have a "
            "texture here");
}

/// Data that do not cover a channel are accepted where they are continued, and on surfaces that do not emit.
TEST(FlattenThermal, ContinuedDataAreAccepted) {
  const std::string short_data =
      R"(<bsdf type="diffuse"><spectrum type="irregular" name="reflectance"><string name="wavelengths" value="400 8500"/>)"
      R"(<string name="values" value="0.2 0.3"/>EXTRA</spectrum></bsdf>)";
  std::string continued = short_data;
  continued.replace(continued.find("EXTRA"), 5, R"(<boolean name="extrapolate" value="true"/>)");
  EXPECT_EQ(error_of(sphere(continued + thermal("300"))), "accepted");
  std::string plain = short_data;
  plain.replace(plain.find("EXTRA"), 5, "");
  EXPECT_EQ(error_of(sphere(plain) + sphere(thermal("300"))), "accepted");
}

}  // namespace
}  // namespace kiloband::test
