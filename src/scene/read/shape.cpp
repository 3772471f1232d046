// <shape type=...>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "scene/read/context.hpp"
#include "scene/read/primitives.hpp"
#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

using Geometry = decltype(Shape::geometry);
using MeshReader = Mesh (*)(const std::filesystem::path&, const MeshOptions&, const DiagnosticSink&);

/// Adds a transform that acts before the shape's own.
void fold(Shape& shape, const Transform& inner) {
  shape.to_world = shape.to_world * inner;
}

Transform column_transform(const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z,
                           const glm::dvec3& origin) {
  return {glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(z, 0), glm::dvec4(origin, 1)};
}

bool perpendicular(const glm::dvec3& a, const glm::dvec3& b) {
  return std::abs(glm::dot(a, b)) <= 1e-4 * glm::length(a) * glm::length(b);
}

double read_radius(const ObjectReader& object) {
  const double radius = object.get_float("radius", 1);
  object.check(radius > 0, "radius", radius, "must be > 0");
  return radius;
}

Geometry read_sphere(ReadContext&, const ObjectReader& object, Shape& shape) {
  const glm::dvec3 centre = object.get_vector("center", {0, 0, 0});
  const double r = read_radius(object);
  if (!is_similarity(glm::dmat3(shape.to_world))) {
    object.fail_at("to_world", "to_world must not scale a sphere differently along its axes");
  }
  fold(shape, column_transform({r, 0, 0}, {0, r, 0}, {0, 0, r}, centre));
  return SphereShape{};
}

/// The scale along z does not matter to a disk; it is made that of x so that the transform is a similarity.
Geometry read_disk(ReadContext&, const ObjectReader& object, Shape& shape) {
  const glm::dvec3 x(shape.to_world[0]), y(shape.to_world[1]), z(shape.to_world[2]);
  const glm::dvec3 normal = glm::normalize(z) * glm::length(x);
  if (!is_similarity(glm::dmat3(x, y, normal))) {
    object.fail_at("to_world", "to_world must keep a disk circular and its axis perpendicular");
  }
  shape.to_world[2] = glm::dvec4(normal, 0);
  return DiskShape{};
}

