#include "base/regular_file.hpp"

#include <system_error>

#include "base/error.hpp"

namespace kiloband {

RegularFile open_regular_file(const std::filesystem::path& path) {
  const auto fail = [&](const char* message) { throw InputError(path.string() + ": " + message); };
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) fail("no such file");
  if (!std::filesystem::is_regular_file(status)) fail("not a regular file");
  RegularFile file;
  file.bytes = std::filesystem::file_size(path, error);
  file.stream.open(path, std::ios::binary);
  if (error || !file.stream) fail("cannot be opened");
  if (file.bytes == 0) fail("the file is empty");
  return file;
}

}  // namespace kiloband
