// Attributes of meshes as textures: at a point with weights b0, b1, b2 of its triangle's vertices the spectrum is b0 S0 + b1 S1 + b2 S2;
// attributes of faces are one spectrum over each.
//
// A square [-1, 1]^2 of two triangles is seen from above, filling the film, under a directional light of irradiance pi along its normal:
// every point shows rho L0 exactly, so that pixels and the image have known means. Detectable bias: 0.5 %.
#include "tests/statistical/analytic/analytic_test.hpp"

namespace kiloband::test::mesh_attribute_test {
namespace {

const char* const kBands = "400-420, 500-510, 690-700";
constexpr double kPi = 3.14159265358979323846;

/// Values at the corners (-1, -1), (1, -1), (1, 1), (-1, 1).
constexpr double kCorners[] = {0.1, 0.9, 0.3, 0.6};
constexpr double kFaces[] = {0.2, 0.7};

/// ASCII PLY with a value w, a colour rgb (linear, flat greys but at the last corner) and a value k of each face.
std::string square() {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float w_x\n"
      "property float r\nproperty float g\nproperty float b\nproperty uchar dim_r\nproperty uchar dim_g\n"
      "property uchar dim_b\nelement face 2\nproperty float k\nproperty list uchar int vertex_indices\nproperty float tint_r\n"
      "property float tint_g\nproperty float tint_b\nend_header\n";
  const char* const places[] = {"-1 -1 0", "1 -1 0", "1 1 0", "-1 1 0"};
  for (int i = 0; i < 4; ++i) {
    const std::string value = std::to_string(kCorners[i]);
    text += places[i] + (" " + value) + (i == 3 ? " 0.8 0.3 0.1" : " " + value + " " + value + " " + value) +
            " 51 102 153\n";
  }
  return text + "0.2 3 0 1 2 0.2 0.2 0.2\n0.7 3 0 2 3 0.8 0.3 0.1\n";
}

/// Of kCorners at a point of the square.
double interpolated(double x, double y) {
  if (y <= x)  // the triangle of the corners 0, 1 and 2
    return kCorners[0] + (kCorners[1] - kCorners[0]) * (x + 1) / 2 +
           (kCorners[2] - kCorners[1]) * (y + 1) / 2;
  return kCorners[0] + (kCorners[3] - kCorners[0]) * (y + 1) / 2 + (kCorners[2] - kCorners[3]) * (x + 1) / 2;
}

Text attribute(const Text& name, const Text& attribute_name, double factor = 1) {
  return "<texture name='" + name + "' type='mesh_attribute'>" + text("name", attribute_name) +
         (factor == 1 ? "" : real("scale", factor)) + "</texture>";
}
Text mesh(const Text& contents) {
  return shape("ply", text("filename", "square.ply") + contents);
}
Text sun() {
  return emitter("directional", number("vector", "direction", "0, 0, -1") + spectrum("irradiance", kPi));
}

RenderResult seen(const Text& contents, const Mode& mode, uint32_t side, const Effort& effort = {16, 71}) {
  const TemporaryFolder folder;
  folder.write("square.ply", square());
  return render_valid(scene(2, plane_sensor(side) + contents), kBands, mode, effort, folder.path());
}

/// The image is, pixel by pixel, that of a function of x and y: means over the pixel by a 16 x 16 midpoint rule. The diagonal is left out.
void expect_pixels(const RenderResult& result, uint32_t side,
                   const std::function<double(double, double)>& value) {
  for (uint32_t row = 0; row < side; ++row)
    for (uint32_t column = 0; column < side; ++column) {
      if (row + column == side - 1) continue;
      double mean = 0;
      for (int i = 0; i < 256; ++i)
        mean +=
            value(2 * (column + (i % 16 + 0.5) / 16) / side - 1, 1 - 2 * (row + (i / 16 + 0.5) / 16) / side) /
            256;
      SCOPED_TRACE(std::to_string(column) + " " + std::to_string(row));
      expect_pixel(result, column, row, channel_integrals([=](double) { return mean; }, result));
    }
}

class MeshAttributeTest : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, MeshAttributeTest, ::testing::ValuesIn(all_modes()), mode_name);

TEST_P(MeshAttributeTest, OfVerticesIsInterpolated) {
  const RenderResult result =
      seen(mesh(bsdf("diffuse", attribute("reflectance", "vertex_w"))) + sun(), GetParam(), 6);
  expect_pixels(result, 6, interpolated);
  expect_image_mean(
      result, channel_integrals([](double) { return (2 * (0.1 + 0.3) + 0.9 + 0.6) / 6; }, result), 0.005);
}

TEST_P(MeshAttributeTest, OfFacesIsConstant) {
  const RenderResult result =
      seen(mesh(bsdf("diffuse", attribute("reflectance", "face_k", 0.5))) + sun(), GetParam(), 4);
  expect_pixels(result, 4, [](double x, double y) { return 0.5 * kFaces[y > x]; });
}

/// Colours are upsampled at the vertices, as reflectances: the mean over the second triangle is that of its vertices' spectra.
TEST(MeshAttribute, ColoursOfVerticesAndFaces) {
  const Effort effort{64, 72};
  const auto mean_of = [&](const Text& reflectance) {
    return seen(mesh(bsdf("diffuse", reflectance)) + sun(), {}, 8, effort).image_mean;
  };
  const std::vector<double> tint = mean_of("<rgb name='reflectance' value='0.8, 0.3, 0.1'/>");
  const std::vector<double> one = mean_of(spectrum("reflectance", 1));
  const std::vector<double> vertices = mean_of(attribute("reflectance", "vertex_color"));
  const std::vector<double> faces = mean_of(attribute("reflectance", "face_tint_color"));
  const std::vector<double> bytes = mean_of(attribute("reflectance", "vertex_dim_color"));
  const std::vector<double> dim = mean_of("<rgb name='reflectance' value='0.2, 0.4, 0.6'/>");
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(vertices[k] / one[k], (2 * (0.1 + 0.3) + 0.9 + tint[k] / one[k]) / 6, 3e-3) << k;
    EXPECT_NEAR(faces[k] / one[k], (0.2 + tint[k] / one[k]) / 2, 3e-3) << k;
    EXPECT_NEAR(bytes[k] / one[k], dim[k] / one[k], 1e-3) << k;
  }
}

