// principled and principledthin: defaults, parameters, what is refused.
#include <gtest/gtest.h>

#include <cmath>

#include "support.hpp"

namespace kiloband::test::test_principled {
namespace {

PrincipledBsdf read_one(const std::string& bsdf, const std::filesystem::path& folder = "/nonexistent") {
  const auto description =
      read(scene(R"(<shape type="sphere">)" + bsdf + "</shape>" + kSensor + kLight), folder);
  return std::get<PrincipledBsdf>(description.shapes.at(0).bsdf->model);
}

PrincipledBsdf thick(const std::string& contents) {
  return read_one(R"(<bsdf type="principled">)" + contents + "</bsdf>");
}

PrincipledBsdf thin(const std::string& contents) {
  return read_one(R"(<bsdf type="principledthin">)" + contents + "</bsdf>");
}

std::string number(const std::string& name, const std::string& value) {
  return "<float name='" + name + "' value='" + value + "'/>";
}

TEST(ScenePrincipled, Defaults) {
  for (const PrincipledBsdf& bsdf : {thick(""), thin("")}) {
    EXPECT_EQ(std::get<Spectrum>(bsdf.base_color)(550), 0.5);
    EXPECT_EQ(bsdf.numbers[KB_PRINCIPLED_ROUGHNESS].number, 0.5);
    EXPECT_NEAR(bsdf.numbers[KB_PRINCIPLED_ETA].number, 1.5, 1e-12);
    for (const int n :
         {KB_PRINCIPLED_ANISOTROPIC, KB_PRINCIPLED_METALLIC, KB_PRINCIPLED_SPEC_TRANS,
          KB_PRINCIPLED_SPEC_TINT, KB_PRINCIPLED_SHEEN, KB_PRINCIPLED_SHEEN_TINT, KB_PRINCIPLED_FLATNESS,
          KB_PRINCIPLED_CLEARCOAT, KB_PRINCIPLED_CLEARCOAT_GLOSS, KB_PRINCIPLED_DIFF_TRANS})
      EXPECT_EQ(bsdf.numbers[n].number, 0) << n;
    for (const double rate : bsdf.rates) EXPECT_EQ(rate, 1);
  }
  EXPECT_FALSE(thick("").thin);
  EXPECT_TRUE(thin("").thin);
}

/// 0.08 specular = ((eta - 1) / (eta + 1))^2; where light is refracted the two sides differ, as in Mitsuba 3.9.1.
TEST(ScenePrincipled, TheIndexIsEtaOrSpecular) {
  const auto eta = [](const std::string& contents) {
    return thick(contents).numbers[KB_PRINCIPLED_ETA].number;
  };
  for (const double specular : {0.1, 0.5, 1.0, 2.15}) {
    const double index = eta(number("specular", std::to_string(specular)));
    EXPECT_NEAR(std::pow((index - 1) / (index + 1), 2), 0.08 * specular, 1e-9);
  }
  EXPECT_EQ(eta(number("specular", "0")), 1);
  EXPECT_EQ(eta(number("eta", "1")), 1);
  EXPECT_EQ(eta(number("eta", "1") + number("spec_trans", "1")), 1.001);
  EXPECT_GT(eta(number("specular", "0") + number("spec_trans", "1")), 1.01);
  EXPECT_NEAR(eta("<string name='eta' value='water'/>"), 1.333, 1e-9);
}

TEST(ScenePrincipled, EveryNumberIsRead) {
  const std::pair<const char*, KbPrincipledNumber> both[] = {
      {"roughness", KB_PRINCIPLED_ROUGHNESS},   {"anisotropic", KB_PRINCIPLED_ANISOTROPIC},
      {"spec_trans", KB_PRINCIPLED_SPEC_TRANS}, {"spec_tint", KB_PRINCIPLED_SPEC_TINT},
      {"sheen", KB_PRINCIPLED_SHEEN},           {"sheen_tint", KB_PRINCIPLED_SHEEN_TINT},
      {"flatness", KB_PRINCIPLED_FLATNESS}};
  for (const auto& [name, place] : both) {
    EXPECT_EQ(thick(number(name, "0.25")).numbers[place].number, 0.25) << name;
    EXPECT_EQ(thin(number(name, "0.25")).numbers[place].number, 0.25) << name;
  }
  EXPECT_EQ(thick(number("metallic", "0.25")).numbers[KB_PRINCIPLED_METALLIC].number, 0.25);
  EXPECT_EQ(thick(number("clearcoat", "0.25")).numbers[KB_PRINCIPLED_CLEARCOAT].number, 0.25);
  EXPECT_EQ(thick(number("clearcoat_gloss", "0.25")).numbers[KB_PRINCIPLED_CLEARCOAT_GLOSS].number, 0.25);
  EXPECT_EQ(thin(number("diff_trans", "1.25")).numbers[KB_PRINCIPLED_DIFF_TRANS].number, 1.25);
  EXPECT_EQ(thin(number("eta", "1.25")).numbers[KB_PRINCIPLED_ETA].number, 1.25);
  EXPECT_EQ(thick(number("clearcoat_sampling_rate", "3")).rates[2], 3);
  EXPECT_EQ(thin(number("diffuse_transmittance_sampling_rate", "3")).rates[3], 3);
}

TEST(ScenePrincipled, NumbersMayBeBitmaps) {
  const TemporaryFolder folder;
  folder.write("map.pgm", "P2\n2 1\n255\n0 255\n");
  const std::string map =
      "<texture type='bitmap' name='metallic'><string name='filename' value='map.pgm'/></texture>";
  const PrincipledBsdf bsdf = read_one(R"(<bsdf type="principled">)" + map + "</bsdf>", folder.path());
  EXPECT_TRUE(bsdf.numbers[KB_PRINCIPLED_METALLIC].map);
  EXPECT_FALSE(bsdf.numbers[KB_PRINCIPLED_ROUGHNESS].map);
}

TEST(ScenePrincipled, WhatPassesLight) {
  EXPECT_FALSE(passes_light(thick("")));
  EXPECT_TRUE(passes_light(thick(number("spec_trans", "0.1"))));
  EXPECT_FALSE(passes_light(thick(number("spec_trans", "0.1") + number("metallic", "1"))));
  EXPECT_TRUE(passes_light(thin("")));
}

std::string error_of(const std::string& bsdf) {
  try {
    read_one(bsdf);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(ScenePrincipled, Errors) {
  EXPECT_EQ(error_of("<bsdf type='principled'>" + number("roughness", "1.5") + "</bsdf>"),
            "scene.xml:2:77: error: principled bsdf: roughness 1.5: must be from 0 to 1");
  EXPECT_EQ(error_of("<bsdf type='principled'>" + number("eta", "0.7") + "</bsdf>"),
            "scene.xml:2:71: error: principled bsdf: eta 0.7: must be from 1 to 10");
  EXPECT_EQ(
      error_of("<bsdf type='principled'>" + number("eta", "1.3") + number("specular", "0.5") + "</bsdf>"),
      "scene.xml:2:107: error: principled bsdf: 'specular' together with 'eta'");
  EXPECT_EQ(error_of("<bsdf type='principledthin'>" + number("diff_trans", "3") + "</bsdf>"),
            "scene.xml:2:82: error: principledthin bsdf: diff_trans 3: must be from 0 to 2");
  EXPECT_NE(error_of("<bsdf type='principledthin'>" + number("metallic", "1") + "</bsdf>").find("unknown"),
            std::string::npos);
  EXPECT_NE(error_of("<bsdf type='twosided'><bsdf type='principled'>" + number("spec_trans", "1") +
                     "</bsdf></bsdf>")
                .find("transmits light"),
            std::string::npos);
}

}  // namespace
}  // namespace kiloband::test::test_principled
