#include "scene/mesh/input.hpp"

#include <string_view>

#include "base/error.hpp"
#include "base/regular_file.hpp"
#include "base/text.hpp"

namespace kiloband {

void MeshFile::fail(const std::string& message) const {
  throw InputError(name + ": " + message);
}

void MeshFile::fail_line(size_t line, const std::string& message) const {
  throw InputError(name + ":" + std::to_string(line) + ": " + message);
}

void MeshFile::fail_byte(size_t offset, const std::string& message) const {
  throw InputError(name + ": byte " + std::to_string(offset) + ": " + message);
}

namespace {

/// Of text: binary STL files may begin with any bytes.
void drop_byte_order_mark(const std::filesystem::path& path, std::string& bytes) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (!bytes.starts_with(kMark)) return;
  const std::string_view rest = std::string_view(bytes).substr(kMark.size());
  if (lowered_extension(path) == ".obj" || rest.starts_with("ply") || rest.starts_with("solid"))
    bytes.erase(0, kMark.size());
}

}  // namespace

MeshFile load_mesh_file(const std::filesystem::path& path) {
  MeshFile file{path.string(), {}};
  RegularFile input = open_regular_file(path);
  file.bytes.resize(input.bytes);
  input.stream.read(file.bytes.data(), static_cast<std::streamsize>(input.bytes));
  if (static_cast<uintmax_t>(input.stream.gcount()) != input.bytes) file.fail("cannot be read to its end");
  drop_byte_order_mark(path, file.bytes);
  return file;
}

}  // namespace kiloband
