// Mitsuba's serialized format, versions 3 and 4: several zlib-compressed meshes and a table of their places
// at the end. Layout: the documentation of Mitsuba 3's plugin `serialized`,
// checked against files written by Mitsuba.
#include <cmath>

#include "scene/mesh/binary.hpp"
#include "scene/mesh/finish.hpp"
#include "scene/mesh/inflate.hpp"

namespace kiloband {
namespace {

constexpr uint32_t kHasNormals = 0x0001, kHasUvs = 0x0002, kUnusedTangents = 0x0004, kHasColours = 0x0008,
                   kFaceNormals = 0x0010, kFloat = 0x1000, kDouble = 0x2000;
constexpr uint32_t kKnownFlags =
    kHasNormals | kHasUvs | kUnusedTangents | kHasColours | kFaceNormals | kFloat | kDouble;
constexpr size_t kMeshHeaderBytes = 4;  // u16 magic, u16 version, before the zlib stream
constexpr uint16_t kMagic = 0x041C;

/// Version of the mesh that begins at `offset`.
uint16_t read_version(const MeshFile& file, size_t offset) {
  const auto magic = load_number<uint16_t>(file.bytes.data() + offset);
  const auto version = load_number<uint16_t>(file.bytes.data() + offset + 2);
  if (magic != kMagic) file.fail_byte(offset, "not a Mitsuba serialized mesh: it must begin with 0x041C");
  if (version != 3 && version != 4)
    file.fail_byte(offset + 2, "version " + std::to_string(version) + ": must be 3 or 4");
  return version;
}

/// Compressed bytes of one mesh: [begin, end) of the file.
struct Span {
  size_t begin = 0, end = 0;
  uint16_t version = 0;
};

/// Looks the mesh up in the table at the end of the file: an offset per mesh (u32 in version 3, u64 in
/// version 4), u32 count.
Span find_mesh(const MeshFile& file, int shape_index) {
  const size_t size = file.bytes.size();
  if (size < kMeshHeaderBytes + sizeof(uint32_t))
    file.fail("too short for a serialized mesh: " + std::to_string(size) + " bytes");
  const size_t entry_bytes = read_version(file, 0) == 4 ? sizeof(uint64_t) : sizeof(uint32_t);
  const size_t count_at = size - sizeof(uint32_t);
  const uint64_t count = load_number<uint32_t>(file.bytes.data() + count_at);
  if (count == 0 || count > count_at / (entry_bytes + kMeshHeaderBytes)) {
    file.fail_byte(count_at, "table of " + std::to_string(count) +
                                 " meshes does not fit: the file is truncated or damaged");
  }
  if (shape_index < 0 || static_cast<uint64_t>(shape_index) >= count) {
    file.fail("shape_index " + std::to_string(shape_index) + ": must be in 0.." + std::to_string(count - 1));
  }
  const size_t table = count_at - count * entry_bytes;
  const auto entry = [&](uint64_t i) -> uint64_t {
    const char* bytes = file.bytes.data() + table + i * entry_bytes;
    return entry_bytes == 8 ? load_number<uint64_t>(bytes) : load_number<uint32_t>(bytes);
  };
  const auto index = static_cast<uint64_t>(shape_index);
  const uint64_t begin = entry(index), end = index + 1 < count ? entry(index + 1) : table;
  if (end > table || begin > end || end - begin <= kMeshHeaderBytes) {
    file.fail_byte(table + index * entry_bytes, "mesh " + std::to_string(index) + " cannot span bytes " +
                                                    std::to_string(begin) + ".." + std::to_string(end) +
                                                    ": the file is truncated or damaged");
  }
  return {begin + kMeshHeaderBytes, end, read_version(file, begin)};
}

class SerializedReader {
 public:
  SerializedReader(const MeshFile& file, const Span& span)
      : file_(file), version_(span.version), stream_(file, span.begin, span.end) {}

  Mesh read() {
    read_header();
    check_counts();
    Mesh mesh;
    mesh.positions = read_vectors<3>("position");
    if (flags_ & kHasNormals) mesh.normals = read_vectors<3>("normal");
    if (flags_ & kHasUvs) mesh.uvs = read_vectors<2>("texture coordinate");
    if (flags_ & kHasColours) read_vectors<3>("colour");
    read_triangles(mesh);
    stream_.expect_end();
    return mesh;
  }
  bool face_normals() const { return (flags_ & kFaceNormals) != 0; }

 private:
  template <typename T>
  T read_number() {
    std::array<char, sizeof(T)> bytes{};
    stream_.read(bytes.data(), bytes.size());
    return load_number<T>(bytes.data());
  }

