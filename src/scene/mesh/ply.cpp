// The body of a PLY file: vertices and faces, whatever else is skipped.
#include "scene/mesh/finish.hpp"
#include "scene/mesh/ply_source.hpp"

namespace kiloband {
namespace {

/// Where a vertex property goes: target[row * stride], or nowhere.
struct Slot {
  float* target = nullptr;
  size_t stride = 0;
};

/// Triangle strips, as the scans of Stanford's repository have them.
constexpr std::string_view kStrips = "tristrips";

std::string_view index_list(const PlyElement& element) {
  return element.find("vertex_indices") >= 0 ? "vertex_indices" : "vertex_index";
}

/// Reads the elements in the file's order. Source is PlyTextSource or PlyBinarySource.
template <typename Source>
class BodyReader {
 public:
  BodyReader(const PlyHeader& header, Source source, Mesh& mesh)
      : header_(header), source_(source), mesh_(mesh) {}

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
  for (row_ = 0; row_ < element_->count; ++row_) {
    for (size_t i = 0; i < slots.size(); ++i) {
      property_ = &element_->properties[i];
      if (slots[i]) {
        numbers[i] = read_number();
      } else if (property_->name != list) {
        skip_property();
      } else if (element_->name == kStrips) {
        read_strips();
      } else {
        read_polygon();
      }
    }
    for (size_t i = 0; i < slots.size(); ++i)
      if (slots[i]) slots[i]->resize(mesh_.triangles.size(), numbers[i]);
  }
}

template <typename Source>
void BodyReader<Source>::read_polygon() {
  const uint64_t count = read_list_count();
  if (count < 3) fail(std::to_string(count) + " corners, must be at least 3");
  const uint32_t first = read_index();
  uint32_t last = read_index();
  for (uint64_t i = 2; i < count; ++i) {
    const uint32_t next = read_index();
    mesh_.triangles.push_back({first, last, next});
    last = next;
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
}

}  // namespace

Mesh read_ply(const std::filesystem::path& path, const MeshOptions& options, const DiagnosticSink& sink) {
  const MeshFile file = load_mesh_file(path);
  const PlyHeader header = read_ply_header(file);
  check_elements(header, file);
  note_skipped(header, file, sink);
  Mesh mesh;
  if (header.format == PlyFormat::kAscii) {
    BodyReader(header, PlyTextSource(file, header), mesh).read();
  } else {
    BodyReader(header, PlyBinarySource(file, header), mesh).read();
  }
  if (options.flip_tex_coords) {
    for (Vec2f& uv : mesh.uvs) uv[1] = 1.0f - uv[1];
  }
  finish_mesh(mesh, file, options, sink);
  return mesh;
}

}  // namespace kiloband
