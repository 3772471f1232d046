// Which gas a ray is in: boundaries, nested and overlapping shapes, glass bodies, atmospheres and escaping
// rays, cameras in gas. Coefficients are flat, so that nothing is random:
// optical depths are exact to rounding.
#include "spectral/planck.hpp"
#include "tests/statistical/analytic/gas/gas_scenes.hpp"
#include "tests/support/messages.hpp"

namespace kiloband::test::media_test {
namespace {

struct Placed {
  const char* name;
  std::string shapes;
  double depth;  // optical, between camera and lamp
};

/// A box from z = 0.5 to 5, and a ball of radius 0.3 whose flipped normals a mirror turns outwards again.
std::string mirrored_box(const std::string& content) {
  return shape("cube", to_world(step("scale", "x='-1' z='2.25'") + step("translate", "z='2.75'")) + content);
}
std::string mirrored_ball(const std::string& content) {
  return shape("sphere", real("radius", 0.3) + yes("flip_normals") +
                             to_world(step("scale", "y='-1'") + translate("0.0123, 0.0057, 1")) + content);
}

/// The camera's rays begin at z = 2. kappa of the atmosphere 0.1, of boxes 0.5, if there are any.
TEST(Gas, FollowsTheMediumThatARayIsIn) {
  const std::string air = gas("atmosphere", spectrum("absorption", 0.1));
  const std::string thick = gas("interior", spectrum("absorption", 0.5));
  const std::string thin = gas("interior", spectrum("absorption", 0.02));
  const std::string clear = bsdf("dielectric", real("int_ior", "1") + real("ext_ior", "1"));
  const std::string ball = real("radius", 0.3) + number("point", "center", "0.0123, 0.0057, 1");
  const std::string disk = to_world(step("translate", "x='0.0123' y='0.0057' z='1.2'"));
  const std::string lower = to_world(turn("x", "180") + step("translate", "x='0.0123' y='0.0057' z='0.7'"));
  const std::string shared =
      "<medium type=\"absorbing\" id=\"smoke\">" + spectrum("absorption", 0.5) + "</medium>";
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
      {"mask that lets through", slab(0.5, 1.5, bsdf("mask", real("opacity", "0") + bsdf("diffuse")) + thick),
       0.5},
  };
  for (const Placed& c : cases) {
    SCOPED_TRACE(c.name);
    const RenderResult result =
        render_valid(scene(8, straight_camera(2) + black_lamp(spectrum("radiance", 5)) + c.shapes),
                     "500-510, 600-620", {}, {2, 37});
    const double passed = 5 * std::exp(-c.depth);
    expect_exactly(result, {10 * passed, 20 * passed});
  }
}

/// Two instances of a glass body, one in the other, keep out as much of the atmosphere as two bodies: 16 m are left of 20.
TEST(Gas, InstancesNestLikeShapes) {
  const std::string glass = bsdf("dielectric", real("int_ior", 1.0001) + real("ext_ior", 1));
  const std::string far = scale(20, 20, 1) + translate(0, 0, -10);
  const std::string lit =
      gas("atmosphere", spectrum("absorption", 0.5)) +
      perspective(lookat("0.0123, 0.0057, 10.0001", "0.0123, 0.0057, 0"), 0.05, film(4)) +
      shape("rectangle", to_world(far) + diffuse(0) + emitter("area", spectrum("radiance", 1)));
  for (const char* const type : {"cube", "sphere"}) {
    SCOPED_TRACE(type);
    const auto own = [&](const char* size) { return shape(type, to_world(scale(size)) + glass); };
    const std::string group = "<shape type='shapegroup' id='body'>" + shape(type, glass) + "</shape>";
    const auto placed = [&](const char* size) {
      return shape("instance", "<ref id='body'/>" + to_world(scale(size)));
    };
    const auto image = [&](const std::string& bodies) {
      return render_valid(scene(20, lit + bodies), "500-510", {}, {4096, 39, 4});
    };
    const RenderResult bodies = image(own("2") + own("1"));
    const RenderResult instances = image(group + placed("1") + placed("2"));
    EXPECT_NEAR(instances.image_mean[0] / bodies.image_mean[0], 1, 2e-3);
    EXPECT_NEAR(instances.image_mean[0] / (10 * std::exp(-8.0)), 1, 2e-3);
  }
}

/// What the environment shows is as seen in the scene, behind an atmosphere too; interiors count, and what
/// they emit is seen through the atmosphere in front of them.
TEST(Gas, EscapingRaysCarryNoAtmosphere) {
  const std::string air = gas("atmosphere", spectrum("absorption", 0.3), 280);
  const std::string hot = slab(0.5, 1.5, kNull + gas("interior", spectrum("absorption", 0.5), 900));
  const double outside = 20, box = 0.5, front = 0.5 * 0.3;
  const RenderResult result =
      render_valid(scene(8, straight_camera(2) + sky(outside) + air + hot), "4500-4500.01", {}, {2, 38});
  const double emitted = planck_integral(4500, 4500.01, 900) * -std::expm1(-box) * std::exp(-front);
  expect_exactly(result, {0.01 * outside * std::exp(-box) + emitted});
  const RenderResult empty =
      render_valid(scene(8, straight_camera(2) + sky(outside) + air), "4500-4500.01", {}, {2, 38});
  expect_exactly(empty, {0.01 * outside});
}

std::string message_of(const std::string& xml) {
  return error_of([&] { render_valid(xml, "500-510", {}, {1, 42}); });
}

/// Rays must all begin in the same media: a boundary through the near plane is refused, and so are more than
/// four media around the camera.
TEST(Gas, CamerasThatAreHalfInside) {
  const std::string gas_in = kNull + medium("absorbing", "interior", spectrum("absorption", 1));
  const std::string beside = shape("cube", to_world(translate(1, 0, 0)) + gas_in);
  const std::string wide = perspective(lookat("0.00001, 0, 0.5", "0, 0, -5"), 60, film(4));
  EXPECT_EQ(message_of(scene(2, wide + sky(1) + beside)),
            "test.xml:1:99: error: sensor: its near plane is partly inside medium 'medium 0'; move it or "
            "change near_clip");
  // A near plane of 2 m beside it, but for one of two principal points, which move it by its width.
  const std::string tall = shape("cube", to_world(scale("1 3 3") + translate("1 0 0")) + gas_in);
  const auto is_refused = [&](double principal_point) {
    const std::string outside =
        object("sensor", "perspective",
               real("fov", 90) + real("near_clip", 1) + real("principal_point_offset_x", principal_point) +
                   to_world(lookat("-1.1, 0, 0.5", "-1.1, 0, -5")) + film(4));
    const auto compile = [&] { render_valid(scene(2, outside + sky(1) + tall), "500-510", {}, {2, 42}); };
    return error_of(compile).find("near plane") != std::string::npos;
  };
  EXPECT_FALSE(is_refused(0));
  EXPECT_NE(is_refused(1), is_refused(-1));
  std::string nested;
  for (const char* size : {"1", "2", "3", "4", "5"}) nested += shape("cube", to_world(scale(size)) + gas_in);
  const std::string inside = perspective(lookat("0.1, 0.1, 0.1", "0, 0, -5"), 60, film(4));
  EXPECT_EQ(message_of(scene(2, inside + sky(1) + nested)),
            "test.xml:1:99: error: sensor: it stands inside 5 media: at most 4");
}

/// More interiors at a time than a path remembers: the sample leaves the mean and is counted.
TEST(Gas, TooManyMediaAtATimeAreInvalid) {
  std::string nested;
  for (const char* size : {"0.1", "0.2", "0.3", "0.4", "0.5"})
    nested += shape(
        "cube", to_world(scale(size)) + kNull + medium("absorbing", "interior", spectrum("absorption", 1)));
  RenderSpec spec;
  spec.xml = scene(2, straight_camera(2) + black_lamp(spectrum("radiance", 5)) + nested);
  spec.bands = "500-510";
  spec.threads = 1;
  spec.spp = 8;
  spec.sampling.replicates = 4;
  const RenderResult result = render(spec);
  EXPECT_EQ(result.invalid_samples, 8u * 4u);
}

}  // namespace
}  // namespace kiloband::test::media_test
