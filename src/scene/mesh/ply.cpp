// The body of a PLY file: vertices and faces, whatever else is skipped.
#include <algorithm>

#include "scene/mesh/corner_uvs.hpp"
#include "scene/mesh/finish.hpp"
#include "scene/mesh/ply_source.hpp"
#include "scene/mesh/polygon.hpp"

namespace kiloband {
namespace {

/// Where a vertex property goes: target[row * stride], or nowhere.
struct Slot {
  float* target = nullptr;
  size_t stride = 0;
};

/// Triangle strips, as the scans of Stanford's repository have them.
constexpr std::string_view kStrips = "tristrips";

/// Texture coordinates of a face's corners, u v u v ..., as MeshLab writes them.
constexpr std::string_view kCornerUvs = "texcoord";

bool has_corner_uvs(const PlyElement& element) {
  const int i = element.find(std::string(kCornerUvs));
  return element.name == "face" && i >= 0 && element.properties[i].is_list;
}

/// What the body says of texture coordinates of corners, and of cut faces.
struct PlyFaces {
  std::vector<CornerUvs> uvs;  // by triangle; empty where the file has none
  uint64_t without_uvs = 0;    // faces among others
  PolygonCutter cutter;
};

std::string_view index_list(const PlyElement& element) {
  return element.find("vertex_indices") >= 0 ? "vertex_indices" : "vertex_index";
}

/// Reads the elements in the file's order. Source is PlyTextSource or PlyBinarySource.
template <typename Source>
class BodyReader {
 public:
  BodyReader(const PlyHeader& header, Source source, Mesh& mesh, PlyFaces& faces)
      : header_(header), source_(source), mesh_(mesh), faces_(faces) {}

  void read() {
    for (const PlyElement& element : header_.elements) {
      element_ = &element;
      if (element.properties.empty() || element.count == 0) continue;
      if (element.name == "vertex") {
        read_vertices(vertex_slots());
      } else if (element.name == "face" || element.name == kStrips) {
        read_faces();
      } else {
        for (row_ = 0; row_ < element.count; ++row_) skip_row();
      }
    }
    source_.finish();
    const PlyElement* strips = header_.find(std::string(kStrips));
    if (strips && strips->count > 0) mesh_.face_attributes.clear();  // their triangles have none
  }

 private:
  std::vector<Slot> vertex_slots();
  void bind(std::vector<Slot>& slots, std::initializer_list<const char*> names, float* first);
  void read_vertices(const std::vector<Slot>& slots);
  float read_number();
  std::vector<std::vector<float>*> face_slots();
  void read_faces();
  void read_polygon();
  void read_corner_uvs();
  void add_polygon();
  void read_strips();
  uint32_t read_index();
  uint32_t checked_index(double index) const;
  void skip_row();
  void skip_property();
  double read(PlyType type);
  uint64_t read_list_count();
  /// "vertex 7: property 'x': message", with the position in front
  [[noreturn]] void fail(const std::string& message) const {
    source_.fail(element_->name + " " + std::to_string(row_) + ": property " + quote_text(property_->name) +
                 ": " + message);
  }