  void read_header() {
    flags_ = read_number<uint32_t>();
    const bool one_precision = ((flags_ & kFloat) != 0) != ((flags_ & kDouble) != 0);
    if ((flags_ & ~kKnownFlags) || !one_precision) fail("bad mesh flags " + std::to_string(flags_));
    if (version_ == 4) skip_name();
    vertices_ = read_number<uint64_t>();
    triangles_ = read_number<uint64_t>();
  }

  void skip_name() {
    constexpr int kLongestName = 65536;
    for (int i = 0; read_number<char>() != '\0'; ++i) {
      if (i == kLongestName) fail("the mesh's name has more than 65536 bytes");
    }
  }

  /// Refuses counts that the compressed bytes cannot hold, before any allocation.
  void check_counts() {
    const size_t scalar = flags_ & kDouble ? 8 : 4;
    const size_t floats =
        3 + (flags_ & kHasNormals ? 3 : 0) + (flags_ & kHasUvs ? 2 : 0) + (flags_ & kHasColours ? 3 : 0);
    const size_t limit = stream_.limit();
    if (vertices_ > UINT32_MAX || vertices_ > limit / (scalar * floats) || triangles_ > limit / 12) {
      fail(std::to_string(vertices_) + " vertices and " + std::to_string(triangles_) +
           " triangles: more than the file can hold");
    }
  }

  template <size_t N>
  std::vector<std::array<float, N>> read_vectors(const char* what) {
    return flags_ & kDouble ? read_vectors_of<double, N>(what) : read_vectors_of<float, N>(what);
  }

  /// Grows with what was really decompressed: a stream that breaks off early has not cost
  /// the memory it promised.
  template <typename Scalar, size_t N>
  std::vector<std::array<float, N>> read_vectors_of(const char* what) {
    constexpr size_t kChunk = 65536;
    std::vector<std::array<float, N>> result;
    std::vector<std::array<char, sizeof(Scalar) * N>> raw;
    while (result.size() < vertices_) {
      raw.resize(std::min<size_t>(kChunk, vertices_ - result.size()));
      stream_.read(raw.data(), raw.size() * raw[0].size());
      for (const auto& bytes : raw) result.push_back(narrow<Scalar, N>(bytes.data(), what, result.size()));
    }
    return result;
  }

  template <typename Scalar, size_t N>
  std::array<float, N> narrow(const char* bytes, const char* what, size_t vertex) const {
    std::array<float, N> result{};
    for (size_t i = 0; i < N; ++i) {
      const auto value = load_number<Scalar>(bytes + i * sizeof(Scalar));
      result[i] = static_cast<float>(value);
      if (!std::isfinite(result[i])) {
        fail("vertex " + std::to_string(vertex) + ": " + what + " " +
             (std::isfinite(value) ? "too large for a float" : "not finite"));
      }
    }
    return result;
  }

  void read_triangles(Mesh& mesh) {
    constexpr size_t kChunk = 65536;
    std::vector<std::array<char, 12>> raw;
    while (mesh.triangles.size() < triangles_) {
      raw.resize(std::min<size_t>(kChunk, triangles_ - mesh.triangles.size()));
      stream_.read(raw.data(), raw.size() * raw[0].size());
      for (const auto& bytes : raw) mesh.triangles.push_back(triangle(bytes.data(), mesh.triangles.size()));
    }
  }

  std::array<uint32_t, 3> triangle(const char* bytes, size_t number) const {
    std::array<uint32_t, 3> result{};
    for (size_t i = 0; i < 3; ++i) {
      result[i] = load_number<uint32_t>(bytes + 4 * i);
      if (result[i] >= vertices_) {
        fail("triangle " + std::to_string(number) + ": index " + std::to_string(result[i]) +
             ": must be below " + std::to_string(vertices_) + ", the number of vertices");
      }
    }
    return result;
  }

  [[noreturn]] void fail(const std::string& message) const { file_.fail_byte(stream_.offset(), message); }

  const MeshFile& file_;
  uint16_t version_;
  InflateStream stream_;
  uint32_t flags_ = 0;
  uint64_t vertices_ = 0, triangles_ = 0;
};

}  // namespace

Mesh read_serialized(const std::filesystem::path& path, const MeshOptions& options,
                     const DiagnosticSink& sink) {
  const MeshFile file = load_mesh_file(path);
  SerializedReader reader(file, find_mesh(file, options.shape_index));
  Mesh mesh = reader.read();
  if (options.flip_tex_coords) {
    for (Vec2f& uv : mesh.uvs) uv[1] = 1.0f - uv[1];
  }
  MeshOptions flagged = options;
  flagged.face_normals |= reader.face_normals();
  finish_mesh(mesh, file, flagged, sink);
  return mesh;
}

}  // namespace kiloband
