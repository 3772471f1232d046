// Faces that a fan would fold: cut by ears, in every reader that has polygons.
#include "scene/mesh/polygon.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support.hpp"

namespace kiloband::test {
namespace polygons {

using Triangles = std::vector<std::array<uint32_t, 3>>;
using Points = std::vector<Vec3f>;

double signed_area(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
}

/// Sum of the triangles' areas in the plane z = 0, and the smallest of them, both as the face is oriented.
std::pair<double, double> areas(const Points& points, const Triangles& triangles, double side) {
  double sum = 0, least = HUGE_VAL;
  for (const auto& [a, b, c] : triangles) {
    const double area = side * signed_area(points[a], points[b], points[c]);
    sum += area;
    least = std::min(least, area);
  }
  return {sum, least};
}

const Points kL = {{-1, -1, 0}, {1, -1, 0}, {1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 1, 0}};

TEST(Polygons, ConcaveOnesAreCoveredOnce) {
  const Points comb = {{0, 0, 0}, {7, 0, 0}, {7, 5, 0}, {6, 1, 0}, {5, 5, 0},
                       {4, 1, 0}, {3, 5, 0}, {2, 1, 0}, {1, 5, 0}, {1, 1, 0}};
  // A square with a square hole, which a doubled edge joins to its border.
  const Points hole = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0},
                       {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}};
  const Points repeated = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 1, 0}, {1, 1, 0}, {0, 2, 0}};
  for (const auto& [shape, area] :
       {std::pair(kL, 3.0), std::pair(comb, 18.5), std::pair(hole, 12.0), std::pair(repeated, 3.0)})
    for (std::size_t start = 0; start < shape.size(); ++start)
      for (const double side : {1.0, -1.0}) {
        Points points = shape;
        std::rotate(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(start), points.end());
        if (side < 0) std::reverse(points.begin(), points.end());
        PolygonCutter cutter;
        const Triangles triangles = cutter.cut(points);
        EXPECT_EQ(triangles.size(), points.size() - 2);
        const auto [sum, least] = areas(points, triangles, side);
        EXPECT_NEAR(sum, area, 1e-12) << start;
        EXPECT_GE(least, 0) << area << " from " << start;
      }
}

TEST(Polygons, FansStayWhereTheyDo) {
  const Triangles fan = {{0, 1, 2}, {0, 2, 3}};
  const Points warped = {{0, 0, 0}, {1, 0, 0.2f}, {1, 1, 0}, {0, 1, 0.2f}};
  const Points seen_by_the_first = {{0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {0, 4, 0}};
  const Points in_a_line = {{0, 0, 0}, {0.1f, 0, 0}, {0.7f, 0, 0}, {0, 1, 0}};
  for (const Points& points : {warped, seen_by_the_first, in_a_line}) {
    PolygonCutter cutter;
    EXPECT_EQ(cutter.cut(points), fan);
  }
  PolygonCutter cutter;
  const Points from_its_side = {{4, 0, 0}, {1, 1, 0}, {0, 4, 0}, {0, 0, 0}};
  EXPECT_EQ(cutter.cut(from_its_side), (Triangles{{1, 2, 3}, {0, 1, 3}}));
}

TEST(Polygons, WhatCrossesItselfIsAFanWithAWarning) {
  const TemporaryFolder folder;
  Messages messages;
  const std::string bow = "v 0 0 0\nv 3 3 0\nv 3 0 0\nv 0 2 0\nf 1 2 3 4\n";
  EXPECT_EQ(read_obj(folder.write("a.obj", bow), {}, messages.lines(folder)).triangles,
            (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(messages.texts,
            std::vector<std::string>{"a.obj: warning: 1 face is no simple polygon: cut into a "
                                     "fan, whose triangles overlap"});
}

/// With every second corner a little further out.
Points star(int corners) {
  Points points;
  for (int i = 1; i <= corners; ++i) {
    const double angle = 2 * 3.14159265358979 * i / corners, radius = i % 2 ? 1 : 1.001;
    points.push_back({float(radius * std::cos(angle)), float(radius * std::sin(angle)), 0});
  }
  return points;
}

/// What is too much is not called crossed.
TEST(Polygons, LargeOnesTakeNoLongTime) {
  const std::clock_t start = std::clock();
  PolygonCutter cutter;
  EXPECT_EQ(cutter.cut(star(40000)).size(), 39998u);
  EXPECT_LT(cpu_seconds_since(start), 10);
  Messages messages;
  cutter.report({"a.obj", ""}, messages.sink());
  EXPECT_EQ(messages.texts,
            std::vector<std::string>{
                "1 concave face is cut into a fan, whose triangles overlap: the file has too many "
                "corners of such faces to cut them by ears"});
}

TEST(Polygons, OfObjAndPly) {
  const TemporaryFolder folder;
  std::string corners;
  for (const Vec3f& p : kL) corners += std::to_string(p[0]) + " " + std::to_string(p[1]) + " 0\n";
  std::string obj = "v " + corners;
  for (std::size_t at = 0; (at = obj.find('\n', at)) + 1 < obj.size(); at += 3) obj.insert(at + 1, "v ");
  const auto file = folder.write("l.obj", obj + "f 6 1 2 3 4 5\n");
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const auto ply = folder.write("l.ply", header + corners + "6 5 0 1 2 3 4\n");
  for (const Mesh& mesh : {read_obj(file, {}), read_ply(ply, {})}) {
    ASSERT_EQ(mesh.triangles.size(), 4u);
    const auto [sum, least] = areas(mesh.positions, mesh.triangles, 1);
    EXPECT_NEAR(sum, 3, 1e-12);
    EXPECT_GE(least, 0);
  }
}

}  // namespace polygons
}  // namespace kiloband::test
