// A prism bends each wavelength by Snell's law.
//
// A pinhole camera looks through an equilateral prism (edges along y) at a slit 1 km away. In the plane of
// the cross-section each wavelength is bent twice; the slit appears where the twice refracted ray of a film
// position meets it. For each wavelength the film positions of the slit's two edges follow by bisection (the
// deviation is monotone over the film), which gives the part of every pixel that the slit covers; its
// radiance there is Le (1 - R_1)(1 - R_2), the factors eta^2 of entry and exit cancel. Averaged over the
// channel this is the expected image, pixel by pixel. An index that is wrong by 0.0005 moves the image by a
// third of a pixel. (Rays out of the plane, by at most 0.06 degrees, see an index larger by 1e-6.)
//
// Error rate: 1e-4 for the whole program. Detectable bias: of a channel's sum over the image 4.3 % (few paths
// meet the slit; the test is about the place).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/statistical/analytic/dispersive_glass.hpp"
#include "tests/statistical/analytic/fresnel_exact.hpp"

namespace kiloband::test::prism_test {
namespace {

constexpr double kPi = std::numbers::pi;

/// The same as a refractiveindex.info page: micrometres.
std::string index_yaml() {
  std::string rows = "DATA:\n  - type: tabulated n\n    data: |\n";
  for (const auto& [nm, n] : kGlassIndex.points)
    rows += "        " + std::to_string(nm / 1000) + " " + std::to_string(n) + "\n";
  return rows;
}

// ---- the prism, in its plane (x, z) ----

struct Point {
  double x, z;
};
Point operator+(Point a, Point b) {
  return {a.x + b.x, a.z + b.z};
}
Point operator*(double s, Point a) {
  return {s * a.x, s * a.z};
}
double dot(Point a, Point b) {
  return a.x * b.x + a.z * b.z;
}
Point direction(double degrees) {
  return {std::cos(degrees * kPi / 180), std::sin(degrees * kPi / 180)};
}

constexpr uint32_t kPixels = 64;
constexpr double kFieldOfView = 8;                 // degrees
constexpr double kDistance = 1000, kHalfSlit = 5;  // m
constexpr double kRadiance = 4;
const double kHeight = std::sqrt(3.0) / 2;
const Point kLeftNormal = direction(150), kRightNormal = direction(30);
const Point kEntry{-0.25, kHeight / 2}, kExit{0.25, kHeight / 2};
const Point kView = direction(std::asin(0.75) * 180 / kPi - 30);  // smallest deviation for n = 1.5
const Point kCamera = kEntry + -2.0 * kView;
const Point kOut{kView.x, -kView.z};  // there, the way out is the mirror image of the way in
const Point kSlit = kExit + kDistance * kOut;

/// Snell's law at a boundary with normal n against d; eta: index behind it over index before it.
Point refract(Point d, Point n, double eta) {
  const double c = -dot(d, n);
  const double c_out = std::sqrt(1 - (1 - c * c) / (eta * eta));
  return 1 / eta * d + (c / eta - c_out) * n;
}

Point advance(Point origin, Point d, Point on_plane, Point normal) {
  return origin + dot(on_plane + -1.0 * origin, normal) / dot(d, normal) * d;
}

/// Where on the slit (m from its centre) the ray of film position s in [0, 1] arrives,
/// and what is transmitted.
struct Arrival {
  double across;
  double transmittance;
};
Arrival trace(double s, double index) {
  // Local +X is the image's left: with up = +Y and the view in the plane, x_local = up x view.
  const Point left{kView.z, -kView.x};  // (0,1,0) x (x,0,z) = (z, 0, -x)
  const Point aim = kView + (1 - 2 * s) * std::tan(kFieldOfView / 2 * kPi / 180) * left;
  const Point in = 1 / std::sqrt(dot(aim, aim)) * aim;
  const Point inside = refract(in, kLeftNormal, index);
  const Point out = refract(inside, -1.0 * kRightNormal, 1 / index);
  const Point entry = advance(kCamera, in, kEntry, kLeftNormal);
  const Point exit = advance(entry, inside, kExit, kRightNormal);
  const Point end = advance(exit, out, kSlit, kOut);
  const double r1 = dielectric_reflectance(-dot(in, kLeftNormal), index);
  const double r2 = dielectric_reflectance(dot(inside, kRightNormal), 1 / index);
  const Point offset = end + -1.0 * kSlit;
  return {-offset.x * kOut.z + offset.z * kOut.x, (1 - r1) * (1 - r2)};
}

/// Film position whose ray arrives at `across`.
double film_position(double across, double index) {
  double low = 0, high = 1;
  const bool rising = trace(1, index).across > trace(0, index).across;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    ((trace(middle, index).across < across) == rising ? low : high) = middle;
  }
  return low;
}

/// Expected value of every pixel for one channel.
std::vector<double> prism_image(const Channel& channel) {
  constexpr int kSteps = 500;
  std::vector<double> image(kPixels);
  for (int i = 0; i < kSteps; ++i) {
    const double index = kGlassIndex(channel.min_nm + (i + 0.5) / kSteps * channel.width_nm());
    const double a = film_position(-kHalfSlit, index) * kPixels,
                 b = film_position(kHalfSlit, index) * kPixels;
    for (uint32_t x = 0; x < kPixels; ++x) {
      const double from = std::max<double>(x, std::min(a, b)), to = std::min<double>(x + 1, std::max(a, b));
      if (to > from) image[x] += (to - from) * trace((from + to) / 2 / kPixels, index).transmittance;
    }
  }
  for (double& value : image) value *= kRadiance * channel.width_nm() / kSteps;
  return image;
}

const char* const kPrism = R"(v -0.5 -1 0
v 0.5 -1 0
v 0 -1 0.86602540378
v -0.5 1 0
v 0.5 1 0
v 0 1 0.86602540378
f 1 3 6
f 1 6 4
f 3 2 5
f 3 5 6
f 2 1 4
f 2 4 5
f 1 2 3
f 4 6 5
)";

