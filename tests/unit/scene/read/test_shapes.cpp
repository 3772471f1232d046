// Every shape: geometry and how parameters are folded into the transform.
#include <gtest/gtest.h>

#include "support.hpp"

namespace kiloband::test::test_shapes {
namespace {

Shape shape_of(const std::string& shape, const std::filesystem::path& folder = "/nonexistent") {
  return read(scene(shape + kSensor + kLight), folder).shapes.at(0);
}

const Mesh& mesh_of(const Shape& shape) {
  return *std::get<MeshShape>(shape.geometry).mesh;
}

void expect_point(const Transform& m, const glm::dvec4& from, const glm::dvec3& to) {
  const glm::dvec4 got = m * from;
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(got[axis], to[axis], 1e-12);
}

glm::vec3 to_vector(const Vec3f& v) {
  return {v[0], v[1], v[2]};
}

glm::vec3 face_normal(const Mesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  const glm::vec3 a = to_vector(mesh.positions[t[0]]), b = to_vector(mesh.positions[t[1]]),
                  c = to_vector(mesh.positions[t[2]]);
  return glm::cross(b - a, c - a);
}

TEST(SceneShape, SphereFoldsCentreAndRadius) {
  const Shape sphere = shape_of(
      R"(<shape type="sphere" id="ball"><point name="center" x="1" y="2" z="3"/><float name="radius" value="2"/>)"
      R"(<transform name="to_world"><scale value="3"/><translate x="1"/></transform></shape>)");
  EXPECT_TRUE(std::holds_alternative<SphereShape>(sphere.geometry));
  EXPECT_EQ(sphere.id, "ball");
  EXPECT_EQ(sphere.position.to_string(), "scene.xml:2:2");
  expect_point(sphere.to_world, {0, 0, 0, 1}, {4, 6, 9});
  expect_point(sphere.to_world, {0, 0, 1, 0}, {0, 0, 6});
}

TEST(SceneShape, TexturesWithoutTextureCoordinatesAreWarnedOf) {
  const TemporaryFolder folder;
  folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
  const auto obj = [](const std::string& file) {
    return R"(<shape type="obj"><string name="filename" value=")" + file + R"("/><ref id="board"/></shape>)";
  };
  const std::string board =
      R"(<bsdf type="twosided" id="board"><bsdf type="diffuse"><texture type="checkerboard" name="reflectance"/></bsdf></bsdf>)";
  Messages messages;
  read(complete_scene(board + obj("b.obj") + obj("a.obj") + "\n" + obj("a.obj")), folder.path(), {},
       messages.lines());
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_EQ(
      messages.texts[0].substr(messages.texts[0].find("warning")),
      "warning: obj shape: a checkerboard on a mesh without texture coordinates: every triangle shows the "
      "same half of it");
}

TEST(SceneShape, DiskIgnoresTheScaleAlongItsAxis) {
  const Shape disk = shape_of(
      R"(<shape type="disk"><transform name="to_world"><scale x="2" y="2" z="9"/></transform></shape>)");
  EXPECT_TRUE(std::holds_alternative<DiskShape>(disk.geometry));
  expect_point(disk.to_world, {0, 0, 1, 0}, {0, 0, 2});
  expect_point(disk.to_world, {1, 0, 0, 0}, {2, 0, 0});
}

TEST(SceneShape, CylinderFoldsItsEndsAndRadius) {
  const Shape plain = shape_of(R"(<shape type="cylinder"/>)");
  EXPECT_EQ(plain.to_world, Transform(1.0));
  const Shape cylinder =
      shape_of(R"(<shape type="cylinder"><point name="p0" value="1 0 0"/><point name="p1" value="4 0 0"/>)"
               R"(<float name="radius" value="0.5"/></shape>)");
  EXPECT_TRUE(std::holds_alternative<CylinderShape>(cylinder.geometry));
  expect_point(cylinder.to_world, {0, 0, 0, 1}, {1, 0, 0});
  expect_point(cylinder.to_world, {0, 0, 1, 1}, {4, 0, 0});
  EXPECT_NEAR(glm::length(glm::dvec3(cylinder.to_world[0])), 0.5, 1e-12);
  EXPECT_NEAR(cylinder.to_world[1].x, 0, 1e-12);
}

TEST(SceneShape, RectangleFacesZWithUvOverTheSquare) {
  const Shape shape = shape_of(R"(<shape type="rectangle"/>)");
  const Mesh& mesh = mesh_of(shape);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(face_normal(mesh, i), glm::vec3(0, 0, 4));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(mesh.uvs[i][0], (mesh.positions[i][0] + 1) / 2);
    EXPECT_EQ(mesh.uvs[i][1], (mesh.positions[i][1] + 1) / 2);
  }
}

TEST(SceneShape, CubeFacesOutwardsWithVerticesOfItsOwn) {
  const Shape shape = shape_of(R"(<shape type="cube"/>)");
  const Mesh& mesh = mesh_of(shape);
  ASSERT_EQ(mesh.triangles.size(), 12u);
  ASSERT_EQ(mesh.positions.size(), 24u);
  EXPECT_TRUE(mesh.normals.empty());
  glm::vec3 sum(0);
  for (std::size_t i = 0; i < 12; ++i) {
    const glm::vec3 normal = face_normal(mesh, i);
    const auto& t = mesh.triangles[i];
    const glm::vec3 centre = (to_vector(mesh.positions[t[0]]) + to_vector(mesh.positions[t[1]]) +
                              to_vector(mesh.positions[t[2]])) /
                             3.0f;
    EXPECT_EQ(glm::dot(normal, centre), 4.0f) << i;  // outward, at distance 1
    sum += normal;
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(t[k] / 4, i / 2);
  }
  EXPECT_EQ(sum, glm::vec3(0));
}

/// As pictures on Mitsuba 3.9.1's cube show, face by face.
TEST(SceneShape, CubeHasMitsubasTextureCoordinates) {
  const Shape shape = shape_of(R"(<shape type="cube"/>)");
  const Mesh& mesh = mesh_of(shape);
  const auto uv_at = [](const glm::vec3& p, const glm::vec3& normal) -> glm::vec2 {
    if (normal.x > 0) return {p.y, -p.z};
    if (normal.x < 0) return {p.y, p.z};
    if (normal.y > 0) return {-p.x, -p.z};
    if (normal.y < 0) return {p.z, p.x};
    return {normal.z > 0 ? p.y : -p.y, p.x};
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const uint32_t corner : mesh.triangles[i]) {
      const glm::vec2 expected = uv_at(to_vector(mesh.positions[corner]), face_normal(mesh, i));
      EXPECT_EQ(mesh.uvs[corner][0], (expected.x + 1) / 2) << i << " " << corner;
      EXPECT_EQ(mesh.uvs[corner][1], (expected.y + 1) / 2) << i << " " << corner;
    }
  }
}

