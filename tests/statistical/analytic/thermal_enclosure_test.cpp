// Isothermal enclosures: everything at one temperature, whatever materials. In equilibrium radiance is
// Planck's law everywhere and in every direction, so every channel of every pixel is its integral over the
// channel; what a surface emits is exactly what it lacks in reflected and transmitted light (Kirchhoff). Any
// fault of an emissivity, of a compensated BSDF or of their agreement shows,
// multiplied by the number of bounces.
//
// Error rate: 1e-4 for the whole program. Detectable bias of every channel's image mean:
// stated with each test.
#include <cmath>

#include "spectral/planck.hpp"
#include "tests/statistical/analytic/analytic_test.hpp"
#include "tests/statistical/analytic/gas/gas_scenes.hpp"

namespace kiloband::test::thermal_enclosure_test {
namespace {

// 0.4 to 20 um; channels narrow enough for the noise of wavelengths not to hide anything.
const char* const kBands = "400-402, 1000-1010, 4000-4050, 10000-10200, 19700-20000";
constexpr double kTemperature = 700;

/// A metal that absorbs some: tungsten-like in the visible, towards aluminium in the infrared.
const std::string kMetal = spectrum("eta", "380:3.5, 1000:3, 4000:3, 20000:40") +
                           spectrum("k", "380:2.8, 1000:3.6, 4000:16, 20000:80");
const std::string kGrey = spectrum("reflectance", "380:0.2, 4000:0.7, 20000:0.4");

std::string rough(const std::string& type, const std::string& distribution, double alpha_u, double alpha_v,
                  const std::string& more = "") {
  const std::string alpha =
      alpha_u == alpha_v ? real("alpha", alpha_u) : real("alpha_u", alpha_u) + real("alpha_v", alpha_v);
  return bsdf(type, text("distribution", distribution) + alpha + more);
}

std::string ball(const std::string& content) {
  return shape("sphere",
               "<point name=\"center\" x=\"0\" y=\"0\" z=\"-0.4\"/>" + real("radius", 0.4) + content);
}
std::string box(const std::string& content) {
  return shape("cube", kInwards + content);
}
std::string sheet(const std::string& content) {
  return shape("rectangle", to_world(scale("0.5") + turn("y", "140")) + content);
}

struct Enclosure {
  const char* name;
  std::string wall, object;  // BSDFs; object: in a grey box, empty: none
  bool is_sheet = false;
};

std::vector<Enclosure> enclosures() {
  const std::string grey = bsdf("diffuse", kGrey);
  const std::string tinted = spectrum("specular_reflectance", "380:0.9, 20000:0.6");
  const std::string colour = spectrum("diffuse_reflectance", "380:0.8, 4000:0.3, 20000:0.6");
  const std::string nonlinear = yes("nonlinear");
  const std::string board =
      bsdf("diffuse",
           "<texture type=\"checkerboard\" name=\"reflectance\"><transform name=\"to_uv\"><scale "
           "value=\"5\"/></transform></texture>");
  return {
      {"diffuse", grey, ""},
      {"checkerboard", board, ""},
      {"metal", bsdf("conductor", kMetal), ""},
      {"ggx", grey, rough("roughconductor", "ggx", 0.3, 0.3, kMetal)},
      {"beckmann", rough("roughconductor", "beckmann", 0.5, 0.5, kMetal + tinted), ""},
      {"anisotropic ggx", grey, rough("roughconductor", "ggx", 0.1, 0.4, kMetal)},
      {"anisotropic beckmann", grey, rough("roughconductor", "beckmann", 0.4, 0.15, kMetal)},
      {"rough mirror", grey, rough("roughconductor", "ggx", 0.4, 0.4, tinted)},
      {"plastic", bsdf("plastic", colour), ""},
      {"nonlinear plastic", bsdf("plastic", colour + nonlinear), ""},
      {"rough plastic", rough("roughplastic", "ggx", 0.3, 0.3, colour), ""},
      {"nonlinear rough plastic", rough("roughplastic", "beckmann", 0.2, 0.2, colour + nonlinear), ""},
      {"glass", grey, bsdf("dielectric", "")},
      {"absorbing glass", grey, bsdf("dielectric", tinted + spectrum("specular_transmittance", 0.7))},
      {"rough glass", grey, rough("roughdielectric", "ggx", 0.4, 0.4)},
      {"absorbing rough glass", grey,
       rough("roughdielectric", "beckmann", 0.3, 0.3, spectrum("specular_transmittance", 0.7))},
      {"anisotropic rough glass", grey, rough("roughdielectric", "ggx", 0.1, 0.4)},
      {"mask", grey, bsdf("mask", real("opacity", 0.6) + bsdf("twosided", grey))},
      {"two sides", grey,
       bsdf("twosided", bsdf("plastic", colour) + rough("roughconductor", "ggx", 0.3, 0.3, kMetal)), true},
      {"black back", grey, rough("roughplastic", "ggx", 0.2, 0.2, colour), true},
  };
}

std::vector<double> planck_integrals(const RenderResult& result, double temperature_k) {
  std::vector<double> expected;
  for (const Channel& c : result.scene.channels)
    expected.push_back(planck_integral(c.min_nm, c.max_nm, temperature_k));
  return expected;
}

std::string camera() {
  return perspective(lookat("0.3, -0.2, 0.9", "-0.2, 0.1, -0.9"), 60, film(8));
}

/// interior: what is in the object, which has none if it is a sheet.
std::string isothermal(const Enclosure& e, bool ambient, const std::string& interior = "") {
  const std::string own = ambient ? "" : thermal(kTemperature);
  std::string body = box(e.wall + own);
  if (!e.object.empty()) body += e.is_sheet ? sheet(e.object + own) : ball(e.object + own + interior);
  return scene(-1, camera() + body + (ambient ? thermal(kTemperature) : ""));
}

class Isothermal : public ::testing::TestWithParam<std::size_t> {};

/// Every shape at the ambient temperature: found by BSDF sampling alone. Detectable bias: 2 %.
TEST_P(Isothermal, AmbientTemperatureGivesPlancksLaw) {
  const Enclosure e = enclosures()[GetParam()];
  const RenderResult result = render_valid(isothermal(e, true), kBands, {}, {32, 51});
  expect_image_mean(result, planck_integrals(result, kTemperature), 0.02);
}

/// The same temperature as every shape's own: lights, with next-event estimation and MIS.
/// Detectable bias: 2 %.
TEST_P(Isothermal, LightsGivePlancksLaw) {
  const Enclosure e = enclosures()[GetParam()];
  const RenderResult result = render_valid(isothermal(e, false), kBands, {}, {32, 52});
  expect_image_mean(result, planck_integrals(result, kTemperature), 0.02);
}

/// The same full of gas, and another gas in the object: nothing changes. Detectable bias: 2 %.
TEST_P(Isothermal, GasGivesPlancksLaw) {
  const Enclosure e = enclosures()[GetParam()];
  const std::string air = spectrum("absorption", "380:0.1, 4000:3, 10000:0.01, 20000:0.5");
  const std::string inside = spectrum("absorption", "380:2, 4000:0.1, 20000:8");
  const bool lets_light_in = e.object.find("dielectric") != std::string::npos;
  const std::string xml =
      isothermal(e, true, lets_light_in ? gas("interior", inside, kTemperature) : std::string());
  const std::string end = "</scene>";
  const RenderResult result = render_valid(
      xml.substr(0, xml.rfind(end)) + gas("atmosphere", air, kTemperature) + end, kBands, {}, {16, 57});
  expect_image_mean(result, planck_integrals(result, kTemperature), 0.02);
}

std::string enclosure_name(const ::testing::TestParamInfo<std::size_t>& info) {
  std::string name = enclosures()[info.param].name;
  for (char& c : name) c = c == ' ' ? '_' : c;
  return name;
}
INSTANTIATE_TEST_SUITE_P(Enclosures, Isothermal, ::testing::Range(std::size_t{0}, enclosures().size()),
                         enclosure_name);

/// Boundaries so smooth that what they reflect jumps at the critical angle and bends within a degree of grazing: tables
/// made for the angles at which facets of that roughness hide each other miss both. Detectable bias: 1 %.
TEST(IsothermalModes, NearlySmoothBoundariesGivePlancksLaw) {
  for (const double alpha : {1e-4, 1e-3, 1e-2}) {
    const std::string black = rough("roughplastic", "ggx", alpha, alpha, spectrum("diffuse_reflectance", 0));
    for (const char* const eye : {"1.7320508, 0, 1", "1.9850924, 0, 0.2437387"}) {  // at 60 and 83 degrees
      SCOPED_TRACE("plastic " + std::to_string(alpha) + " from " + eye);
      const RenderResult result =
          render_valid(scene(-1, perspective(lookat(eye, "0, 0, 0"), 1, film(8)) + shape("rectangle", black) +
                                     thermal(kTemperature)),
                       kBands, {}, {12, 58});
      expect_image_mean(result, planck_integrals(result, kTemperature), 0.01);
    }
    SCOPED_TRACE("glass " + std::to_string(alpha));
    const std::string glass =
        rough("roughdielectric", "ggx", alpha, alpha, spectrum("specular_reflectance", 0));
    const RenderResult result =
        render_valid(scene(-1, perspective(lookat("4, 2, 3", "0, 0, 0"), 10, film(8)) + shape("cube", glass) +
                                   thermal(kTemperature)),
                     kBands, {}, {12, 59});
    expect_image_mean(result, planck_integrals(result, kTemperature), 0.01);
  }
}

/// Per-path wavelengths and independent numbers. Detectable bias: 2.5 %.
TEST(IsothermalModes, AllGivePlancksLaw) {
  for (const Mode& mode : tried_modes()) {
    SCOPED_TRACE(name_of(mode));
    const RenderResult result = render_valid(isothermal(enclosures()[3], true), kBands, mode, {16, 53});
    expect_image_mean(result, planck_integrals(result, kTemperature), 0.025);
  }
}

/// With colours: the complement of an upsampled texel is exact. In the visible, where colours say something.
/// Detectable bias: 1 %.
TEST(IsothermalModes, PicturesGivePlancksLaw) {
  const TemporaryFolder folder;
  folder.write("colours.ppm", "P3\n2 2\n255\n200 90 40 60 180 90 128 128 128 40 70 190\n");
  const std::string picture =
      "<texture type=\"bitmap\" name=\"NAME\"><string name=\"filename\" value=\"colours.ppm\"/></texture>";
  for (const auto& [type, name] : {std::pair{"diffuse", "reflectance"}, {"plastic", "diffuse_reflectance"}}) {
    SCOPED_TRACE(type);
    std::string texture = picture;
    texture.replace(texture.find("NAME"), 4, name);
    const RenderResult result = render_valid(scene(-1, camera() + box(bsdf(type, texture)) + thermal(3000)),
                                             "400-402, 550-552, 700-702", {}, {24, 54}, folder.path());
    expect_image_mean(result, planck_integrals(result, 3000), 0.01);
  }
}

/// 0.3 um at 200 K, 1e-96 in film units of its own, beside the thermal infrared. Detectable bias: 1 %.
TEST(IsothermalModes, ColdEnclosuresDoNotUnderflow) {
  for (const double temperature : {200.0, 6000.0}) {
    SCOPED_TRACE(temperature);
    const RenderResult result = render_valid(scene(-1, camera() + box(diffuse(0.4)) + thermal(temperature)),
                                             "299.9-300.1, 10000-10010, 19990-20000", {}, {24, 55});
    expect_image_mean(result, planck_integrals(result, temperature), 0.01);
    EXPECT_GT(result.image_mean[0], 0);
  }
}

/// An image or vertices that all have the same temperature; Planck's law is then evaluated at each hit.
/// Detectable bias: 1.5 %.
TEST(IsothermalFields, GivePlancksLaw) {
  const TemporaryFolder folder;
  folder.write("kelvin.pfm", pfm_image(2, 2, 1, std::vector<float>(4, 200)));
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
      "property float kelvin\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n";
  for (const int x : {-1, 1})
    for (const int y : {-1, 1})
      for (const int z : {-1, 1})
        ply += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + " 200\n";
  folder.write("box.ply", ply + "4 0 1 3 2\n4 4 6 7 5\n4 0 4 5 1\n4 2 3 7 6\n4 0 2 6 4\n4 1 5 7 3\n");
  const std::string by_image =
      "<emitter type=\"thermal\"><texture type=\"bitmap\" name=\"temperature\"><string name=\"filename\" "
      "value=\"kelvin.pfm\"/></texture></emitter>";
  const std::string by_vertex = emitter("thermal", text("temperature_attribute", "kelvin"));
  const std::string file = text("filename", "box.ply") + yes("face_normals");
  const std::string metal =
      rough("roughconductor", "ggx", 0.3, 0.3, kMetal + spectrum("specular_reflectance", 0.6));
  const std::string shapes[] = {box(bsdf("diffuse", kGrey) + by_image),
                                shape("ply", kInwards + file + bsdf("diffuse", kGrey) + by_vertex),
                                shape("ply", kInwards + file + metal + by_vertex)};
  for (const std::string& walls : shapes) {
    for (const Mode& mode : {Mode{}, Mode{WavelengthMode::kPerPath, SamplerType::kSobol}}) {
      SCOPED_TRACE(walls + name_of(mode));
      const RenderResult result = render_valid(
          scene(-1, camera() + walls), "380-380.2, 10000-10010, 19990-20000", mode, {24, 56}, folder.path());
      expect_image_mean(result, planck_integrals(result, 200), 0.015);
    }
  }
}

}  // namespace
}  // namespace kiloband::test::thermal_enclosure_test
