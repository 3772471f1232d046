// Which side of a shape is its front: for what it emits to rays that hit it and to light samples, for its
// BSDF and for what it emits thermally.
//
// The table is what Mitsuba 3.9.1 renders (scalar variants; validation/mitsuba/compare_sides.py renders it
// again, with more kinds of meshes): vertex normals decide where there are any, else the winding in the
// world; a mirroring transform takes given normals along, and turns spheres and meshes without normals over.
//
// Cells stand in a row, kPitch apart: a light of half size 5 about (x, 0, 0), a receiver beside it above and
// one below, whose lit sides are seen from the other side of the light. Of a neighbour's light they see less
// than 1 % of what they see of their own. Hits are exact: 0 or 1. Samples only tell lit from unlit: a
// receiver's own light gives it about `dim` (kDim by quadrature over the pixel), and a twentieth and a
// quarter of that are far from what noise does to 512 samples a pixel;
// cpu_lights and gpu_lights test densities.
#include <cmath>
#include <numbers>

#include "spectral/planck.hpp"
#include "tests/statistical/analytic/analytic_test.hpp"

namespace kiloband::test::emission_side_test {
namespace {

constexpr double kPixel = 6, kPitch = 12 * kPixel;
constexpr double kSize = 5, kDim = 0.0325, kDimClosed = 0.047;
constexpr uint32_t kPixelsOfACell = 12, kLightAt = 5, kLowerAt = 3, kUpperAt = 7;
const char* const kBand = "500-501";

const std::string kMirrors[] = {"", step("scale", "x='-1'"), step("scale", "z='-1'"), scale("-1")};

/// front: towards +Z or outwards (1), or the other way (-1), under the transforms of kMirrors.
struct Row {
  const char* type;
  const char* file;  // of a mesh
  bool face_normals;
  int front[4];
};

constexpr Row kFlat[] = {
    {"obj", "agree", false, {1, 1, -1, -1}},  {"obj", "agree", true, {1, -1, 1, 1}},
    {"obj", "oppose", false, {-1, -1, 1, 1}}, {"obj", "oppose", true, {1, -1, 1, 1}},
    {"obj", "absent", false, {1, -1, 1, 1}},  {"ply", "oppose", false, {-1, -1, 1, 1}},
    {"ply", "absent", true, {1, -1, 1, 1}},   {"rectangle", "", false, {1, 1, -1, -1}},
    {"disk", "", false, {1, 1, -1, -1}},      {"stl", "facets", false, {1, -1, 1, 1}},  // stl: not Mitsuba's
};
constexpr Row kClosed[] = {{"sphere", "", false, {1, -1, -1, -1}},
                           {"cylinder", "", false, {1, 1, 1, 1}},
                           {"cube", "", false, {1, 1, 1, 1}}};

/// A square in z = 0, counter-clockwise seen from +Z, whose vertex normals have these z; 0: none.
std::string square_obj(const std::vector<int>& normals) {
  std::string text = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";
  for (const int z : normals) text += "vn 0 0 " + std::to_string(z) + "\n";
  return text + (normals.empty() ? "f 1 2 3\nf 1 3 4\n" : "f 1//1 2//2 3//3\nf 1//1 3//3 4//4\n");
}

std::string square_ply(int normal_z) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex 4\n";
  for (const char* name : {"x", "y", "z"}) text += std::string("property float ") + name + "\n";
  if (normal_z != 0)
    for (const char* name : {"nx", "ny", "nz"}) text += std::string("property float ") + name + "\n";
  text += "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string normal = normal_z != 0 ? " 0 0 " + std::to_string(normal_z) : "";
  for (const char* corner : {"-1 -1 0", "1 -1 0", "1 1 0", "-1 1 0"}) text += corner + normal + "\n";
  return text + "3 0 1 2\n3 0 2 3\n";
}

std::string square_stl() {
  std::string text = "solid square\n";
  for (const char* third : {"1 -1 0\nvertex 1 1 0", "1 1 0\nvertex -1 1 0"})
    text += std::string("facet normal 0 0 0\nouter loop\nvertex -1 -1 0\nvertex ") + third +
            "\nendloop\nendfacet\n";
  return text + "endsolid square\n";
}

/// The mesh files of the table.
class EmissionSide : public testing::Test {
 protected:
  EmissionSide() {
    folder_.write("agree.obj", square_obj({1, 1, 1, 1}));
    folder_.write("oppose.obj", square_obj({-1, -1, -1, -1}));
    folder_.write("halves.obj", square_obj({1, 1, -1, -1}));
    folder_.write("absent.obj", square_obj({}));
    folder_.write("oppose.ply", square_ply(-1));
    folder_.write("absent.ply", square_ply(0));
    folder_.write("facets.stl", square_stl());
  }

  RenderResult render_row(int max_depth, const std::string& body, std::size_t cells, bool from_above,
                          double near_clip, uint64_t samples, const char* band = kBand,
                          uint32_t replicates = 2) const;

