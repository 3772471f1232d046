#include "pictures/picture_library.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <string>

#include "base/error.hpp"

namespace kiloband {
namespace {

namespace fs = std::filesystem;

/// Never a bare name: the folders of the dynamic linker, and the current one, are not asked.
fs::path find_module() {
  const fs::path built = KILOBAND_PICTURES_MODULE;
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& file : {folder / built.filename(), folder / "../lib/kiloband" / built.filename()}) {
    if (folder.is_absolute() && fs::is_regular_file(file, error)) return file;
  }
  return built;
}

PictureLibrary& load() {
  const fs::path file = find_module();
  void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);  // stays until the process ends
  using Entry = PictureLibrary* (*)();
  const auto entry = module ? reinterpret_cast<Entry>(dlsym(module, "kiloband_picture_library")) : nullptr;
  if (entry) return *entry();
  const char* reason = dlerror();
  throw DeviceError("pictures cannot be read or written: " + std::string(reason ? reason : file.string()));
}

}  // namespace

PictureLibrary& picture_library() {
  static PictureLibrary& library = load();
  return library;
}

}  // namespace kiloband
