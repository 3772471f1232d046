// Values far beyond what exists are slips: each parameter has a limit and a message.
#include <gtest/gtest.h>

#include "support.hpp"

namespace kiloband::test::test_value_limits {
namespace {

std::string bsdf(const std::string& type, const std::string& inner) {
  return complete_scene("<shape type='disk'><bsdf type='" + type + "'>" + inner + "</bsdf></shape>");
}
std::string number(const std::string& name, const std::string& value) {
  return "<float name='" + name + "' value='" + value + "'/>";
}
std::string emitter(const std::string& type, const std::string& inner) {
  return scene("<emitter type='" + type + "'>" + inner + "</emitter>" + kSensor + kSphere);
}
std::string medium(const std::string& inner) {
  return complete_scene("<medium type='absorbing' name='atmosphere'>" + inner + "</medium>");
}
std::string spectrum(const std::string& name, const std::string& value) {
  return "<spectrum name='" + name + "' value='" + value + "'/>";
}

/// What stands behind the position.
std::string rule_of(const std::string& text, const TemporaryFolder& folder) {
  const std::string message = error_of(text, folder);
  const std::size_t at = message.find("error: ");
  return at == std::string::npos ? message : message.substr(at + 7);
}

TEST(ValueLimits, HaveTheirMessages) {
  const TemporaryFolder folder;
  folder.write("steep.yml",
               "DATA:\n  - type: formula 2\n    wavelength_range: 0.3 2.5\n    coefficients: 0 1e30 0.01\n");
  folder.write("bright.txt", "# nm\n400 1e20 1\n500 1 1\n");
  folder.write("hot.txt", "2e5 1\n300 1\n300 1\n300 1\n300 1\n300 1\n300 1\n300 1\n");
  const std::string planck = "<spectrum type='planck' name='radiance'>";
  const std::string plume = "<shape type='cube'><bsdf type='null'/><medium type='plume' name='interior'>";
  const std::string grid = spectrum("absorption", "1") +
                           "<string name='field' value='grid'/><string name='nodes' value='2 2 2'/>"
                           "<string name='filename' value='hot.txt'/></medium></shape>";
  const std::pair<std::string, const char*> cases[] = {
      {bsdf("conductor", number("k", "1e10")), "conductor bsdf: k 1e+10: must be <= 1e+05"},
      {bsdf("conductor", spectrum("eta", "400:1, 500:1e10")),
       "conductor bsdf: eta 1e+10 at 500 nm: must be from 0 to 1e+05"},
      {bsdf("conductor", "<string name='metal' value='bright.txt'/>"),
       "conductor bsdf: metal index 1e+20 at 400 nm: must be from 0 to 1e+05"},
      {bsdf("dielectric", number("int_ior", "1e10")),
       "dielectric bsdf: int_ior 1e+10: must be from 0.001 to 1000"},
      {bsdf("dielectric", number("ext_ior", "1e-30")),
       "dielectric bsdf: ext_ior 1e-30: must be from 0.001 to 1000"},
      {bsdf("dielectric", "<string name='int_material' value='steep.yml'/>"),
       "steep.yml:2: formula 2 gives n = 1060660171779821.2 at 0.3 um: must be <= 1e+05"},
      {bsdf("roughconductor", number("alpha", "1e10")),
       "roughconductor bsdf: alpha 1e+10: must be from 1e-06 to 100"},
      {bsdf("roughconductor", number("alpha_u", "1e-30") + number("alpha_v", "1")),
       "roughconductor bsdf: alpha_u 1e-30: must be from 1e-06 to 100"},
      {emitter("constant", spectrum("radiance", "1e38")),
       "constant emitter: radiance 1e+38: must be <= 1e+15 W m^-2 sr^-1 nm^-1"},
      {emitter("constant", number("radiance", "1e38")),
       "constant emitter: radiance 1e+38: must be <= 1e+15 W m^-2 sr^-1 nm^-1"},
      {emitter("constant", "<rgb name='radiance' value='1 2 1e38'/>"),
       "constant emitter: radiance rgb component 1e+38: must be <= 1e+15 W m^-2 sr^-1 nm^-1"},
      {emitter("point", spectrum("intensity", "400:1, 500:1e30")),
       "point emitter: intensity 1e+30 at 500 nm: must be <= 1e+15 W sr^-1 nm^-1"},
      {emitter("directional", spectrum("irradiance", "1e30")),
       "directional emitter: irradiance 1e+30: must be <= 1e+15 W m^-2 nm^-1"},
      {emitter("constant", planck + number("temperature", "1e20") + "</spectrum>"),
       "planck spectrum: temperature 1e+20: must be <= 1e+05 K"},
      {emitter("constant", planck + number("temperature", "1e5") + number("scale", "1e30") + "</spectrum>"),
       "planck spectrum: scale 1e+30: must be <= 1e+15"},
      {medium(spectrum("absorption", "1e30")), "absorbing medium: absorption 1e+30: must be <= 1e+15 1/m"},
      {medium(spectrum("absorption", "1e10") + number("scale", "1e10")),
       "absorbing medium: absorption times scale 1e+20: must be <= 1e+15 1/m"},
      {medium(spectrum("absorption", "0") + number("scale", "1e300")),
       "absorbing medium: scale 1e+300: must be <= 1e+30"},
      {medium(spectrum("absorption", "1") + number("temperature", "1e20")),
       "absorbing medium: temperature 1e+20: must be from 1 to 100000 K"},
      {medium(spectrum("absorption", "1") + number("temperature", "1e-30")),
       "absorbing medium: temperature 1e-30: must be from 1 to 100000 K"},
      {complete_scene(plume + grid), "hot.txt:1: temperature 2e+05: must be from 1 to 100000 K"},
      {scene("<sensor type='thinlens'>" + number("aperture_radius", "1e30") + "</sensor>"),
       "thinlens sensor: aperture_radius 1e+30: must be <= 1e+09 m"},
      {scene("<sensor type='thinlens'>" + number("aperture_radius", "1") + number("focus_distance", "1e30") +
             "</sensor>"),
       "thinlens sensor: focus_distance 1e+30: must be from 1e-06 to 1e+09 m"},
      {scene("<sensor type='perspective'>" + number("near_clip", "1e30") + number("far_clip", "1e31") +
             "</sensor>"),
       "perspective sensor: near_clip 1e+30: must be <= 1e+09 m"},
      {scene("<sensor type='perspective'>" + number("principal_point_offset_x", "1e30") + "</sensor>"),
       "perspective sensor: principal_point_offset_x 1e+30: must be <= 1000 widths of the film"},
      {scene("<sensor type='perspective'><film type='bandfilm'><string name='bands' value='400-1e39'/></film>"
             "</sensor>"),
       "bands '400-1e39': '400-1e39': wavelength 1e+39 nm: must be from 0.001 to 1e+09 nm"},
      {scene("<sensor type='perspective'><film type='specfilm'><spectrum name='a' value='400:0, "
             "500:3e38'/></film>"
             "</sensor>"),
       "specfilm film: band 'a' 3e+38 at 500 nm: must be <= 1e+15"},
      {scene("<sensor type='perspective'><film type='hdrfilm'><rfilter type='gaussian'>" +
             number("stddev", "1e-300") + "</rfilter></film></sensor>"),
       "gaussian rfilter: stddev 1e-300: must be from 0.001 to 25 pixels"},
      {complete_scene("<shape type='obj'>" + number("max_smooth_angle", "181") + "</shape>"),
       "obj shape: max_smooth_angle 181: must be from 0 to 180 degrees"},
      {complete_scene("<shape type='ply'><boolean name='face_normals' value='true'/>" +
                      number("max_smooth_angle", "30") + "</shape>"),
       "ply shape: max_smooth_angle together with face_normals"},
      {scene("<sensor type='perspective'><film type='hdrfilm'><rfilter type='mitchell'>" + number("C", "11") +
             "</rfilter></film></sensor>"),
       "mitchell rfilter: C 11: must be from -10 to 10"},
      {scene("<sensor type='perspective'><film type='hdrfilm'><rfilter type='lanczos'>" +
             number("lobes", "0.5") + "</rfilter></film></sensor>"),
       "lanczos rfilter: lobes 0.5: must be from 1 to 16"},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(rule_of(text, folder), message) << text;
}

TEST(ValueLimits, OfImagesThatEmit) {
  const TemporaryFolder folder;
  std::string pixels = "PF\n2 2\n-1.0\n";
  const float values[12] = {1, 1, 1, 1, 1, 1, 0x1p70f, 1, 1, 1, 1, 1};  // rows from the bottom
  pixels.append(reinterpret_cast<const char*>(values), sizeof values);
  folder.write("sun.pfm", pixels);
  const std::string rule = " of 'sun.pfm': must be <= 1e+15 W m^-2 sr^-1 nm^-1", file = "value='sun.pfm'/>";
  EXPECT_EQ(rule_of(emitter("envmap", number("scale", "0.5") + "<string name='filename' " + file), folder),
            "envmap emitter: scale times 590295810358705651712 at pixel (0, 0)" + rule);
  EXPECT_EQ(rule_of(complete_scene("<shape type='disk'><emitter type='area'><texture type='bitmap' "
                                   "name='radiance'><string name='filename' " +
                                   file + "</texture></emitter></shape>"),
                    folder),
            "area emitter: radiance 1180591620717411303424 at pixel (0, 0)" + rule);
}

// The squares of these coordinates leave double's range; their directions do not.
TEST(ValueLimits, DirectionsOfAnyLength) {
  const auto direction = [](const std::string& value) {
    const SceneDescription result =
        read(emitter("directional", "<vector name='direction' value='" + value + "'/>"));
    return std::get<DirectionalEmitter>(result.emitters.at(0).model).direction;
  };
  EXPECT_NEAR(glm::distance(direction("3e200 0 4e200"), glm::dvec3(0.6, 0, 0.8)), 0, 1e-12);
  EXPECT_NEAR(glm::distance(direction("3e-200 0 4e-200"), glm::dvec3(0.6, 0, 0.8)), 0, 1e-12);
  const auto turned = [](const std::string& axis) {
    return read(complete_scene("<shape type='disk'><transform name='to_world'><rotate angle='45' " + axis +
                               "/></transform></shape>"))
        .shapes.at(0)
        .to_world;
  };
  EXPECT_EQ(turned("x='1e200'"), turned("x='1'"));
}

}  // namespace
}  // namespace kiloband::test::test_value_limits
