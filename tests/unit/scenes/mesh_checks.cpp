#include "tests/unit/scenes/mesh_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace kiloband::test {

using generator::Mesh;
using generator::Vec3;

namespace {

bool is_finite(Vec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Vec3 area_normal(const Mesh& mesh, const std::array<uint32_t, 3>& t) {
  const Vec3 p = mesh.positions[t[0]];
  return cross(mesh.positions[t[1]] - p, mesh.positions[t[2]] - p);
}

std::vector<uint32_t> joined(const Mesh& mesh) {
  std::map<std::array<double, 3>, uint32_t> known;
  std::vector<uint32_t> ids;
  for (const Vec3& p : mesh.positions) {
    ids.push_back(known.try_emplace({p.x, p.y, p.z}, static_cast<uint32_t>(known.size())).first->second);
  }
  return ids;
}

}  // namespace

std::map<std::pair<uint32_t, uint32_t>, EdgeUse> edge_uses(const Mesh& mesh) {
  const std::vector<uint32_t> ids = joined(mesh);
  std::map<std::pair<uint32_t, uint32_t>, EdgeUse> uses;
  for (const auto& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) {
      const uint32_t a = ids[t[c]], b = ids[t[(c + 1) % 3]];
      EdgeUse& use = uses[std::minmax(a, b)];
      ++(a < b ? use.forward : use.backward);
    }
  }
  return uses;
}

bool is_closed(const Mesh& mesh) {
  const auto uses = edge_uses(mesh);
  return std::all_of(uses.begin(), uses.end(),
                     [](const auto& e) { return e.second.forward == e.second.backward; });
}

bool is_manifold(const Mesh& mesh) {
  const auto uses = edge_uses(mesh);
  return std::all_of(uses.begin(), uses.end(),
                     [](const auto& e) { return e.second.forward == 1 && e.second.backward == 1; });
}

bool is_oriented(const Mesh& mesh) {
  const auto uses = edge_uses(mesh);
  return std::all_of(uses.begin(), uses.end(),
                     [](const auto& e) { return std::abs(e.second.forward - e.second.backward) <= 1; });
}

std::string fault_of(const Mesh& mesh) {
  const std::size_t count = mesh.positions.size();
  if (mesh.normals.size() != count) return "normals do not match positions";
  if (!mesh.uvs.empty() && mesh.uvs.size() != count) return "uvs do not match positions";
  for (const Vec3& p : mesh.positions) {
    if (!is_finite(p)) return "a position is not finite";
  }
  for (const Vec3& n : mesh.normals) {
    if (!is_finite(n) || std::fabs(length(n) - 1) > 1e-6) return "a normal is not of unit length";
  }
  for (const auto& uv : mesh.uvs) {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return "a uv is not finite";
  }
  for (const auto& t : mesh.triangles) {
    if (std::max({t[0], t[1], t[2]}) >= count) return "an index is out of range";
    if (!(length(area_normal(mesh, t)) > 0)) return "a triangle has no area";
  }
  return mesh.triangles.empty() ? "no triangles" : "";
}

double share_of_turned_normals(const Mesh& mesh) {
  std::size_t turned = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 front = area_normal(mesh, t);
    for (const uint32_t v : t) turned += dot(front, mesh.normals[v]) < 0;
  }
  return static_cast<double>(turned) / (3.0 * static_cast<double>(mesh.triangles.size()));
}

namespace {
/// Parts that are surfaces without an inside.
const std::set<std::string> kOpen{
    "floor",         "display",     "outside",      "luminaires", "laptop_screens", "paper",       "blinds",
    "leaves",        "coffee",      "soil",         "meadow",     "skin",           "compressor",  "turbine",
    "leading_edges", "intake_lips", "intake_ducts", "nozzle_lip", "nozzle_rear",    "nozzle_front"};
}  // namespace

std::size_t check_parts(const generator::Scene& scene) {
  std::size_t triangles = 0;
  for (const auto& [name, part] : scene.parts) {
    SCOPED_TRACE(scene.name + "/" + name);
    const generator::Mesh mesh = in_single_precision(part);
    EXPECT_EQ(fault_of(mesh), "");
    EXPECT_LT(share_of_turned_normals(mesh), 1e-3);
    if (kOpen.contains(name)) {
      EXPECT_TRUE(is_oriented(mesh));
      EXPECT_FALSE(is_closed(mesh)) << "belongs to the closed ones";
    } else {
      EXPECT_TRUE(is_closed(mesh));
      EXPECT_GT(signed_volume6(mesh), 0);
    }
    triangles += mesh.triangles.size();
  }
  return triangles;
}

}  // namespace kiloband::test
