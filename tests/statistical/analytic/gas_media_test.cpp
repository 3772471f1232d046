// Which gas a ray is in: boundaries, nested and overlapping shapes, glass bodies, atmospheres and escaping
// rays, cameras in gas. Coefficients are flat, so that nothing is random:
// optical depths are exact to rounding.
#include "gas_scenes.hpp"
#include "spectral/planck.hpp"
#include "tests/support/messages.hpp"

namespace kiloband::test {
namespace {

struct Placed {
  const char* name;
  std::string shapes;
  double depth;  // optical, between camera and lamp
};

/// A box from z = 0.5 to 5, and a ball of radius 0.3 whose flipped normals a mirror turns outwards again.
std::string mirrored_box(const std::string& content) {
  return shape("cube", to_world("<scale x=\"-1\" z=\"2.25\"/><translate z=\"2.75\"/>") + content);
}
std::string mirrored_ball(const std::string& content) {
  return shape("sphere", number("float", "radius", 0.3) + "<boolean name=\"flip_normals\" value=\"true\"/>" +
                             to_world("<scale y=\"-1\"/><translate value=\"0.0123, 0.0057, 1\"/>") + content);
}

/// The camera's rays begin at z = 2. kappa of the atmosphere 0.1, of boxes 0.5, if there are any.
TEST(Gas, FollowsTheMediumThatARayIsIn) {
  const std::string air = gas("atmosphere", flat("absorption", 0.1));
  const std::string thick = gas("interior", flat("absorption", 0.5));
  const std::string thin = gas("interior", flat("absorption", 0.02));
  const std::string clear =
      "<bsdf type=\"dielectric\"><float name=\"int_ior\" value=\"1\"/>"
      "<float name=\"ext_ior\" value=\"1\"/></bsdf>";
  const std::string ball =
      number("float", "radius", 0.3) + "<point name=\"center\" value=\"0.0123, 0.0057, 1\"/>";
  const std::string disk = to_world("<translate x=\"0.0123\" y=\"0.0057\" z=\"1.2\"/>");
  const std::string lower =
      to_world("<rotate x=\"1\" angle=\"180\"/><translate x=\"0.0123\" y=\"0.0057\" z=\"0.7\"/>");
  const std::string shared =
      "<medium type=\"absorbing\" id=\"smoke\">" + flat("absorption", 0.5) + "</medium>";
  const std::string smoke = "<ref name=\"interior\" id=\"smoke\"/>";
  const std::vector<Placed> cases = {
      {"atmosphere", air, 0.2},
      {"box in an atmosphere", air + slab(0.5, 1.5, kNull + thick), 0.1 + 0.5},
      {"box without a medium", air + slab(0.5, 1.5, kNull), 0.2},
      {"camera inside", air + slab(0.5, 5, kNull + thick), 0.05 + 0.75},
      {"box in a box", slab(0.4, 1.6, kNull + thick) + slab(0.5, 1.5, kNull + thin), 0.5 * 0.2 + 0.02},
      {"overlapping boxes", slab(0.4, 1.1, kNull + thick) + slab(0.9, 1.5, kNull + thin),
       0.02 * 0.4 + 0.5 * 0.7},
      {"camera in a mirrored box", air + mirrored_box(kNull + thick), 0.05 + 0.75},
      {"ball", shape("sphere", ball + kNull + thick), 0.3},
      {"mirrored ball turned back", mirrored_ball(kNull + thick), 0.3},
      {"glass body in an atmosphere", air + shape("sphere", ball + clear), 0.1 * 1.4},
      {"gas in a glass body", air + shape("sphere", ball + clear + thick), 0.1 * 1.4 + 0.3},
      {"volume of two shapes",
       shared + shape("disk", disk + kNull + smoke) + shape("disk", lower + kNull + smoke), 0.25},
      {"mask that lets through",
       slab(0.5, 1.5,
            "<bsdf type=\"mask\"><float name=\"opacity\" value=\"0\"/><bsdf type=\"diffuse\"/></bsdf>" +
                thick),
       0.5},
  };
  for (const Placed& c : cases) {
    SCOPED_TRACE(c.name);
    const RenderResult result =
        render_valid(scene(8, straight_camera(2) + black_lamp(flat("radiance", 5)) + c.shapes),
                     "500-510, 600-620", {}, {2, 37});
    const double passed = 5 * std::exp(-c.depth);
    expect_exactly(result, {10 * passed, 20 * passed});
  }
}

/// What the environment shows is as seen in the scene, behind an atmosphere too; interiors count, and what
/// they emit is seen through the atmosphere in front of them.
TEST(Gas, EscapingRaysCarryNoAtmosphere) {
  const std::string air = gas("atmosphere", flat("absorption", 0.3), 280);
  const std::string hot = slab(0.5, 1.5, kNull + gas("interior", flat("absorption", 0.5), 900));
  const double sky = 20, box = 0.5, front = 0.5 * 0.3;
  const RenderResult result = render_valid(
      scene(8, straight_camera(2) + constant_environment(sky) + air + hot), "4500-4500.01", {}, {2, 38});
  const double emitted = planck_integral(4500, 4500.01, 900) * -std::expm1(-box) * std::exp(-front);
  expect_exactly(result, {0.01 * sky * std::exp(-box) + emitted});
  const RenderResult empty = render_valid(scene(8, straight_camera(2) + constant_environment(sky) + air),
                                          "4500-4500.01", {}, {2, 38});
  expect_exactly(empty, {0.01 * sky});
}

std::string message_of(const std::string& xml) {
  return error_of([&] { render_valid(xml, "500-510", {}, {1, 42}); });
}

/// Rays must all begin in the same media: a boundary through the near plane is refused, and so are more than
/// four media around the camera.
TEST(Gas, CamerasThatAreHalfInside) {
  const std::string gas_in = kNull + medium("absorbing", "interior", flat("absorption", 1));
  const std::string beside =
      "<shape type=\"cube\"><transform name=\"to_world\"><translate x=\"1\"/></transform>" + gas_in +
      "</shape>";
  const std::string wide = wide_sensor(lookat("0.00001, 0, 0.5", "0, 0, -5"), 60, 4, 4);
  EXPECT_EQ(message_of(scene(2, wide + constant_environment(1) + beside)),
            "test.xml:1:99: error: sensor: its near plane is partly inside medium 'medium 0'; move it or "
            "change near_clip");
  std::string nested;
  for (const char* size : {"1", "2", "3", "4", "5"})
    nested += "<shape type=\"cube\"><transform name=\"to_world\"><scale value=\"" + std::string(size) +
              "\"/></transform>" + gas_in + "</shape>";
  const std::string inside = wide_sensor(lookat("0.1, 0.1, 0.1", "0, 0, -5"), 60, 4, 4);
  EXPECT_EQ(message_of(scene(2, inside + constant_environment(1) + nested)),
            "test.xml:1:99: error: sensor: it stands inside 5 media: at most 4");
}

/// More interiors at a time than a path remembers: the sample leaves the mean and is counted.
TEST(Gas, TooManyMediaAtATimeAreInvalid) {
  std::string nested;
  for (const char* size : {"0.1", "0.2", "0.3", "0.4", "0.5"})
    nested += "<shape type=\"cube\"><transform name=\"to_world\"><scale value=\"" + std::string(size) +
              "\"/></transform>" + kNull + medium("absorbing", "interior", flat("absorption", 1)) +
              "</shape>";
  RenderSpec spec;
  spec.xml = scene(2, straight_camera(2) + black_lamp(flat("radiance", 5)) + nested);
  spec.bands = "500-510";
  spec.threads = 1;
  spec.spp = 8;
  spec.sampling.replicates = 4;
  const RenderResult result = render(spec);
  EXPECT_EQ(result.invalid_samples, 8u * 4u);
}

}  // namespace
}  // namespace kiloband::test
