#include "scene/mesh/input.hpp"

#include <fstream>
#include <system_error>

#include "base/error.hpp"

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
  return file;
}

}  // namespace kiloband