  TemporaryFolder folder_;
};

/// A shape of the table and what is said of it.
struct Cell {
  Row row;
  int mirror;
  bool flipped;

  int front() const { return flipped ? -row.front[mirror] : row.front[mirror]; }
  std::string name() const {
    return std::string(row.type) + " " + row.file + (row.face_normals ? " face_normals " : " ") +
           kMirrors[mirror] + (flipped ? " flipped" : "");
  }
  /// Of half size `size` about (x, 0, 0); cylinders lie along y.
  std::string xml(double x, double size, const std::string& content) const {
    std::string parameters =
        "<boolean name=\"flip_normals\" value=\"" + std::string(flipped ? "true" : "false") + "\"/>";
    if (*row.file)
      parameters += "<string name=\"filename\" value=\"" + std::string(row.file) + "." + row.type + "\"/>";
    if (row.face_normals) parameters += yes("face_normals");
    if (row.type == std::string("cylinder"))
      parameters += "<point name=\"p0\" value=\"0 -1 0\"/><point name=\"p1\" value=\"0 1 0\"/>";
    const std::string place =
        "<scale value=\"" + point(size, size, size) + "\"/><translate value=\"" + point(x, 0, 0) + "\"/>";
    return shape(row.type, parameters + to_world(kMirrors[mirror] + place) + content);
  }
};

template <std::size_t N>
std::vector<Cell> cells_of(const Row (&rows)[N]) {
  std::vector<Cell> cells;
  for (const Row& row : rows)
    for (int mirror = 0; mirror < 4; ++mirror)
      for (const bool flipped : {false, true}) cells.push_back({row, mirror, flipped});
  return cells;
}

double centre_of(std::size_t cell) {
  return kPitch * static_cast<double>(cell) + kPixel * kLightAt;
}

/// A row of pixels of size kPixel, which sees the cells from +Z or -Z;
/// rays begin near_clip before the camera at |z| = 100.
RenderResult EmissionSide::render_row(int max_depth, const std::string& body, std::size_t cells,
                                      bool from_above, double near_clip, uint64_t samples, const char* band,
                                      uint32_t replicates) const {
  const auto width = static_cast<double>(kPixelsOfACell * cells);
  const double middle = kPixel * (width - 1) / 2, z = from_above ? 100 : -100;
  const std::string zoom = scale(point(width * kPixel / 2, width * kPixel / 2, 1));
  const std::string sensor = object("sensor", "orthographic",
                                    real("near_clip", near_clip) +
                                        to_world(zoom + lookat(point(middle, 0, z), point(middle, 0, 0))) +
                                        film(scene_text::size(static_cast<int>(width), 1)));
  return render_valid(scene(max_depth, sensor + body), band, {}, {samples / replicates, 5, replicates},
                      folder_.path());
}

/// The pixel that sees something `pixel` pixels from the cell's beginning.
uint32_t column_of(const RenderResult& result, std::size_t cell, uint32_t pixel, bool from_above) {
  const auto x = static_cast<uint32_t>(kPixelsOfACell * cell + pixel);
  return from_above ? x : result.width - 1 - x;
}

double seen(const RenderResult& result, std::size_t cell, uint32_t pixel, bool from_above) {
  return result.at(column_of(result, cell, pixel, from_above), 0, 0);
}

std::string receiver(double x, double z, const std::string& way) {
  return shape("rectangle", to_world(way + scale("4") + translate(x, 0, z)) + diffuse(1));
}

std::string receivers(double x) {
  return receiver(x + 2 * kPixel, 4, turn("x", "180")) + receiver(x - 2 * kPixel, -4, "");
}

void expect_lit(double value, bool lit, double dim, const std::string& what) {
  if (lit)
    EXPECT_GT(value, 0.25 * dim) << what;
  else
    EXPECT_LT(value, 0.05 * dim) << what;
}

/// Lights in groups, so that each is chosen often enough. outside: both cameras see the shapes' outside.
void check_lights(const std::vector<Cell>& cells, bool outside, double dim,
                  const std::function<RenderResult(int, const std::string&, std::size_t, bool)>& render) {
  constexpr std::size_t kGroup = 16;
  for (std::size_t first = 0; first < cells.size(); first += kGroup) {
    const std::size_t count = std::min(kGroup, cells.size() - first);
    std::string body;
    for (std::size_t i = 0; i < count; ++i)
      body += cells[first + i].xml(centre_of(i), kSize, lamp(1)) + receivers(centre_of(i));
    for (const int max_depth : {2, 3}) {
      for (const bool above : {true, false}) {
        const RenderResult result = render(max_depth, body, count, above);
        for (std::size_t i = 0; i < count; ++i) {
          const int front = cells[first + i].front();
          const std::string what = cells[first + i].name() + (above ? " from above" : " from below");
          const bool hit = outside ? front > 0 : above == (front > 0);
          const bool sampled = outside ? front > 0 : above == (front < 0);  // from above: the lower receiver
          EXPECT_NEAR(seen(result, i, kLightAt, above), hit, kRounding) << what;
          expect_lit(seen(result, i, above ? kLowerAt : kUpperAt, above), sampled, dim, what);
        }
      }
    }
  }
}

TEST_F(EmissionSide, OfFlatShapes) {
  check_lights(cells_of(kFlat), false, kDim,
               [&](int depth, const std::string& body, std::size_t cells, bool above) {
                 return render_row(depth, body, cells, above, 0.01, 512);
               });
}

TEST_F(EmissionSide, OfClosedShapesFromOutside) {
  check_lights(cells_of(kClosed), true, kDimClosed,
               [&](int depth, const std::string& body, std::size_t cells, bool above) {
                 return render_row(depth, body, cells, above, 0.01, 512);
               });
}

/// Rays begin in the plane z = 0, inside: one shape of each pair is empty,
/// in the other is a receiver that faces up.
TEST_F(EmissionSide, OfClosedShapesFromInside) {
  const std::vector<Cell> cells = cells_of(kClosed);
  std::string body;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (const uint32_t pixel : {0u, 6u}) body += cells[i].xml(centre_of(i) + kPixel * pixel, 6, lamp(1));
    body += receiver(centre_of(i) + kPixel * 6, -1, "");
  }
  for (const int max_depth : {2, 3}) {
    const RenderResult result = render_row(max_depth, body, cells.size(), true, 100, 512);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const bool shines = cells[i].front() < 0;
      EXPECT_NEAR(seen(result, i, kLightAt, true), shines, kRounding) << cells[i].name();
      expect_lit(seen(result, i, kLightAt + 6, true), shines, 1, cells[i].name());
    }
  }
}

