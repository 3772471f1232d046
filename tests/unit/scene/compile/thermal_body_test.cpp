// What bodies that emit may be made of: dielectrics around hot gas, brushed metals.
#include <gtest/gtest.h>

#include "scene/compile/flat_scene.hpp"
#include "tests/unit/scene/compile/support.hpp"

namespace kiloband::test::thermal_body_test {
namespace {

/// Of a shape under a sky.
std::string body_flattened(const std::string& content) {
  return flattened("<sensor type='perspective'/><emitter type='constant'/><shape type='cube' id='body'>" +
                   content + "</shape>");
}

std::string number(const std::string& name, const std::string& value) {
  return "<float name='" + name + "' value='" + value + "'/>";
}
std::string bsdf(const std::string& type, const std::string& content = "") {
  return "<bsdf type='" + type + "'>" + content + "</bsdf>";
}
std::string mask(const std::string& opacity, const std::string& nested) {
  return bsdf("mask", number("opacity", opacity) + nested);
}
std::string blend(const std::string& first, const std::string& second) {
  return bsdf("blendbsdf", number("weight", "0.5") + first + second);
}
std::string gas(bool hot) {
  return "<medium type='absorbing' name='interior'><spectrum name='absorption' value='1'/>" +
         (hot ? number("temperature", "900") : "") + "</medium>";
}

const std::string kGlass = bsdf("dielectric"), kPane = bsdf("thindielectric"), kPaint = bsdf("diffuse"),
                  kPrincipled = bsdf("principled", number("spec_trans", "1")),
                  kThin = bsdf("principledthin", number("spec_trans", "1"));

/// Behind the one part of such a boundary equilibrium radiance is n^2 B, behind the other B.
TEST(ThermalBody, HotGasHasOneIndexAroundIt) {
  const std::string message =
      "error: shape 'body': a dielectric in a mask or blended with a pane cannot bound a medium with a "
      "temperature: what it emits inside depends on whether light leaves by refraction";
  for (const std::string& boundary :
       {mask("0.3", kGlass), mask("0.3", bsdf("roughdielectric")), mask("0.3", kPrincipled),
        blend(kGlass, kPane), blend(kPane, kGlass), blend(kGlass, kThin), blend(kGlass, mask("0", kPaint)),
        blend(kPaint, mask("0.3", kGlass)), mask("0.3", blend(kPaint, kGlass))}) {
    EXPECT_EQ(body_flattened(boundary + gas(true)), message) << boundary;
    EXPECT_EQ(body_flattened(boundary + gas(false)), "") << boundary;  // what only absorbs has no index
    EXPECT_EQ(body_flattened(boundary), "") << boundary;
  }
  const std::string none =
      bsdf("dielectric", number("int_ior", "1.5") + number("ext_ior", "1.5"));  // refracts nothing
  for (const std::string& boundary :
       {kGlass, kPane, kThin, kPrincipled, mask("1", kGlass), mask("0.3", kPaint), blend(kGlass, kPaint),
        mask("0.3", none), bsdf("null")})
    EXPECT_EQ(body_flattened(boundary + gas(true)), "") << boundary;
}

/// Such bodies are up to 14 % off Planck's law: nobody should learn it from the image.
TEST(ThermalBody, PartsThatDoNotRefractAreWarnedOf) {
  const auto hot = [](const std::string& kelvin) {
    return "<emitter type='thermal'>" + number("temperature", kelvin) + "</emitter>";
  };
  const std::string warning =
      "bsdf: thermal emission: a dielectric in a mask, or blended with what does not refract: a closed body of it "
      "is not in equilibrium with its surroundings";
  const std::string flat = bsdf("dielectric", number("int_ior", "1.5") + number("ext_ior", "1.5"));
  for (const std::string& surface :
       {mask("0.3", kGlass), blend(kGlass, kPaint), blend(kPaint, bsdf("roughdielectric")),
        blend(kGlass, kPane), blend(kGlass, mask("0.3", kGlass)), blend(kPaint, blend(kGlass, kPaint))}) {
    EXPECT_NE(body_flattened(surface + hot("900")).find(warning), std::string::npos) << surface;
    EXPECT_EQ(body_flattened(surface + hot("0")), "") << surface;
    EXPECT_EQ(body_flattened(surface), "") << surface;
  }
  for (const std::string& surface :
       {kGlass, kPane, kPaint, mask("1", kGlass), mask("0.3", kPaint), mask("0.3", kPane),
        blend(kGlass, kGlass), blend(kPane, kPaint), blend(flat, kPaint)})
    EXPECT_EQ(body_flattened(surface + hot("900")), "") << surface;
}

TEST(ThermalBody, LightThatStaysInRoughGlassIsWarnedOf) {
  const auto rough = [](const std::string& index, const std::string& alpha, const std::string& more = "") {
    return bsdf("roughdielectric",
                number("int_ior", index) + number("ext_ior", "1") + number("alpha", alpha) + more) +
           "<emitter type='thermal'>" + number("temperature", "350") + "</emitter>";
  };
  EXPECT_EQ(body_flattened(rough("4", "0.49")),
            "bsdf: a rough dielectric of relative index 4 that absorbs nothing keeps light inside for many "
            "bounces: means of few thousand samples may be some percent too small");
  EXPECT_EQ(body_flattened(rough("2", "0.49")), "");
  EXPECT_EQ(body_flattened(rough("4", "0.05")), "");
  EXPECT_EQ(body_flattened(rough("4", "0.49", "<spectrum name='specular_reflectance' value='0.9'/>")), "");
}

TEST(ThermalBody, EmissivitiesOfExtremelyBrushedMetalsAreWarnedOf) {
  const auto brushed = [](const std::string& type, const std::string& u, const std::string& v,
                          const std::string& more = "") {
    return bsdf(type, "<string name='distribution' value='ggx'/>" + number("alpha_u", u) +
                          number("alpha_v", v) + more);
  };
  const std::string hot = "<emitter type='thermal'>" + number("temperature", "900") + "</emitter>";
  const std::string metal = "<spectrum name='eta' value='1.5'/><spectrum name='k' value='2'/>";
  EXPECT_EQ(body_flattened(brushed("roughconductor", "0.02", "0.4", metal) + hot), "");
  EXPECT_EQ(body_flattened(brushed("roughconductor", "0.5", "0.02", metal) + hot),
            "bsdf: alpha: roughnesses in a ratio of 25, more than 20: the emissivity may be off by 0.01");
  EXPECT_EQ(body_flattened(brushed("roughconductor", "0.001", "0.3", metal) + hot),
            "bsdf: alpha: roughnesses in a ratio of 300, more than 20: the emissivity may be off by 0.2");
  EXPECT_EQ(body_flattened(brushed("roughconductor", "0.001", "0.3", metal)), "");
  EXPECT_EQ(body_flattened(
                brushed("roughconductor", "0.001", "0.3", "<string name='material' value='none'/>") + hot),
            "");
}

}  // namespace
}  // namespace kiloband::test::thermal_body_test
