// STL, text and binary.
#include <cmath>

#include "scene/mesh/binary.hpp"
#include "scene/mesh/finish.hpp"
#include "scene/mesh/text.hpp"

namespace kiloband {
namespace {

// Binary layout: 80 bytes of anything, u32 count, then per triangle 12 floats (normal, 3 corners) and 2
// bytes; little endian.
constexpr size_t kPreambleBytes = 84;
constexpr size_t kTriangleBytes = 50;
constexpr size_t kNormalBytes = 12;

bool starts_with_solid(const MeshFile& file) {
  const std::string_view bytes = file.bytes;
  // Many binary files begin with "solid" too, but a text holds no zero byte.
  return bytes.substr(0, 5) == "solid" &&
         bytes.substr(0, kPreambleBytes).find('\0') == std::string_view::npos;
}

uint64_t stated_count(const MeshFile& file) {
  return load_number<uint32_t>(file.bytes.data() + kPreambleBytes - 4);
}

/// The only sure sign of a binary file is its size.
bool is_binary(const MeshFile& file) {
  return file.bytes.size() >= kPreambleBytes &&
         file.bytes.size() == kPreambleBytes + kTriangleBytes * stated_count(file);
}

[[noreturn]] void fail_size(const MeshFile& file) {
  const std::string size = std::to_string(file.bytes.size()) + " bytes";
  if (file.bytes.size() < kPreambleBytes)
    file.fail("not an STL file: neither 'solid' nor 84 bytes long, but " + size);
  const uint64_t count = stated_count(file);
  file.fail_byte(kPreambleBytes - 4, std::to_string(count) + " triangles need a file of " +
                                         std::to_string(kPreambleBytes + kTriangleBytes * count) +
                                         " bytes, not of " + size);
}

void add_triangle(Mesh& mesh, const std::array<Vec3f, 3>& corners) {
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
  mesh.triangles.push_back({first, first + 1, first + 2});
}

void check_vertex_count(const MeshFile& file, uint64_t triangles) {
  if (triangles > UINT32_MAX / 3) file.fail("more than 4294967295 vertices");
}

Mesh read_binary(const MeshFile& file) {
  Mesh mesh;
  const uint64_t count = stated_count(file);
  check_vertex_count(file, count);
  mesh.positions.reserve(3 * count);
  mesh.triangles.reserve(count);
  for (uint64_t triangle = 0; triangle < count; ++triangle) {
    std::array<Vec3f, 3> corners{};
    for (size_t i = 0; i < 9; ++i) {
      const size_t offset = kPreambleBytes + kTriangleBytes * triangle + kNormalBytes + sizeof(float) * i;
      const auto value = load_number<float>(file.bytes.data() + offset);
      if (!std::isfinite(value))
        file.fail_byte(offset, "triangle " + std::to_string(triangle) + ": coordinate is not finite");
      corners[i / 3][i % 3] = value;
    }
    add_triangle(mesh, corners);
  }
  return mesh;
}

/// solid [name] { facet normal x y z outer loop 3 times { vertex x y z } endloop endfacet } endsolid [name]
/// Any number of solids. Keywords in any case; names run to the end of their line.
class TextReader {
 public:
  explicit TextReader(const MeshFile& file) : file_(file), rest_(file.bytes) {}

  Mesh read() {
    while (next_line()) {
      expect("solid");
      while (read_facet()) check_vertex_count(file_, mesh_.triangles.size() + 1);
    }
    return std::move(mesh_);
  }

 private:
  /// Goes to the next line that is not blank.
  /// returns false at the end of the file
  bool next_line() {
    while (!rest_.empty()) {
      ++line_;
      tokens_ = LineTokens(take_line(rest_));
      LineTokens ahead = tokens_;
      if (!ahead.next().empty()) return true;
    }
    return false;
  }

  void expect(const char* keyword) {
    const std::string_view token = tokens_.next();
    if (lowered(token) != keyword)
      file_.fail_line(line_, "expected '" + std::string(keyword) + "', found " + quote_text(token));
  }

  void expect_line(std::initializer_list<const char*> keywords) {
    if (!next_line()) file_.fail_line(line_, "the file ends before '" + std::string(*keywords.begin()) + "'");
    for (const char* keyword : keywords) expect(keyword);
  }

  void end_line() {
    if (const auto extra = tokens_.next(); !extra.empty())
      file_.fail_line(line_, "unexpected " + quote_text(extra));
  }

  /// returns false at endsolid
  bool read_facet() {
    if (!next_line()) file_.fail_line(line_, "the file ends before 'endsolid'");
    LineTokens ahead = tokens_;
    if (lowered(ahead.next()) == "endsolid") return false;
    expect("facet");
    expect_line({"outer", "loop"});
    std::array<Vec3f, 3> corners{};
    for (Vec3f& corner : corners) corner = read_vertex();
    expect_line({"endloop"});
    end_line();
    expect_line({"endfacet"});
    end_line();
    add_triangle(mesh_, corners);
    return true;
  }

  Vec3f read_vertex() {
    expect_line({"vertex"});
    Vec3f position{};
    for (float& value : position) {
      const std::string_view token = tokens_.next();
      if (token.empty()) file_.fail_line(line_, "vertex: must have 3 numbers");
      if (const char* problem = parse_number(token, value))
        file_.fail_line(line_, "vertex: " + quote_text(token) + " " + problem);
    }
    end_line();
    return position;
  }

  const MeshFile& file_;
  std::string_view rest_;
  size_t line_ = 0;
  LineTokens tokens_{""};
  Mesh mesh_;
};

}  // namespace

Mesh read_stl(const std::filesystem::path& path, const MeshOptions&, const DiagnosticSink& sink) {
  const MeshFile file = load_mesh_file(path);
  if (!is_binary(file) && !starts_with_solid(file)) fail_size(file);
  Mesh mesh = is_binary(file) ? read_binary(file) : TextReader(file).read();
  MeshOptions facets;
  facets.face_normals = true;
  finish_mesh(mesh, file, facets, sink);
  return mesh;
}

}  // namespace kiloband
