#include "app/source_folder.hpp"

#include <filesystem>

namespace kiloband {

std::string source_folder() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path bin = fs::read_symlink("/proc/self/exe", error).parent_path();
  const fs::path beside = (bin / "../share/kiloband").lexically_normal();
  if (bin.is_absolute() && fs::is_directory(beside / "scenes", error)) return beside.string();
  return KILOBAND_SOURCE_DIR;
}

}  // namespace kiloband