/// Any right circular cylinder: x and y of equal length, all axes perpendicular.
Geometry read_cylinder(ReadContext&, const ObjectReader& object, Shape& shape) {
  const glm::dvec3 p0 = object.get_vector("p0", {0, 0, 0});
  const glm::dvec3 p1 = object.get_vector("p1", {0, 0, 1});
  const double r = read_radius(object);
  const glm::dvec3 axis = p1 - p0;
  if (!(glm::length(axis) > 0)) object.fail_at("p1", "p0 and p1 are equal");
  const glm::dvec3 unit = glm::normalize(axis);
  const glm::dvec3 helper = std::abs(unit.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  // For the default axis +Z the frame is the identity: x = y cross z.
  const glm::dvec3 x = glm::normalize(helper - unit * glm::dot(helper, unit));
  fold(shape, column_transform(r * x, r * glm::cross(unit, x), axis, p0));
  const glm::dvec3 wx(shape.to_world[0]), wy(shape.to_world[1]), wz(shape.to_world[2]);
  const double difference = std::abs(glm::length(wx) - glm::length(wy));
  if (difference > 1e-4 * glm::length(wx) || !perpendicular(wx, wy) || !perpendicular(wx, wz) ||
      !perpendicular(wy, wz)) {
    object.fail_at("to_world", "to_world must keep a cylinder circular and its axis perpendicular");
  }
  return CylinderShape{};
}

Geometry read_rectangle(ReadContext&, const ObjectReader&, Shape&) {
  static const auto kMesh = std::make_shared<const Mesh>(make_rectangle());
  return MeshShape{kMesh};
}

Geometry read_cube(ReadContext&, const ObjectReader&, Shape&) {
  static const auto kMesh = std::make_shared<const Mesh>(make_cube());
  return MeshShape{kMesh};
}

/// A mesh file; the same file with the same options is read once.
Geometry read_mesh(ReadContext& context, const ObjectReader& object, MeshReader reader, MeshOptions options) {
  const std::filesystem::path file = context.file(object, "filename");
  const std::string key = object.type() + (options.face_normals ? " f" : " s") +
                          (options.flip_tex_coords ? "f " : "n ") + std::to_string(options.shape_index) +
                          " " + (options.max_smooth_angle ? format_number(*options.max_smooth_angle) : "-") +
                          " " + file.string();
  auto& mesh = context.meshes[key];
  if (!mesh) {
    mesh = load_at(object.value_place("filename"),
                   [&] { return std::make_shared<const Mesh>(reader(file, options, context.sink)); });
  }
  return MeshShape{mesh};
}

MeshOptions mesh_options(const ObjectReader& object, bool flip_by_default) {
  MeshOptions options;
  options.face_normals = object.get_bool("face_normals", false);
  options.flip_tex_coords = object.get_bool("flip_tex_coords", flip_by_default);
  if (!object.has("max_smooth_angle")) return options;
  const double degrees = object.get_float("max_smooth_angle", 180);
  object.check(degrees >= 0 && degrees <= 180, "max_smooth_angle", degrees, "must be from 0 to 180 degrees");
  if (options.face_normals) object.fail_at("max_smooth_angle", "max_smooth_angle together with face_normals");
  options.max_smooth_angle = glm::radians(degrees);
  return options;
}

Geometry read_obj_shape(ReadContext& context, const ObjectReader& object, Shape&) {
  return read_mesh(context, object, read_obj, mesh_options(object, true));
}
Geometry read_ply_shape(ReadContext& context, const ObjectReader& object, Shape&) {
  return read_mesh(context, object, read_ply, mesh_options(object, false));
}
/// Facets only: neither smooth normals nor texture coordinates.
Geometry read_stl_shape(ReadContext& context, const ObjectReader& object, Shape&) {
  return read_mesh(context, object, read_stl, {});
}
Geometry read_serialized_shape(ReadContext& context, const ObjectReader& object, Shape&) {
  MeshOptions options = mesh_options(object, false);
  const int64_t index = object.get_int("shape_index", 0);
  object.check(index >= 0 && index <= std::numeric_limits<int>::max(), "shape_index",
               static_cast<double>(index), "must be >= 0");
  options.shape_index = static_cast<int>(index);
  return read_mesh(context, object, read_serialized, options);
}

struct ShapeType {
  std::string_view name;
  Geometry (*read)(ReadContext&, const ObjectReader&, Shape&);
};

constexpr ShapeType kShapeTypes[] = {{"obj", read_obj_shape},       {"ply", read_ply_shape},
                                     {"stl", read_stl_shape},       {"serialized", read_serialized_shape},
                                     {"rectangle", read_rectangle}, {"cube", read_cube},
                                     {"disk", read_disk},           {"sphere", read_sphere},
                                     {"cylinder", read_cylinder}};

const ShapeType& find_type(const ObjectReader& object) {
  std::vector<std::string_view> names;
  for (const ShapeType& type : kShapeTypes) {
    if (object.type() == type.name) return type;
    names.push_back(type.name);
  }
  object.refuse_type(names);
}

/// Diffuse 0.5, or black for emitters.
std::shared_ptr<const Bsdf> default_bsdf(const Shape& shape) {
  return std::make_shared<const Bsdf>(
      Bsdf{"", shape.position, DiffuseBsdf{Spectrum::constant(shape.emitter || shape.thermal ? 0.0 : 0.5)}});
}

bool lets_light_in(const Bsdf& bsdf) {
  const auto* blend = std::get_if<BlendBsdf>(&bsdf.model);
  if (blend) return lets_light_in(*blend->first) || lets_light_in(*blend->second);
  if (const auto* bumped = std::get_if<BumpedBsdf>(&bsdf.model)) return lets_light_in(*bumped->nested);
  if (const auto* principled = std::get_if<PrincipledBsdf>(&bsdf.model)) return passes_light(*principled);
  return std::holds_alternative<NullBsdf>(bsdf.model) || std::holds_alternative<DielectricBsdf>(bsdf.model) ||
         std::holds_alternative<MaskBsdf>(bsdf.model);
}

/// Gas is told apart by the winding, glass by vertex normals: where these differ,
/// the two have different insides.
void warn_of_opposed_normals(ReadContext& context, const ObjectReader& object, const Shape& shape) {
  const auto* mesh = std::get_if<MeshShape>(&shape.geometry);
  if (!mesh || !shape.interior || std::holds_alternative<NullBsdf>(shape.bsdf->model)) return;
  const std::size_t opposed = count_opposed_triangles(*mesh->mesh);
  if (opposed == 0) return;
  warn(context.sink, shape.position,
       object.label() + ": the vertex normals of " + std::to_string(opposed) + " of " +
           std::to_string(mesh->mesh->triangles.size()) +
           " triangles point against their winding: the winding says where its interior medium is, the "
           "normals say what is inside for its bsdf");
}

/// Textures that lie on the surface by its texture coordinates, in a shape's materials and lamps.
void collect_pictures(Node& node, std::set<const Node*>& seen, std::vector<const Node*>& pictures) {
  constexpr std::array<std::string_view, 3> kPictures = {"bitmap", "checkerboard", "spectral_bitmap"};
  for (const auto& child : node.children) {
    Node& object = child->resolved();
    if (object.kind != TagKind::kObject || object.tag == "medium" || !seen.insert(&object).second) continue;
    if (std::ranges::find(kPictures, object.type) != kPictures.end()) pictures.push_back(&object);
    collect_pictures(object, seen, pictures);
  }
}

void warn_of_missing_uvs(ReadContext& context, const ObjectReader& object, const Shape& shape, Node& node) {
  const auto* mesh = std::get_if<MeshShape>(&shape.geometry);
  if (!mesh || !mesh->mesh->uvs.empty()) return;
  std::set<const Node*> seen;
  std::vector<const Node*> pictures;
  collect_pictures(node, seen, pictures);
  for (const Node* picture : pictures)
    if (context.without_uvs.insert(picture).second)
      warn(context.sink, shape.position,
           object.label() + ": a " + picture->type +
               " on a mesh without texture coordinates: every triangle shows the same half of it");
}

}  // namespace

