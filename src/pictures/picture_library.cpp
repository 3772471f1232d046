#include "pictures/picture_library.hpp"

#include <dlfcn.h>

#include <array>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "pictures/readers/readers.hpp"

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
  throw DeviceError(reason ? reason : file.string());
}

class Pictures : public PictureLibrary {
 public:
  std::unique_ptr<PictureInput> open(const std::string& format, const std::string& file,
                                     std::string& error) override {
    error.clear();
    try {
      if (auto input = open_own(format, file)) return input;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& reason) {
      error = reason.what();
      return nullptr;
    }
    return library_for(file).open(format, file, error);
  }

  void spare_threads() override { spare_ = true; }

 private:
  using Opener = std::unique_ptr<PictureInput> (*)(const std::string& file);

  static std::unique_ptr<PictureInput> open_own(const std::string& format, const std::string& file) {
    constexpr std::array<std::pair<std::string_view, Opener>, 6> kOwn = {{{"openexr", open_exr},
                                                                          {"png", open_png},
                                                                          {"jpeg", open_jpeg},
                                                                          {"hdr", open_radiance},
                                                                          {"pnm", open_pfm},
                                                                          {"pnm", open_pnm}}};
    for (const auto& [name, opener] : kOwn)
      if (name == format)
        if (auto input = opener(file)) return input;
    return nullptr;
  }

  PictureLibrary& library_for(const std::string& file) const {
    try {
      PictureLibrary& library = oiio_library();
      if (spare_) library.spare_threads();
      return library;
    } catch (const DeviceError& error) {
      throw DeviceError(file +
                        ": this kind of picture needs OpenImageIO, which cannot be loaded: " + error.what());
    }
  }

  bool spare_ = false;
};

}  // namespace

PictureLibrary& picture_library() {
  static Pictures library;
  return library;
}

PictureLibrary& oiio_library() {
  static PictureLibrary& library = load();
  return library;
}

}  // namespace kiloband
