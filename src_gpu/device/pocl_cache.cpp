#include "src_gpu/device/pocl_cache.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "base/temporary_folder.hpp"

namespace kiloband::opencl {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVariable = "POCL_CACHE_DIR";
constexpr off_t kProbeBytes = 1 << 20;  // a few kernels of ours

/// A folder of this process among the temporary files, removed at the end; empty if there can be none.
class TemporaryCache {
 public:
  TemporaryCache() {
    try {
      folder_ = std::filesystem::absolute(make_temporary_folder("kiloband_pocl"));
    } catch (const std::system_error&) {
      return;
    }
    if (!why_not_writable(folder_).empty()) remove();
  }
  ~TemporaryCache() { remove(); }
  TemporaryCache(const TemporaryCache&) = delete;
  TemporaryCache& operator=(const TemporaryCache&) = delete;
  const fs::path& folder() const { return folder_; }

 private:
  void remove() {
    std::error_code ignored;
    if (!folder_.empty()) fs::remove_all(folder_, ignored);
    folder_.clear();
  }

  fs::path folder_;
};

const char* value_of(const char* variable) {
  const char* value = std::getenv(variable);
  return value && *value ? value : nullptr;
}

/// Empty: all is well.
std::string prepare() {
  std::error_code error;
  const fs::path folder = fs::absolute(pocl_cache_folder(), error);
  const std::string reason = error ? error.message() : why_not_writable(folder);
  if (reason.empty()) {
    if (pocl_cache_folder().is_relative()) setenv(kVariable, folder.c_str(), 1);
    return {};
  }
  const std::string problem =
      "PoCL's folder for compiled kernels '" + folder.string() + "' cannot be written (" + reason + ")";
  static const TemporaryCache kInstead;
  if (kInstead.folder().empty())
    return problem + ", and neither can a folder of temporary files: set POCL_CACHE_DIR to one that can";
  setenv(kVariable, kInstead.folder().c_str(), 1);
  return problem + ": '" + kInstead.folder().string() +
         "' is used until this program ends, and every run compiles anew; set POCL_CACHE_DIR to a folder that "
         "can be written";
}

const std::string& prepared() {
  static const std::string kProblem = prepare();
  return kProblem;
}

}  // namespace

fs::path pocl_cache_folder() {
  if (const char* own = value_of(kVariable)) return own;
  if (const char* cache = value_of("XDG_CACHE_HOME")) return fs::path(cache) / "pocl" / "kcache";
  // An empty HOME counts for PoCL: then it takes "/.cache".
  if (const char* home = std::getenv("HOME")) return fs::path(std::string(home) + "/.cache/pocl/kcache");
  return "/tmp/pocl/kcache";
}

std::string why_not_writable(const fs::path& folder) {
  fs::path place = folder;
  std::error_code error;
  while (place.has_relative_path() && fs::status(place, error).type() == fs::file_type::not_found)
    place = place.parent_path();
  std::string name = (place / (".kiloband-" + std::string(6, 'X'))).string();
  const int file = mkostemp(name.data(), O_CLOEXEC);
  if (file < 0) return std::strerror(errno);
  const int code = posix_fallocate(file, 0, kProbeBytes);
  close(file);
  unlink(name.c_str());
  const bool unknown = code == EOPNOTSUPP || code == EINVAL;  // a file system that cannot tell
  return code == 0 || unknown ? std::string() : std::strerror(code);
}

void prepare_pocl_cache() {
  prepared();
}

std::string pocl_cache_problem() {
  return prepared();
}

std::string pocl_build_hint() {
  const std::string reason = why_not_writable(pocl_cache_folder());
  if (reason.empty()) return {};
  return "\nPoCL's folder for compiled kernels '" + pocl_cache_folder().string() +
         "' cannot be written: " + reason + " (POCL_CACHE_DIR names another)";
}

}  // namespace kiloband::opencl
