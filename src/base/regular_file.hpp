// Files of the user's that are read as a whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>

namespace kiloband {

struct RegularFile {
  std::ifstream stream;  // at its beginning
  uintmax_t bytes = 0;   // > 0
};

/// No pipe or device, which could block or never end.
/// throws InputError  "FILE: no such file", not a regular file, cannot be opened, the file is empty
RegularFile open_regular_file(const std::filesystem::path& path);

}  // namespace kiloband
