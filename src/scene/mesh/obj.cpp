// Wavefront OBJ: the subset that mesh.hpp states, in one pass over the lines.
#include <charconv>
#include <set>
#include <unordered_map>

#include "scene/mesh/finish.hpp"
#include "scene/mesh/polygon.hpp"
#include "scene/mesh/text.hpp"

namespace kiloband {
namespace {

/// Indices of one face corner, from 1; uv and normal are 0 where the corner has none.
struct Corner {
  uint32_t position = 0, uv = 0, normal = 0;
  bool operator==(const Corner&) const = default;
};

struct CornerHash {
  size_t operator()(const Corner& c) const {
    // Odd multipliers from the golden ratio; the final shift brings the high bits down to
    // where buckets are chosen.
    uint64_t hash = c.position * 0x9E3779B97F4A7C15ull;
    hash = (hash ^ (hash >> 29) ^ c.uv) * 0xBF58476D1CE4E5B9ull;
    hash = (hash ^ (hash >> 32) ^ c.normal) * 0x94D049BB133111EBull;
    return hash ^ (hash >> 31);
  }
};

class ObjReader {
 public:
  ObjReader(const MeshFile& file, const MeshOptions& options, const DiagnosticSink& sink)
      : file_(file), options_(options), sink_(sink) {}

  Mesh read();

 private:
  void read_line(std::string_view line);
  template <size_t N>
  std::array<float, N> numbers(LineTokens tokens, std::string_view keyword);
  void read_face(LineTokens tokens);
  Corner corner(std::string_view token);
  uint32_t index(std::string_view digits, std::string_view token, const char* what, size_t count);
  uint32_t vertex(const Corner& corner);
  Mesh assemble() const;
  void fill_uvs(Mesh& mesh) const;
  void fill_normals(Mesh& mesh) const;
  [[noreturn]] void fail(const std::string& message) const { file_.fail_line(line_, message); }