  const PlyHeader& header_;
  Source source_;
  Mesh& mesh_;
  PlyFaces& faces_;
  bool with_uvs_ = false;          // the faces have texture coordinates
  std::vector<uint32_t> corners_;  // of the face that is being read, as the next two
  std::vector<Vec3f> points_;
  std::vector<float> corner_uvs_;
  const PlyElement* element_ = nullptr;  // being read, as the next two
  uint64_t row_ = 0;
  const PlyProperty* property_ = nullptr;
};

template <typename Source>
std::vector<Slot> BodyReader<Source>::vertex_slots() {
  const size_t count = element_->count;
  std::vector<Slot> slots(element_->properties.size());
  mesh_.positions.resize(count);
  bind(slots, {"x", "y", "z"}, mesh_.positions.data()->data());
  const auto has = [this](const char* name) {
    const int i = element_->find(name);
    return i >= 0 && !element_->properties[i].is_list;
  };
  if (has("nx") && has("ny") && has("nz")) {
    mesh_.normals.resize(count);
    bind(slots, {"nx", "ny", "nz"}, mesh_.normals.data()->data());
  }
  for (const auto& [u, v] : {std::pair("u", "v"), std::pair("texture_u", "texture_v"), std::pair("s", "t")}) {
    if (!mesh_.uvs.empty() || !has(u) || !has(v)) continue;
    mesh_.uvs.resize(count);
    bind(slots, {u, v}, mesh_.uvs.data()->data());
  }
  for (size_t i = 0; i < slots.size(); ++i) {
    if (slots[i].target || element_->properties[i].is_list) continue;
    const PlyProperty& property = element_->properties[i];
    if (property.type == PlyType::kUint8) mesh_.byte_attributes.insert("vertex " + property.name);
    std::vector<float>& values = mesh_.vertex_attributes[property.name];
    values.resize(count);
    slots[i] = {values.data(), 1};
  }
  return slots;
}

template <typename Source>
void BodyReader<Source>::bind(std::vector<Slot>& slots, std::initializer_list<const char*> names,
                              float* first) {
  for (const char* name : names) slots[element_->find(name)] = {first++, names.size()};
}

template <typename Source>
void BodyReader<Source>::read_vertices(const std::vector<Slot>& slots) {
  for (row_ = 0; row_ < element_->count; ++row_) {
    for (size_t i = 0; i < slots.size(); ++i) {
      property_ = &element_->properties[i];
      if (!slots[i].target) {
        skip_property();
        continue;
      }
      slots[i].target[row_ * slots[i].stride] = read_number();
    }
  }
}

template <typename Source>
float BodyReader<Source>::read_number() {
  const double value = read(property_->type);
  const auto narrow = static_cast<float>(value);
  if (!std::isfinite(value)) fail("the value is not finite");
  if (!std::isfinite(narrow)) fail("the value is too large for a float");
  return narrow;
}

/// Where the numbers of faces go, by property; null for lists and those of strips.
template <typename Source>
std::vector<std::vector<float>*> BodyReader<Source>::face_slots() {
  std::vector<std::vector<float>*> slots;
  for (const PlyProperty& property : element_->properties) {
    const bool taken = !property.is_list && element_->name != kStrips;
    slots.push_back(taken ? &mesh_.face_attributes[property.name] : nullptr);
    if (taken) slots.back()->reserve(element_->count);
    if (taken && property.type == PlyType::kUint8) mesh_.byte_attributes.insert("face " + property.name);
  }
  return slots;
}

template <typename Source>
void BodyReader<Source>::read_faces() {
  const std::string_view list = index_list(*element_);
  mesh_.triangles.reserve(mesh_.triangles.size() + element_->count);
  const std::vector<std::vector<float>*> slots = face_slots();
  std::vector<float> numbers(slots.size());
  with_uvs_ = has_corner_uvs(*element_);
  for (row_ = 0; row_ < element_->count; ++row_) {
    for (size_t i = 0; i < slots.size(); ++i) {
      property_ = &element_->properties[i];
      if (slots[i]) {
        numbers[i] = read_number();
      } else if (property_->name == list) {
        element_->name == kStrips ? read_strips() : read_polygon();
      } else if (with_uvs_ && property_->name == kCornerUvs) {
        read_corner_uvs();
      } else {
        skip_property();
      }
    }
    if (element_->name != kStrips) add_polygon();
    for (size_t i = 0; i < slots.size(); ++i)
      if (slots[i]) slots[i]->resize(mesh_.triangles.size(), numbers[i]);
  }
}

template <typename Source>
void BodyReader<Source>::read_polygon() {
  const uint64_t count = read_list_count();
  if (count < 3) fail(std::to_string(count) + " corners, must be at least 3");
  corners_.clear();
  for (uint64_t i = 0; i < count; ++i) corners_.push_back(read_index());
}

template <typename Source>
void BodyReader<Source>::read_corner_uvs() {
  const uint64_t count = read_list_count();
  corner_uvs_.clear();
  for (uint64_t i = 0; i < count; ++i) corner_uvs_.push_back(read_number());
}

/// Cuts the face that has been read. Where faces stand before vertices, nothing but a fan is possible.
template <typename Source>
void BodyReader<Source>::add_polygon() {
  points_.assign(corners_.size(), {});
  for (size_t i = 0; i < corners_.size() && !mesh_.positions.empty(); ++i)
    points_[i] = mesh_.positions[corners_[i]];
  if (with_uvs_ && !corner_uvs_.empty() && corner_uvs_.size() != 2 * corners_.size()) {
    property_ = &element_->properties[element_->find(std::string(kCornerUvs))];
    fail(std::to_string(corner_uvs_.size()) + " numbers for " + std::to_string(corners_.size()) +
         " corners, must be two for each");
  }
  if (with_uvs_ && corner_uvs_.empty()) {
    ++faces_.without_uvs;
    corner_uvs_.resize(2 * corners_.size());
  }
  for (const auto& [a, b, c] : faces_.cutter.cut(points_)) {
    mesh_.triangles.push_back({corners_[a], corners_[b], corners_[c]});
    if (!with_uvs_) continue;
    CornerUvs& uvs = faces_.uvs.emplace_back();
    for (size_t k = 0; const uint32_t corner : {a, b, c})
      uvs[k++] = {corner_uvs_[2 * corner], corner_uvs_[2 * corner + 1]};
  }
}

/// A triangle for every three indices in a row, by turns in this order and with the first two exchanged, so that all have the
/// same side in front; -1 begins a new strip. Where two of the three are equal a strip only turns.
template <typename Source>
void BodyReader<Source>::read_strips() {
  const uint64_t count = read_list_count();
  uint64_t length = 0;  // of this strip so far
  uint32_t first = 0, second = 0;
  for (uint64_t i = 0; i < count; ++i) {
    const double index = read(property_->type);
    if (index == -1) {
      length = 0;
      continue;
    }
    const uint32_t third = checked_index(index);
    if (length >= 2 && first != second && second != third && first != third) {
      const bool exchanged = length % 2 == 1;
      mesh_.triangles.push_back({exchanged ? second : first, exchanged ? first : second, third});
    }
    first = second;
    second = third;
    ++length;
  }
}

template <typename Source>
uint32_t BodyReader<Source>::read_index() {
  return checked_index(read(property_->type));
}

template <typename Source>
uint32_t BodyReader<Source>::checked_index(double index) const {
  const auto count = static_cast<double>(header_.find("vertex")->count);
  if (!(index >= 0 && index < count)) {
    fail("index " + std::to_string(static_cast<int64_t>(index)) + ": must be below " +
         std::to_string(static_cast<int64_t>(count)) + ", the number of vertices");
  }
  return static_cast<uint32_t>(index);
}

template <typename Source>
void BodyReader<Source>::skip_row() {
  for (const PlyProperty& property : element_->properties) {
    property_ = &property;
    skip_property();
  }
}

template <typename Source>
void BodyReader<Source>::skip_property() {
  const uint64_t count = property_->is_list ? read_list_count() : 1;
  for (uint64_t i = 0; i < count; ++i) read(property_->type);
}

template <typename Source>
double BodyReader<Source>::read(PlyType type) {
  double value = 0;
  if (!source_.read(type, value)) fail(source_.problem());
  return value;
}

template <typename Source>
uint64_t BodyReader<Source>::read_list_count() {
  const double count = read(property_->count_type);
  if (count < 0) fail("list of " + std::to_string(static_cast<int64_t>(count)) + " items");
  return static_cast<uint64_t>(count);
}

void check_indices(const PlyElement& element, const MeshFile& file) {
  const int list = element.find(std::string(index_list(element)));
  if (list < 0)
    file.fail_line(element.line, "header: element " + quote_text(element.name) +
                                     " has no property 'vertex_indices' or 'vertex_index'");
  const PlyProperty& indices = element.properties[list];
  if (!indices.is_list || !is_integer(indices.type)) {
    file.fail_line(element.line,
                   "header: property " + quote_text(indices.name) + " must be a list of integers");
  }
}

/// What the body needs from the header before anything is allocated.
void check_elements(const PlyHeader& header, const MeshFile& file) {
  const PlyElement* vertex = header.find("vertex");
  const PlyElement* face = header.find("face");
  const PlyElement* strips = header.find(std::string(kStrips));
  if (!vertex) file.fail("header: no element 'vertex'");
  if (!face && !strips) file.fail("header: no element 'face'");
  for (const char* name : {"x", "y", "z"}) {
    const int i = vertex->find(name);
    if (i < 0) file.fail_line(vertex->line, "header: element 'vertex' has no property " + quote_text(name));
    if (vertex->properties[i].is_list)
      file.fail_line(vertex->line, "header: property " + quote_text(name) + " must not be a list");
  }
  if (vertex->count > UINT32_MAX) file.fail_line(vertex->line, "header: more than 4294967295 vertices");
  for (const PlyElement* element : {face, strips})
    if (element) check_indices(*element, file);
}

void note_skipped(const PlyHeader& header, const MeshFile& file, const DiagnosticSink& sink) {
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex" || element.name == "face" || element.name == kStrips) continue;
    note(sink, {file.name, static_cast<int>(element.line)},
         "element " + quote_text(element.name) + " is skipped");
  }
  for (const PlyElement& element : header.elements)
    for (const PlyProperty& property : element.properties) {
      const bool is_face = element.name == "face" || element.name == kStrips;
      const bool is_read = is_face && (property.name == index_list(element) || property.name == kCornerUvs);
      if (property.is_list && !is_read && (is_face || element.name == "vertex"))
        note(sink, {file.name, static_cast<int>(element.line)},
             "list " + quote_text(property.name) + " of element " + quote_text(element.name) + " is skipped");
    }
}

/// Corners of several pictures would be mixed without a word.
void report_corner_uvs(const Mesh& mesh, const PlyFaces& faces, const MeshFile& file,
                       const DiagnosticSink& sink) {
  if (faces.without_uvs > 0)
    warn(sink, {file.name},
         std::to_string(faces.without_uvs) + " faces have no texture coordinates: (0, 0) is used");
  const auto number = mesh.face_attributes.find("texnumber");
  if (number == mesh.face_attributes.end()) return;
  const auto others = std::ranges::count_if(number->second, [](float n) { return n > 0; });
  if (others > 0)
    warn(sink, {file.name},
         std::to_string(others) + " of " + std::to_string(mesh.triangles.size()) +
             " triangles have texture coordinates of a further picture (texnumber): read as those of one");
}

}  // namespace

Mesh read_ply(const std::filesystem::path& path, const MeshOptions& options, const DiagnosticSink& sink) {
  const MeshFile file = load_mesh_file(path);
  const PlyHeader header = read_ply_header(file);
  check_elements(header, file);
  note_skipped(header, file, sink);
  Mesh mesh;
  PlyFaces faces;
  if (header.format == PlyFormat::kAscii) {
    BodyReader(header, PlyTextSource(file, header), mesh, faces).read();
  } else {
    BodyReader(header, PlyBinarySource(file, header), mesh, faces).read();
  }
  faces.cutter.report(file, sink);
  finish_mesh(mesh, file, options, sink);
  // Behind the normals, which are smooth across the borders of a picture.
  if (faces.uvs.size() == mesh.triangles.size() && !faces.uvs.empty()) {
    report_corner_uvs(mesh, faces, file, sink);
    set_corner_uvs(mesh, faces.uvs);
  }
  if (options.flip_tex_coords) {
    for (Vec2f& uv : mesh.uvs) uv[1] = 1.0f - uv[1];
  }
  return mesh;
}

}  // namespace kiloband