TEST(SceneShape, MeshFilesAreSharedAndFlipTheirTexturesByFormat) {
  const TemporaryFolder folder;
  folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nvt 1 0.25\nvt 0 1\nf 1/1 2/2 3/3\n");
  const std::string file = R"(<string name="filename" value="a.obj"/>)";
  const SceneDescription result =
      read(scene(R"(<shape type="obj">)" + file + R"(</shape><shape type="obj">)" + file +
                 R"(</shape><shape type="obj">)" + file +
                 R"(<boolean name="flip_tex_coords" value="false"/></shape>)" + kSensor + kLight),
           folder.path());
  EXPECT_EQ(&mesh_of(result.shapes[0]), &mesh_of(result.shapes[1]));
  EXPECT_EQ(mesh_of(result.shapes[0]).uvs.at(0)[1], 0.75f);
  EXPECT_EQ(mesh_of(result.shapes[2]).uvs.at(0)[1], 0.25f);
}

TEST(SceneShape, StlHasFlatFacets) {
  const TemporaryFolder folder;
  folder.write("a.stl",
               "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
               "0\nendloop\nendfacet\nendsolid a\n");
  const Shape shape =
      shape_of(R"(<shape type="stl"><string name="filename" value="a.stl"/></shape>)", folder.path());
  EXPECT_EQ(mesh_of(shape).triangles.size(), 1u);
  EXPECT_TRUE(mesh_of(shape).uvs.empty());
}

TEST(SceneShape, OneEmitterMayServeSeveralShapes) {
  const SceneDescription result = read(scene(
      R"(<emitter type="area" id="lamp"><spectrum name="radiance" value="3"/></emitter>)"
      R"(<shape type="disk"><ref id="lamp"/></shape><shape type="disk"><ref id="lamp"/><boolean name="flip_normals" value="true"/></shape>)" +
      kSensor));
  EXPECT_TRUE(result.emitters.empty());
  for (const Shape& shape : result.shapes) {
    ASSERT_TRUE(shape.emitter);
    EXPECT_EQ(std::get<Spectrum>(shape.emitter->radiance)(1000), 3);
    EXPECT_EQ(shape.emitter_position.to_string(), "scene.xml:2:2");
  }
  EXPECT_TRUE(result.shapes[1].flip_normals);
}

}  // namespace
}  // namespace kiloband::test::test_shapes