/// Two meshes with one material have each their own values; shares and roughness may be attributes, too.
TEST(MeshAttribute, OfEachMeshItsOwn) {
  const TemporaryFolder folder;
  std::string other = square();
  for (std::size_t at; (at = other.find(" 0.9")) != std::string::npos;) other.replace(at, 4, " 0.5");
  folder.write("square.ply", square());
  folder.write("other.ply", other);
  const Text material = "<bsdf type='mask' id='m'>" + attribute("opacity", "vertex_w") +
                        bsdf("diffuse", spectrum("reflectance", 1)) + "</bsdf>";
  const Text left = shape("ply", text("filename", "square.ply") +
                                     to_world(scale("0.5 1 1") + translate("-0.5 0 0")) + "<ref id='m'/>");
  const Text right = shape("ply", text("filename", "other.ply") +
                                      to_world(scale("0.5 1 1") + translate("0.5 0 0")) + "<ref id='m'/>");
  const RenderResult result = render_valid(scene(2, plane_sensor(2) + material + left + right + sun()),
                                           kBands, {}, {256, 73}, folder.path());
  const auto half = [&](uint32_t column) {
    double sum = 0;
    for (uint32_t row = 0; row < 2; ++row) sum += result.mean[(row * 2 + column) * 3] / 2;
    return sum / channel_integrals([](double) { return 1; }, result)[0];
  };
  EXPECT_NEAR(half(0), (2 * (0.1 + 0.3) + 0.9 + 0.6) / 6, 0.01);
  EXPECT_NEAR(half(1), (2 * (0.1 + 0.3) + 0.5 + 0.6) / 6, 0.01);
}