  const MeshFile& file_;
  const MeshOptions& options_;
  const DiagnosticSink& sink_;
  size_t line_ = 0;
  std::vector<Vec3f> positions_, normals_;
  std::vector<Vec2f> uvs_;
  std::vector<Corner> vertices_;  // distinct corners in order of first use
  std::unordered_map<Corner, uint32_t, CornerHash> vertex_of_;
  std::vector<std::array<uint32_t, 3>> triangles_;
  std::vector<uint32_t> ids_;  // of the face that is being read
  std::vector<Vec3f> points_;
  PolygonCutter cutter_;
  std::set<std::string, std::less<>> materials_;  // names of usemtl
};

Mesh ObjReader::read() {
  std::string_view rest = file_.bytes;
  while (!rest.empty()) {
    ++line_;
    read_line(take_line(rest));
  }
  cutter_.report(file_, sink_);
  if (materials_.size() > 1)
    note(sink_, {file_.name},
         std::to_string(materials_.size()) +
             " materials (usemtl) are ignored: the shape has one bsdf for all");
  Mesh mesh = assemble();
  finish_mesh(mesh, file_, options_, sink_);
  return mesh;
}

void ObjReader::read_line(std::string_view line) {
  LineTokens tokens(line.substr(0, line.find('#')));  // up to a comment
  const std::string_view keyword = tokens.next();
  if (keyword.empty()) return;
  if (keyword == "v") {
    positions_.push_back(numbers<3>(tokens, keyword));
  } else if (keyword == "vn") {
    normals_.push_back(numbers<3>(tokens, keyword));
  } else if (keyword == "vt") {
    uvs_.push_back(numbers<2>(tokens, keyword));
    if (options_.flip_tex_coords) uvs_.back()[1] = 1.0f - uvs_.back()[1];
  } else if (keyword == "f") {
    read_face(tokens);
  } else if (keyword == "usemtl") {
    materials_.emplace(tokens.next());
  } else {
    for (const char* ignored : {"mtllib", "g", "o", "s", "l", "p"}) {
      if (keyword == ignored) return;
    }
    fail("unknown keyword " + quote_text(keyword));
  }
}

/// The first N numbers of the line. Whatever follows must be numbers too, up to the 7 of a position with
/// weight and colour.
template <size_t N>
std::array<float, N> ObjReader::numbers(LineTokens tokens, std::string_view keyword) {
  std::array<float, N> result{};
  const size_t most = keyword == "v" ? 7 : 3;
  size_t count = 0;
  for (std::string_view token = tokens.next(); !token.empty(); token = tokens.next(), ++count) {
    float value = 0;
    if (const char* problem = parse_number(token, value))
      fail(std::string(keyword) + ": " + quote_text(token) + " " + problem);
    if (count == most) fail(std::string(keyword) + ": more than " + std::to_string(most) + " numbers");
    if (count < N) result[count] = value;
  }
  if (count < N) {
    fail(std::string(keyword) + ": " + std::to_string(count) + " numbers, must be at least " +
         std::to_string(N));
  }
  return result;
}

void ObjReader::read_face(LineTokens tokens) {
  ids_.clear();
  points_.clear();
  for (std::string_view token = tokens.next(); !token.empty(); token = tokens.next()) {
    ids_.push_back(vertex(corner(token)));
    points_.push_back(positions_[vertices_[ids_.back()].position - 1]);
  }
  if (ids_.size() < 3) fail("f: " + std::to_string(ids_.size()) + " corners, must be at least 3");
  for (const auto& [a, b, c] : cutter_.cut(points_)) triangles_.push_back({ids_[a], ids_[b], ids_[c]});
}

/// v, v/vt, v//vn or v/vt/vn; trailing slashes as in "1/1/" are written by some programs and mean nothing.
Corner ObjReader::corner(std::string_view token) {
  std::array<std::string_view, 3> parts{};
  size_t count = 0;
  for (std::string_view rest = token;; ++count) {
    const size_t slash = rest.find('/');
    if (count < 3) parts[count] = rest.substr(0, slash);
    if (slash == std::string_view::npos) break;
    rest.remove_prefix(slash + 1);
  }
  if (count > 2 || parts[0].empty())
    fail("f: corner " + quote_text(token) + ": must be v, v/vt, v//vn or v/vt/vn");
  Corner result;
  result.position = index(parts[0], token, "position", positions_.size());
  if (!parts[1].empty()) result.uv = index(parts[1], token, "texture coordinate", uvs_.size());
  if (!parts[2].empty()) result.normal = index(parts[2], token, "normal", normals_.size());
  return result;
}

/// count  lines of that kind so far; the index is in 1..count
uint32_t ObjReader::index(std::string_view digits, std::string_view token, const char* what, size_t count) {
  const std::string place = "f: corner " + quote_text(token) + ": ";
  if (digits[0] == '-')
    fail(place + "negative " + what + " index: relative indices are not supported, neither by Mitsuba");
  uint64_t value = 0;
  const char* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, value);
  if (error == std::errc::invalid_argument || stop != end)
    fail(place + quote_text(digits) + " is not an index");
  if (error != std::errc() || value == 0 || value > count || value > UINT32_MAX) {
    fail(place + what + " index " + std::string(digits.substr(0, 24)) + ": must be in 1.." +
         std::to_string(count) + ", the number of such lines above");
  }
  return static_cast<uint32_t>(value);
}

uint32_t ObjReader::vertex(const Corner& corner) {
  const auto [entry, is_new] = vertex_of_.try_emplace(corner, static_cast<uint32_t>(vertices_.size()));
  if (is_new && vertices_.size() == UINT32_MAX) fail("more than 4294967295 vertices");
  if (is_new) vertices_.push_back(corner);
  return entry->second;
}

Mesh ObjReader::assemble() const {
  Mesh mesh;
  mesh.triangles = triangles_;
  mesh.positions.reserve(vertices_.size());
  for (const Corner& corner : vertices_) mesh.positions.push_back(positions_[corner.position - 1]);
  fill_uvs(mesh);
  fill_normals(mesh);
  return mesh;
}

// Only what faces refer to counts: a file with unused vt or vn lines has no texture coordinates or normals.
void ObjReader::fill_uvs(Mesh& mesh) const {
  size_t missing = 0;
  for (const Corner& corner : vertices_) missing += corner.uv == 0;
  if (missing == vertices_.size()) return;
  if (missing > 0) {
    warn(sink_, {file_.name},
         std::to_string(missing) + " of " + std::to_string(vertices_.size()) +
             " vertices have no texture coordinates: (0, 0) is used");
  }
  for (const Corner& corner : vertices_) mesh.uvs.push_back(corner.uv > 0 ? uvs_[corner.uv - 1] : Vec2f{});
}

void ObjReader::fill_normals(Mesh& mesh) const {
  size_t missing = 0;
  for (const Corner& corner : vertices_) missing += corner.normal == 0;
  if (missing == vertices_.size()) return;
  // Zero stands for missing: finish_mesh computes those.
  for (const Corner& corner : vertices_)
    mesh.normals.push_back(corner.normal > 0 ? normals_[corner.normal - 1] : Vec3f{});
}

}  // namespace

Mesh read_obj(const std::filesystem::path& path, const MeshOptions& options, const DiagnosticSink& sink) {
  const MeshFile file = load_mesh_file(path);
  return ObjReader(file, options, sink).read();
}

}  // namespace kiloband
