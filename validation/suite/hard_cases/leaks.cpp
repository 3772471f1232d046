// No ray passes a closed surface: bodies that are lit from outside by an environment
// of 1e6 stay exactly black inside.
//
// The camera stands inside; diffuse walls of reflectance 0.97 send paths on for 50 bounces, and every vertex
// sends a shadow ray towards the environment. One ray that passed a wall would make a pixel positive: the
// reference is 0, and the limit is 0. With no leak in n rays, the rate of leaks is below 9.2 / n
// at the level 1e-4.
#include <array>
#include <cmath>

#include "base/temporary_folder.hpp"
#include "validation/suite/hard_cases/groups.hpp"
#include "validation/suite/hard_cases/trial.hpp"
#include "validation/suite/scene_text.hpp"

namespace kiloband::validation {
namespace {

using namespace scene_text;

const std::string kWall = bsdf("twosided", diffuse(0.97));

/// A closed mesh around `centre`: a sphere of `rings` x 2 `rings` quadrilaterals, scaled differently along
/// its axes and turned by irrational angles, as ASCII PLY. Vertices are shared.
std::string closed_mesh(int rings, const std::array<double, 3>& centre, double size) {
  const int around = 2 * rings;
  std::string vertices, faces;
  const auto add = [&](double theta, double phi) {
    const double x = std::sin(theta) * std::cos(phi), y = 0.7 * std::sin(theta) * std::sin(phi),
                 z = 1.3 * std::cos(theta);
    const double u = std::cos(1.0) * x - std::sin(1.0) * z, w = std::sin(1.0) * x + std::cos(1.0) * z;
    const double v = std::cos(2.0) * y - std::sin(2.0) * w, t = std::sin(2.0) * y + std::cos(2.0) * w;
    vertices += exact(centre[0] + size * u) + " " + exact(centre[1] + size * v) + " " +
                exact(centre[2] + size * t) + "\n";
  };
  const auto face = [&](int a, int b, int c) {
    faces += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  };
  add(0, 0);
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < around; ++j) add(kPi * i / rings, 2 * kPi * j / around);
  add(kPi, 0);
  const int last = 1 + (rings - 1) * around;
  const auto at = [&](int i, int j) { return 1 + (i - 1) * around + j % around; };
  for (int j = 0; j < around; ++j) {
    face(0, at(1, j), at(1, j + 1));
    face(last, at(rings - 1, j + 1), at(rings - 1, j));
    for (int i = 1; i + 1 < rings; ++i) {
      face(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      face(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(last + 1) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(2 * around * (rings - 1)) + "\nproperty list uchar int vertex_indices\nend_header\n" +
         vertices + faces;
}

/// A tetrahedron whose edges are acute.
std::string tetrahedron() {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
         "z\nelement face "
         "4\nproperty list uchar int vertex_indices\nend_header\n1.013 0.977 1.021\n-0.991 -1.003 "
         "0.973\n-1.017 1.009 "
         "-0.983\n0.987 -1.011 -1.007\n3 0 1 2\n3 0 3 1\n3 0 2 3\n3 1 3 2\n";
}

std::string ply_shape(const std::string& file) {
  return shape("ply", text("filename", file) + "<boolean name=\"face_normals\" value=\"true\"/>" + kWall);
}

struct Body {
  std::string name, shapes;
  std::array<double, 3> centre{};
};

std::vector<Body> bodies(const ScratchFolder& folder) {
  const std::array<double, 3> origin{}, away{148.3761, 12.3417, -223.4233}, far{148376.1, 1234.1, -223423.3};
  folder.write("near.ply", closed_mesh(24, origin, 1));
  folder.write("away.ply", closed_mesh(24, away, 1));
  folder.write("far.ply", closed_mesh(24, far, 100));
  folder.write("acute.ply", tetrahedron());
  const std::string turned = rotate(0.31, 1, 0.17, 33.3);
  std::string sides;
  for (const auto& [x, y, degrees] : {std::array{1.0, 0.0, 0.0},
                                      {1.0, 0.0, 90.0},
                                      {1.0, 0.0, 180.0},
                                      {1.0, 0.0, 270.0},
                                      {0.0, 1.0, 90.0},
                                      {0.0, 1.0, 270.0}})
    sides += shape("rectangle", to_world(translate(0, 0, -1) + rotate(x, y, 0, degrees)) + kWall);
  return {
      {"mesh, 2208 triangles", ply_shape("near.ply"), origin},
      {"mesh 268 m from the origin", ply_shape("away.ply"), away},
      {"mesh 268 km from the origin", ply_shape("far.ply"), far},
      {"tetrahedron", ply_shape("acute.ply"), origin},
      {"cube, turned", shape("cube", to_world(turned) + kWall), origin},
      {"six rectangles", sides, origin},
      {"sphere", shape("sphere", kWall), origin},
      {"sphere of 1 mm", shape("sphere", to_world(scale(1e-3, 1e-3, 1e-3)) + kWall), origin},
      {"cylinder and disks",
       shape("cylinder", kWall) + shape("disk", kWall) + shape("disk", to_world(translate(0, 0, 1)) + kWall),
       {0.1, 0.1, 0.5}}};
}

std::vector<HardFigure> closed_bodies(const HardCaseContext& context) {
  Trial trial(context);
  const ScratchFolder folder;
  // About 60 rays a path: 9 bodies of 1024 pixels.
  TrialSettings settings{.bands = "500-501",
                         .samples = static_cast<uint32_t>(trial.by_effort(2, 64, 1400)),
                         .sampler = SamplerType::kIndependent,
                         .directory = folder.path()};
  double rays = 0, paths = 0;
  for (const Body& body : bodies(folder)) {
    const auto& c = body.centre;
    const double near = body.name == "sphere of 1 mm" ? 1e-5 : 1e-3;
    const std::string look = lookat(point(c[0], c[1], c[2]), point(c[0] + 1, c[1] + 0.3, c[2] - 0.2));
    const TrialImage image = trial.render(
        scene_text::scene(50, perspective(look, 120, film(32), near) + body.shapes + sky(1e6)), settings);
    std::size_t bright = 0;
    double sum = 0;
    for (const double value : image.mean) bright += value != 0, sum += value;
    trial.figure(
        body.name, "pixels that are not black", static_cast<double>(bright), 0, 0,
        short_text(static_cast<double>(image.rays)) + " rays, mean radiance " + short_text(sum / 1024));
    rays += static_cast<double>(image.rays);
    paths += static_cast<double>(image.paths);
  }
  trial.at_least("rays that were tried", "rays", rays, 30 * paths, "at least; none may come in");
  return trial.finish();
}

}  // namespace

std::vector<HardCase> leak_cases() {
  return {{"watertight", "closed bodies lit from outside stay black inside", closed_bodies}};
}

}  // namespace kiloband::validation