/// What a receiver's pixel shows of a light of radiance 1: h^2 / (pi r^4) over the light, averaged over the pixel; midpoint rule.
double dim_of_pixel() {
  constexpr int kSteps = 24;
  constexpr double kHeight = 4, kAway = 2 * kPixel;
  const auto place = [](int i, double half) { return half * ((2 * i + 1.0) / kSteps - 1); };
  double sum = 0;
  for (int i = 0; i < kSteps * kSteps; ++i) {
    for (int j = 0; j < kSteps * kSteps; ++j) {
      const double dx = kAway + place(i / kSteps, kPixel / 2) - place(j / kSteps, kSize),
                   dy = place(i % kSteps, kPixel / 2) - place(j % kSteps, kSize);
      const double square = dx * dx + dy * dy + kHeight * kHeight;
      sum += kHeight * kHeight / (std::numbers::pi * square * square);
    }
  }
  return sum / std::pow(kSteps, 4) * 4 * kSize * kSize;
}

/// Vertex normals up and down in one mesh: it shines up where they interpolate to up, and down elsewhere. Of y < 0 and y > 0 a pixel
/// sees as much. Detectable bias: 1 % of what is hit, 6 % of what is sampled.
TEST_F(EmissionSide, OfNormalsThatDifferWithinAMesh) {
  constexpr uint32_t kParts = 64;
  const Cell cell{{"obj", "halves", false, {}}, 0, false};
  const std::string body = cell.xml(centre_of(0), kSize, lamp(1)) + receivers(centre_of(0));
  const double dim = dim_of_pixel();
  EXPECT_NEAR(dim, kDim, 5e-5);
  for (const bool above : {true, false}) {
    const RenderResult result = render_row(2, body, 1, above, 0.01, 32768, kBand, kParts);
    const auto expect = [&](uint32_t pixel, double value, double bias) {
      const uint32_t x = column_of(result, 0, pixel, above);
      expect_mean(std::to_string(pixel), result.mean[x], result.variance[x], value, kParts, bias);
    };
    expect(kLightAt, 0.5, 0.01);
    expect(above ? kLowerAt : kUpperAt, 0.5 * dim, 0.06);
  }
}

/// One-sided: black from behind, to light that falls on it;
/// by Kirchhoff's law it then emits all, in front half.
TEST_F(EmissionSide, IsThatOfBsdfAndThermalEmission) {
  std::vector<Cell> cells = cells_of(kFlat);
  const std::string grey = diffuse(0.5);
  const std::string hot = thermal(600);
  std::string surfaces, emitters;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    surfaces += cells[i].xml(centre_of(i), kSize, grey);
    emitters += cells[i].xml(centre_of(i), kSize, grey + hot);
  }
  const double black = planck_integral(10000, 10001, 600);
  for (const bool above : {true, false}) {
    const RenderResult lit = render_row(2, surfaces + sky(1), cells.size(), above, 0.01, 256);
    const RenderResult thermal = render_row(1, emitters, cells.size(), above, 0.01, 16, "10000-10001");
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const bool front = above == (cells[i].front() > 0);
      EXPECT_NEAR(seen(lit, i, kLightAt, above), front ? 0.5 : 0, front ? 0.1 : 0) << cells[i].name();
      EXPECT_NEAR(seen(thermal, i, kLightAt, above) / black, front ? 0.5 : 1, 1e-4) << cells[i].name();
    }
  }
}

}  // namespace
}  // namespace kiloband::test::emission_side_test
