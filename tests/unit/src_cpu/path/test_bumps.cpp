// Bump and normal maps against closed forms: a constant slope is a tilted plane.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>

#include "pixel_mean.hpp"
#include "tests/support/picture_files.hpp"
#include "tests/support/render_harness.hpp"
#include "tests/support/scene_text.hpp"
#include "tests/support/temporary_folder.hpp"

namespace kiloband::test::test_bumps {
namespace {

using namespace scene_text;

const Text kPlain =
    number("boolean", "flip_invalid_normals", "false") + number("boolean", "use_shadowing_function", "false");

class Bumps : public ::testing::Test {
 protected:
  /// Slopes of 1 along u and along v, but at the border of the texture; a normal of (0.6, 0, 0.8) and one that points down.
  Bumps() {
    const std::vector<float> ramp{0, 0.25f, 0.5f, 0.75f};
    std::vector<float> along_u, along_v;
    for (int y = 0; y < 4; ++y) {
      for (int x = 0; x < 4; ++x) along_u.push_back(ramp[x]), along_v.push_back(ramp[y]);
    }
    folder_.write("u.pfm", pfm_image(4, 4, 1, along_u));
    folder_.write("v.pfm", pfm_image(4, 4, 1, along_v));
    folder_.write("tilt.pfm", pfm_image(1, 1, 3, {0.8f, 0.5f, 0.9f}));
    folder_.write("down.pfm", pfm_image(1, 1, 3, {0.8f, 0.5f, 0.1f}));
  }

  static Text map(const Text& file, const Text& more = "", const Text& wrap = "clamp") {
    return "<texture type='bitmap' name='map'>" + text("filename", file) + yes("raw") +
           text("wrap_mode", wrap) + more + "</texture>";
  }
  static Text bump(const Text& height, const Text& contents) {
    return bsdf("bumpmap", real("scale", height) + contents + diffuse("0.5"));
  }
  static Text mapped(const Text& contents) { return bsdf("normalmap", contents + diffuse("0.5")); }

  /// The middle of a rectangle in z = 0, du and dv 2 m long, seen from above or from `eye`.
  Text seen(const Text& surface, const Text& lights, const Text& eye = "0, 0, 9") const {
    return scene(2, perspective(lookat(eye, "0, 0, 0"), 1, film(4)) + shape("rectangle", surface) + lights);
  }
  RenderResult render_of(const Text& xml, uint64_t spp = 2) {
    RenderSpec spec;
    spec.xml = xml;
    spec.directory = folder_.path();
    spec.spp = spp;
    spec.sampling.replicates = spp > 2 ? 16 : 1;
    return render(spec);
  }
  /// The reflected radiance over E rho / pi: the cosine of the normal and the direction towards the light, times what shadows it.
  double cosine(const Text& surface, const glm::dvec3& to_light, const Text& eye = "0, 0, 9") {
    const Text sun = emitter("directional", "<vector name='direction' value='" +
                                                point(-to_light.x, -to_light.y, -to_light.z) + "'/>" +
                                                spectrum("irradiance", "1"));
    const RenderResult result = render_of(seen(surface, sun, eye));
    EXPECT_EQ(result.invalid_samples, 0u);
    const double width = result.scene.channels[0].max_nm - result.scene.channels[0].min_nm;
    return result.at(2, 2, 0) * 3.14159265358979 / (0.5 * width);
  }