Shape read_shape(ReadContext& context, Node& node) {
  const ObjectReader object(node);
  const ShapeType& type = find_type(object);
  Shape shape;
  shape.id = node.id;
  shape.position = node.place.position();
  shape.to_world = object.get_transform("to_world");
  shape.flip_normals = object.get_bool("flip_normals", false);
  object.get_float("silhouette_sampling_weight", 1);  // of Mitsuba's derivatives
  shape.geometry = type.read(context, object, shape);
  if (Node* emitter = object.nested_one("emitter")) {
    shape.emitter_position = emitter->place.position();
    if (emitter->type == "thermal") {
      shape.thermal = read_thermal_emitter(context, *emitter);
      check_temperatures(context, shape, object.label(), emitter->place);
    } else {
      shape.emitter = read_area_emitter(context, *emitter);
    }
  }
  Node* bsdf = object.nested_one("bsdf");
  shape.bsdf = bsdf ? read_bsdf(context, *bsdf) : default_bsdf(shape);
  const bool boundary = std::holds_alternative<NullBsdf>(shape.bsdf->model);
  if (boundary && (shape.emitter || shape.thermal)) object.fail_here("a shape with a null bsdf cannot emit");
  shape.interior = read_interior(context, object);
  if (shape.interior && !lets_light_in(*shape.bsdf)) {
    warn(context.sink, shape.position,
         object.label() + ": its bsdf is opaque, so that its interior medium has no effect");
  }
  warn_of_opposed_normals(context, object, shape);
  warn_of_missing_uvs(context, object, shape, node);
  for (Node* sensor : object.nested("sensor"))
    if (sensor->type == "irradiancemeter") ObjectReader(*sensor).refuse_type({});
  object.finish();
  return shape;
}

bool is_similarity(const glm::dmat3& m) {
  const double x = glm::length(m[0]), y = glm::length(m[1]), z = glm::length(m[2]);
  constexpr double kTolerance = 1e-4;
  return std::abs(x - y) <= kTolerance * x && std::abs(x - z) <= kTolerance * x &&
         perpendicular(m[0], m[1]) && perpendicular(m[0], m[2]) && perpendicular(m[1], m[2]);
}

}  // namespace kiloband