/// Of a colour an opacity is the luminance.
TEST(MeshAttribute, AColourAsOpacity) {
  const Text masked = "<bsdf type='mask'>" + attribute("opacity", "vertex_color") +
                      bsdf("diffuse", spectrum("reflectance", 1)) + "</bsdf>";
  const RenderResult result = seen(mesh(masked) + sun(), {}, 2, {256, 75});
  const double mean = (2 * (0.1 + 0.3) + 0.9 + 0.212671 * 0.8 + 0.715160 * 0.3 + 0.072169 * 0.1) / 6;
  expect_image_mean(result, channel_integrals([=](double) { return mean; }, result), 0.02);
}

/// Radiance of lamps: seen, and light on a plane that faces them at a distance at which all points count alike.
TEST_P(MeshAttributeTest, OfLamps) {
  const Text lamp_of =
      bsdf("diffuse", spectrum("reflectance", 0)) + emitter("area", attribute("radiance", "vertex_w", 3));
  const RenderResult direct = seen(mesh(lamp_of), GetParam(), 6);
  expect_pixels(direct, 6, [](double x, double y) { return 3 * interpolated(x, y); });
  const Text plane = shape("rectangle", to_world(turn("x", "180") + translate("0 0 1000")) +
                                            bsdf("diffuse", spectrum("reflectance", 1)));
  const Text camera = perspective(lookat("0, 0, 1", "0, 0, 1000"), 0.005, film(4));
  const TemporaryFolder folder;
  folder.write("square.ply", square());
  const RenderResult lit =
      render_valid(scene(2, camera + mesh(lamp_of) + plane), kBands, GetParam(), {400, 74}, folder.path());
  const double mean = 3 * (2 * (0.1 + 0.3) + 0.9 + 0.6) / 6, irradiance = mean * 4 / 1e6;
  expect_image_mean(lit, channel_integrals([=](double) { return irradiance / kPi; }, lit), 0.005);
}

TEST(MeshAttribute, Refusals) {
  const auto refusal = [](const Text& contents) {
    try {
      seen(contents + sky(1), {}, 2);
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  const auto expect = [&](const Text& contents, const char* message) {
    const std::string text = refusal(contents);
    EXPECT_NE(text.find(message), std::string::npos) << text;
  };
  const auto diffuse_of = [](const Text& name, double factor = 1) {
    return bsdf("diffuse", attribute("reflectance", name, factor));
  };
  expect(mesh(diffuse_of("vertex_none")),
         "mesh_attribute 'vertex_none': the mesh has no properties of this name");
  expect(mesh(diffuse_of("face_w")), "mesh_attribute 'face_w': the mesh has no properties of this name");
  expect(mesh(diffuse_of("vertex_w", 2)), "mesh_attribute 'vertex_w': a value is 1.8: must be from 0 to 1");
  expect(shape("sphere", diffuse_of("vertex_w")), "mesh_attribute 'vertex_w': only meshes have attributes");
  expect(mesh(diffuse_of("vertex_w") + thermal(300)),
         "a surface that emits thermally cannot have a mesh_attribute here");
  expect(mesh(diffuse_of("w")), "name 'w': must begin with vertex_ or face_");
  // The same texture of the same mesh, as radiance before.
  const Text bright =
      "<texture type='mesh_attribute' id='t'>" + text("name", "vertex_w") + real("scale", 5) + "</texture>";
  expect(bright + mesh("<emitter type='area'><ref name='radiance' id='t'/></emitter>") +
             mesh("<bsdf type='diffuse'><ref name='reflectance' id='t'/></bsdf>"),
         "mesh_attribute 'vertex_w': a value is 4.5: must be from 0 to 1");
}

}  // namespace
}  // namespace kiloband::test::mesh_attribute_test