  TemporaryFolder folder_;
};

const glm::dvec3 kLow = glm::normalize(glm::dvec3(0.8, 0.3, 0.4)),
                 kOther = glm::normalize(glm::dvec3(-0.8, -0.2, 0.6));

TEST_F(Bumps, ConstantSlopesAreTiltedPlanes) {
  for (const glm::dvec3& light : {kLow, kOther}) {
    const auto expect_normal = [&](const Text& surface, const glm::dvec3& direction) {
      const double expected = glm::dot(glm::normalize(direction), light);
      EXPECT_NEAR(cosine(surface, light), std::max(expected, 0.0), 2e-6) << surface;
    };
    // h_u = scale, du is 2 m: the slope is half of it.
    expect_normal(bump("0.8", kPlain + map("u.pfm")), {-0.4, 0, 1});
    expect_normal(bump("-3", kPlain + map("u.pfm")), {1.5, 0, 1});
    expect_normal(bump("0.8", kPlain + map("v.pfm")), {0, -0.4, 1});
    const Text half =
        "<transform name='to_uv'>" + scale(-0.5, 0.5, 1) + translate(0.75, 0.25, 0) + "</transform>";
    expect_normal(bump("0.8", kPlain + map("u.pfm", half)), {0.2, 0, 1});
    const Text mirrored = "<transform name='to_uv'>" + translate(1, 0, 0) + "</transform>";
    expect_normal(bump("0.8", kPlain + map("u.pfm", mirrored, "mirror")), {0.4, 0, 1});
    expect_normal(bump("0.8", kPlain + map("u.pfm", mirrored)), {0, 0, 1});  // beyond the border
    expect_normal(bump("0.8", kPlain + map("u.pfm", text("filter_type", "nearest"))), {0, 0, 1});
    expect_normal(mapped(kPlain + map("tilt.pfm")), {0.6, 0, 0.8});
    expect_normal(mapped(kPlain + map("down.pfm")), {0, 0, -1});  // black, not NaN
  }
}

// What the map makes visible of a light behind the surface, it does not get.
TEST_F(Bumps, LightBehindTheSurfaceDoesNotArrive) {
  EXPECT_EQ(cosine(bump("-6", kPlain + map("u.pfm")), glm::normalize(glm::dvec3(1, 0, -0.1))), 0);
}

TEST_F(Bumps, ShadowingFunction) {
  const double tan2 = 0.16, cos2 = kLow.z * kLow.z;
  const double masking = 2 / (1 + std::sqrt(1 + tan2 / 8 * (1 - cos2) / cos2));
  const double expected = glm::dot(glm::normalize(glm::dvec3(0.4, 0, 1)), kLow) * masking;
  EXPECT_NEAR(cosine(bump("-0.8", map("u.pfm")), kLow), expected, 2e-6);
}

// Seen from (9, 0, 4) a normal along (-2, 0, 1) turns away: it is turned to (2, 0, 1) where that is asked for.
TEST_F(Bumps, InvalidNormalsAreTurned) {
  const Text no_shadow = number("boolean", "use_shadowing_function", "false"), eye = "9, 0, 4";
  EXPECT_NEAR(cosine(bump("4", no_shadow + map("u.pfm")), kLow, eye),
              glm::dot(glm::normalize(glm::dvec3(2, 0, 1)), kLow), 1e-5);
  EXPECT_EQ(cosine(bump("4", kPlain + map("u.pfm")), kLow, eye), 0);
}

// From behind, lit from behind: the normal is (0.4, 0, -1) around a two-sided bsdf and (-0.4, 0, -1) inside.
TEST_F(Bumps, TwoSides) {
  const glm::dvec3 light(kLow.x, kLow.y, -kLow.z);
  const Text behind = "0, 0, -9";
  EXPECT_NEAR(cosine(bsdf("twosided", bump("0.8", kPlain + map("u.pfm"))), light, behind),
              glm::dot(glm::normalize(glm::dvec3(-0.4, 0, -1)), light), 2e-6);
  EXPECT_NEAR(
      cosine(bsdf("bumpmap", real("scale", "0.8") + kPlain + map("u.pfm") + bsdf("twosided", diffuse("0.5"))),
             light, behind),
      glm::dot(glm::normalize(glm::dvec3(0.4, 0, -1)), light), 2e-6);
}

TEST_F(Bumps, FlatOnesHaveTheBitsOfNone) {
  const Text lights = sky("1");
  const RenderResult none = render_of(seen(diffuse("0.5"), lights), 64);
  EXPECT_EQ(render_of(seen(bump("0", map("u.pfm")), lights), 64).mean, none.mean);
}

// Reflectance 1 under a sky of 1 gives the part of directions, by cosine with n', that the surface sees: (1 + n . n') / 2.
TEST_F(Bumps, FurnaceOfATiltedNormal) {
  const RenderResult result =
      render_of(seen(bsdf("normalmap", kPlain + map("tilt.pfm") + diffuse("1")), sky("1")), 4096);
  const double width = result.scene.channels[0].max_nm - result.scene.channels[0].min_nm;
  const PixelMean found = mean_of_pixels(result);
  EXPECT_LT(std::sqrt(found.variance), 1e-3 * found.mean);
  EXPECT_LT(z_score(found.mean, 0.9 * width, found.variance), critical_t(1e-6, 1, 16));
}

}  // namespace
}  // namespace kiloband::test::test_bumps
