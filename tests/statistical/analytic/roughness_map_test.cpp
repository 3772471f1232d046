// Roughness from bitmaps: where a map has the value a, paths are those of the material with alpha = a, bit by bit.
//
// A square [-1, 1]^2 is seen from above, filling the film, by its own light alone (max_depth 2). The map's halves, looked up without
// interpolation, are compared with renders of the two numbers; a map of one value with the render of it; and a bilinear map at one place
// with the number that it has there.
#include <fmt/format.h>

#include <cmath>
#include <glm/glm.hpp>

#include "tests/statistical/analytic/analytic_test.hpp"

namespace kiloband::test::roughness_map_test {
namespace {

const char* const kBands = "400-420, 500-510, 690-700";

Text map(const Text& name, const Text& file, const Text& filter = "nearest") {
  return "<texture name='" + name + "' type='bitmap'>" + text("filename", file) +
         text("filter_type", filter) + yes("raw") + "</texture>";
}

/// Renders the square, of metal or of glass, with these alphas.
RenderResult square(const Text& type, const Text& alphas, const TemporaryFolder& folder,
                    const Mode& mode = {}, const Text& sensor = plane_sensor(16)) {
  const Text light = shape("disk", to_world(scale("1.5") + turn("y", "-120") + translate("3.2 0.5 2")) +
                                       bsdf("diffuse") + lamp("400:2, 700:3"));
  const Text material = bsdf(type, text("distribution", "ggx") + alphas);
  return render_valid(scene(2, sensor + shape("rectangle", material) + light + sky(0.3)), kBands, mode,
                      {4, 61}, folder.path());
}

/// Values of a pixel, channel by channel, and their variances.
std::vector<double> pixel(const RenderResult& result, std::size_t x, std::size_t y) {
  const std::size_t channels = result.image_mean.size(), first = (y * 16 + x) * channels;
  std::vector<double> values(result.mean.begin() + static_cast<std::ptrdiff_t>(first),
                             result.mean.begin() + static_cast<std::ptrdiff_t>(first + channels));
  values.insert(values.end(), result.variance.begin() + static_cast<std::ptrdiff_t>(first),
                result.variance.begin() + static_cast<std::ptrdiff_t>(first + channels));
  return values;
}

class RoughnessMapTest : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Types, RoughnessMapTest, ::testing::Values("roughconductor", "roughdielectric"),
                         [](const auto& type) { return type.param; });

TEST_P(RoughnessMapTest, HalvesAreThoseOfTheirNumbers) {
  const TemporaryFolder folder;
  folder.write("halves.pfm", pfm_image(2, 1, 1, {0.1f, 0.4f}));
  const RenderResult varied = square(GetParam(), map("alpha", "halves.pfm"), folder);
  const RenderResult low = square(GetParam(), real("alpha", double{0.1f}), folder);
  const RenderResult high = square(GetParam(), real("alpha", double{0.4f}), folder);
  std::size_t different = 0;
  for (std::size_t y = 0; y < 16; ++y)
    for (std::size_t x = 0; x < 16; ++x) {
      EXPECT_EQ(pixel(varied, x, y), pixel(x < 8 ? low : high, x, y)) << x << ' ' << y;
      different += pixel(low, x, y) != pixel(high, x, y);
    }
  EXPECT_EQ(different, 256u);
}

/// A map of one alpha alone; the other is a number, or a second map.
TEST_P(RoughnessMapTest, EachAxisHasItsOwn) {
  const TemporaryFolder folder;
  folder.write("u.pfm", pfm_image(1, 1, 1, {0.1f}));
  folder.write("v.pfm", pfm_image(1, 1, 1, {0.4f}));
  const Text u = real("alpha_u", double{0.1f}), v = real("alpha_v", double{0.4f});
  const std::vector<double> expected = square(GetParam(), u + v, folder).mean;
  EXPECT_EQ(square(GetParam(), map("alpha_u", "u.pfm") + v, folder).mean, expected);
  EXPECT_EQ(square(GetParam(), u + map("alpha_v", "v.pfm"), folder).mean, expected);
  EXPECT_EQ(square(GetParam(), map("alpha_u", "u.pfm") + map("alpha_v", "v.pfm"), folder).mean, expected);
  EXPECT_NE(square(GetParam(), map("alpha_u", "v.pfm") + map("alpha_v", "u.pfm"), folder).mean, expected);
}

/// Of colours the luminance (Rec. 709, as Mitsuba 3.9.1), between texels the mean: at the middle of two texels, seen through a hole.
TEST_P(RoughnessMapTest, LuminanceAndInterpolation) {
  const TemporaryFolder folder;
  folder.write("two.pfm", pfm_image(2, 1, 3, {0.1f, 0.1f, 0.1f, 0.2f, 0.6f, 0.4f}));
  const double alpha = 0.5 * (0.1 + 0.212671 * 0.2 + 0.715160 * 0.6 + 0.072169 * 0.4);
  const Text narrow = perspective(lookat("0, 0, 3", "0, 0, 0"), 1e-3, film(16));
  const RenderResult varied = square(GetParam(), map("alpha", "two.pfm", "bilinear"), folder, {}, narrow);
  const RenderResult number = square(GetParam(), real("alpha", alpha), folder, {}, narrow);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(varied.image_mean[k] / number.image_mean[k], 1, 2e-4) << k;
}

TEST(RoughnessMap, NotWhereTablesAreOfOneRoughness) {
  const TemporaryFolder folder;
  folder.write("map.pfm", pfm_image(1, 1, 1, {0.1f}));
  const auto refusal = [&](const Text& material) {
    try {
      render_valid(scene(2, plane_sensor(4) + material + sky(1)), kBands, {}, {}, folder.path());
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_NE(refusal(shape("rectangle", bsdf("roughconductor", map("alpha", "map.pfm")) + thermal(300)))
                .find("alpha: a material that emits thermally cannot have a texture here"),
            std::string::npos);
  EXPECT_NE(
      refusal(
          shape("rectangle", bsdf("roughdielectric", text("int_material", "SF11") + map("alpha", "map.pfm"))))
          .find("alpha: a rough dielectric whose index depends on the wavelength cannot have a texture here"),
      std::string::npos);
}

/// A triangle in z = 0 with one normal at its corners and dp/du at an angle from +X.
Text leaning_triangle(const glm::dvec3& normal, double angle) {
  Text vertices, coordinates, corners;
  const glm::dvec2 places[] = {{-3, -3}, {4, -3}, {-1, 4}};
  const auto line = [](const Text& key, const std::vector<double>& values) {
    Text text = key;
    for (const double value : values) text += " " + exact(value);
    return text + "\n";
  };
  for (int i = 0; i < 3; ++i) {
    const double x = places[i].x, y = places[i].y, c = std::cos(angle), s = std::sin(angle);
    vertices += line("v", {x, y, 0});
    coordinates += line("vt", {c * x + s * y, c * y - s * x});
    corners += fmt::format(" {0}/{0}/1", i + 1);
  }
  return vertices + coordinates + line("vn", {normal.x, normal.y, normal.z}) + "f" + corners + "\n";
}

/// Under a normal map the tangent is s, dp/du made perpendicular to the surface's own normal n, made perpendicular to n': as that of a triangle whose
/// normals are n' and whose dp/du is the vector of its plane that s and n' span.
TEST(AnisotropicRoughness, NormalMapsTurnTheFrameOfTheSurface) {
  const glm::dvec3 n = glm::normalize(glm::dvec3(0.5, -0.3, 0.8)), du(std::cos(0.4), std::sin(0.4), 0);
  const glm::dvec3 s = glm::normalize(du - n * glm::dot(n, du));
  const glm::dvec3 local = glm::normalize(glm::dvec3(-0.5, 0.25, 0.75));  // 2 rgb - 1
  const glm::dvec3 mapped = local.x * s + local.y * glm::cross(n, s) + local.z * n;
  const glm::dvec3 along = s - mapped * (s.z / mapped.z);
  const TemporaryFolder folder;
  folder.write("turn.pfm", pfm_image(1, 1, 3, {0.25f, 0.625f, 0.875f}));
  folder.write("surface.obj", leaning_triangle(n, 0.4));
  folder.write("turned.obj", leaning_triangle(mapped, std::atan2(along.y, along.x)));
  const Text metal =
      bsdf("roughconductor", text("distribution", "ggx") + real("alpha_u", 0.1) + real("alpha_v", 0.4));
  const Text plain = number("boolean", "flip_invalid_normals", "false") +
                     number("boolean", "use_shadowing_function", "false");
  const Text map =
      "<texture name='normalmap' type='bitmap'>" + text("filename", "turn.pfm") + yes("raw") + "</texture>";
  const Text sensor = perspective(lookat("0.7, 0.4, 3", "0, 0, 0"), 1e-3, film(2));
  for (const char* const light : {"0.3, 0.5, -1", "-0.5, 0.2, -1", "0.6, -0.5, -1"}) {
    SCOPED_TRACE(light);
    const Text sun = emitter("directional", number("vector", "direction", light) + spectrum("irradiance", 1));
    const auto value = [&](const Text& mesh, const Text& material) {
      const Text triangle = shape("obj", text("filename", mesh) + material);
      return render_valid(scene(2, sensor + triangle + sun), "500-510", {}, {4, 61}, folder.path())
          .image_mean[0];
    };
    const double expected = value("turned.obj", metal);
    EXPECT_GT(expected, 1e-3);
    EXPECT_NEAR(value("surface.obj", bsdf("normalmap", plain + map + metal)) / expected, 1, 1e-4);
  }
}

}  // namespace
}  // namespace kiloband::test::roughness_map_test