std::string prism_scene() {
  const std::string camera = perspective(lookat(point(kCamera.x, 0, kCamera.z), point(kEntry.x, 0, kEntry.z)),
                                         kFieldOfView, film(size(kPixels, 1)));
  const std::string prism =
      shape("obj", text("filename", "prism.obj") + yes("face_normals") + glass("dielectric"));
  const std::string slit =
      shape("rectangle", to_world(scale(point(kHalfSlit, 100, 1)) +
                                  lookat(point(kSlit.x, 0, kSlit.z), point(kExit.x, 0, kExit.z))) +
                             lamp(kRadiance));
  return scene(3, camera + prism + slit);  // entry, exit, slit: no inner reflections
}

/// Pixels that the slit covers by at least 1 % are tested, those two pixels away from it must be black.
void expect_prism_image(const RenderResult& result, std::size_t channel,
                        const std::vector<double>& expected) {
  double largest = 0;
  for (const double value : expected) largest = std::max(largest, value);
  double sum = 0;
  for (uint32_t x = 0; x < kPixels; ++x) {
    const std::size_t index = std::size_t{x} * result.channels + channel;
    const std::string what = "channel " + std::to_string(channel) + " pixel " + std::to_string(x);
    sum += expected[x];
    if (expected[x] >= 0.01 * largest) {
      expect_mean(what, result.mean[index], result.variance[index], expected[x], result.replicates, HUGE_VAL);
      continue;
    }
    const double near = expected[x == 0 ? 0 : x - 1] + expected[x] + expected[std::min(x + 1, kPixels - 1)];
    if (near == 0) {
      EXPECT_EQ(result.mean[index], 0) << what;
    }
  }
  expect_mean("sum of channel " + std::to_string(channel), result.image_mean[channel],
              result.image_variance[channel], sum / kPixels, result.replicates, 0.043);
}

class PrismTest : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, PrismTest, ::testing::ValuesIn(all_modes()), mode_name);

/// `name` and `content`: the file of the index.
void expect_prism(const std::string& name, const std::string& content, const Mode& mode) {
  const TemporaryFolder folder;
  folder.write("prism.obj", kPrism);
  folder.write(name, content);
  std::string xml = prism_scene();
  xml.replace(xml.find("glass.txt"), 9, name);
  const RenderResult result = render_valid(xml, kDispersionBands, mode, {640, 61}, folder.path());
  std::vector<double> centres;
  for (std::size_t c = 0; c < result.channels; ++c) {
    const std::vector<double> expected = prism_image(result.scene.channels[c]);
    expect_prism_image(result, c, expected);
    double sum = 0, moment = 0;
    for (uint32_t x = 0; x < kPixels; ++x) {
      sum += expected[x];
      moment += x * expected[x];
    }
    centres.push_back(moment / sum);
  }
  // The channels are apart: the test sees the dispersion and not one place.
  for (std::size_t c = 1; c < centres.size(); ++c) EXPECT_GT(std::abs(centres[c] - centres[c - 1]), 3);
}

TEST_P(PrismTest, EveryWavelengthFollowsSnellsLaw) {
  expect_prism("glass.txt", index_columns(), GetParam());
}

TEST(Prism, IndexFromYaml) {
  expect_prism("glass.yml", index_yaml(), {});
}

}  // namespace
}  // namespace kiloband::test::prism_test
