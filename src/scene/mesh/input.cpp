#include "scene/mesh/input.hpp"

#include <fstream>
#include <string_view>
#include <system_error>

#include "base/error.hpp"
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
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) file.fail("no such file");
  // A pipe or a device could block or never end.
  if (!std::filesystem::is_regular_file(status)) file.fail("not a regular file");
  const auto size = std::filesystem::file_size(path, error);
  std::ifstream stream(path, std::ios::binary);
  if (error || !stream) file.fail("cannot be opened");
  if (size == 0) file.fail("the file is empty");
  file.bytes.resize(size);
  stream.read(file.bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<uintmax_t>(stream.gcount()) != size) file.fail("cannot be read to its end");
  drop_byte_order_mark(path, file.bytes);
  return file;
}

}  // namespace kiloband
