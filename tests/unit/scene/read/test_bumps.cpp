// <bsdf type="bumpmap"> and <bsdf type="normalmap">.
#include <gtest/gtest.h>

#include <fstream>

#include "support.hpp"

namespace kiloband::test::test_bumps {
namespace {

class SceneBump : public testing::Test {
 protected:
  SceneBump() {
    std::ofstream(folder_.path() / "grey.pgm") << "P2 2 2 255 0 255 255 0\n";
    std::ofstream(folder_.path() / "normals.ppm") << "P3 1 1 255 128 128 255\n";
  }
  static std::string map(const std::string& file = "grey.pgm") {
    return R"(<texture type="bitmap"><string name="filename" value=")" + file +
           R"("/><boolean name="raw" value="true"/></texture>)";
  }
  static std::string shape_with(const std::string& bsdf) {
    return scene(R"(<shape type="sphere">)" + bsdf + "</shape>" + kSensor + kLight);
  }
  Bsdf read_bsdf_of(const std::string& bsdf) const {
    return *read(shape_with(bsdf), folder_.path()).shapes.at(0).bsdf;
  }
  TemporaryFolder folder_;
};

TEST_F(SceneBump, Parameters) {
  const auto bare = std::get<BumpedBsdf>(
      read_bsdf_of(R"(<bsdf type="bumpmap">)" + map() + R"(<bsdf type="plastic"/></bsdf>)").model);
  EXPECT_FALSE(bare.normals);
  EXPECT_EQ(bare.scale, 1);
  EXPECT_TRUE(bare.flip);
  EXPECT_TRUE(bare.shadow);
  EXPECT_FALSE(bare.around_two_sided);
  EXPECT_TRUE(std::holds_alternative<PlasticBsdf>(bare.nested->model));
  const auto full = std::get<BumpedBsdf>(
      read_bsdf_of(
          R"(<bsdf type="bumpmap"><float name="scale" value="-0.25"/><boolean name="flip_invalid_normals" value="false"/>)"
          R"(<boolean name="use_shadowing_function" value="false"/>)" +
          map() + R"(<bsdf type="plastic"/></bsdf>)")
          .model);
  EXPECT_EQ(full.scale, -0.25);
  EXPECT_FALSE(full.flip);
  EXPECT_FALSE(full.shadow);
  EXPECT_TRUE(std::get<BumpedBsdf>(read_bsdf_of(R"(<bsdf type="normalmap">)" + map("normals.ppm") +
                                                R"(<bsdf type="diffuse"/></bsdf>)")
                                       .model)
                  .normals);
}

TEST_F(SceneBump, IsMovedInwards) {
  const std::string two = R"(<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>)";
  const auto mask = std::get<MaskBsdf>(
      read_bsdf_of(R"(<bsdf type="bumpmap">)" + map() + R"(<bsdf type="mask">)" + two + "</bsdf></bsdf>")
          .model);
  const auto sides = std::get<TwoSidedBsdf>(mask.nested->model);
  EXPECT_FALSE(sides.back);
  const auto leaf = std::get<BumpedBsdf>(sides.front->model);
  EXPECT_TRUE(leaf.around_two_sided);
  EXPECT_TRUE(std::holds_alternative<DiffuseBsdf>(leaf.nested->model));
}

TEST_F(SceneBump, Messages) {
  const auto bump = [](const std::string& contents, const std::string& type = "bumpmap") {
    return shape_with("<bsdf type=\"" + type + "\">" + contents + "</bsdf>");
  };
  const std::string leaf = R"(<bsdf type="diffuse"/>)";
  expect_messages(
      {{"no texture", bump(leaf), "scene.xml:2:23: error: bumpmap bsdf: needs a nested texture"},
       {"no bsdf", bump(map()), "scene.xml:2:23: error: bumpmap bsdf: needs a nested bsdf"},
       {"no bitmap", bump(R"(<texture type="checkerboard"/>)" + leaf),
        "scene.xml:2:23: error: bumpmap bsdf: the nested texture is no bitmap"},
       {"two", bump(map() + "<bsdf type=\"bumpmap\">" + map() + leaf + "</bsdf>"),
        "scene.xml:2:23: error: bumpmap bsdf: there is a bumpmap or normalmap in the nested bsdf"},
       {"one channel", bump(map() + leaf, "normalmap"),
        "scene.xml:2:23: error: normalmap bsdf: 'grey.pgm' has 1 channel, normals have 3"},
       {"scale", bump(R"(<float name="scale" value="1e7"/>)" + map() + leaf),
        "scene.xml:2:70: error: bumpmap bsdf: scale 1e+07: must be from -1e+06 to 1e+06"},
       {"scale of normals",
        bump(R"(<float name="scale" value="1"/>)" + map("normals.ppm") + leaf, "normalmap"),
        "scene.xml:2:58: error: normalmap bsdf: unknown parameter 'scale'"}},
      folder_);
}

}  // namespace
}  // namespace kiloband::test::test_bumps
