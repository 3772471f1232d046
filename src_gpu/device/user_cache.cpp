#include "src_gpu/device/user_cache.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "base/error.hpp"
#include "base/hash.hpp"
#include "files/atomic_file.hpp"

namespace kiloband::opencl {
namespace {

namespace fs = std::filesystem;

/// Made with all its parents, for this user alone. false: errno says why.
bool make_folder(const fs::path& folder) {
  std::error_code error;
  if (fs::is_directory(folder, error)) return true;
  if (folder.has_parent_path() && folder.parent_path() != folder && !make_folder(folder.parent_path()))
    return false;
  if (mkdir(folder.c_str(), 0700) == 0) return true;
  const int reason = errno == EEXIST ? ENOTDIR : errno;
  if (fs::is_directory(folder, error)) return true;  // made by another process meanwhile
  errno = reason;
  return false;
}

/// What an environment variable says, if it is an absolute path.
fs::path absolute_path_of(const char* variable) {
  const char* value = std::getenv(variable);
  const fs::path path = value ? value : "";
  return path.is_absolute() ? path : fs::path();
}

}  // namespace

std::string text_hash(std::string_view text) {
  const Uint128 hash = fnv1a<Uint128>(text);
  return fmt::format("{:016x}{:016x}", static_cast<uint64_t>(hash >> 64), static_cast<uint64_t>(hash));
}

std::string joined_parts(std::initializer_list<std::string_view> parts) {
  std::string all;
  for (const std::string_view part : parts)
    all.append(std::to_string(part.size())).append(1, ':').append(part);
  return all;
}

fs::path user_cache(const std::string& name) {
  const fs::path below = fs::path("kiloband") / name;
  if (const fs::path cache = absolute_path_of("XDG_CACHE_HOME"); !cache.empty()) return cache / below;
  if (const fs::path home = absolute_path_of("HOME"); !home.empty()) return home / ".cache" / below;
  return {};
}

std::string make_cache_folder(const fs::path& folder) {
  if (make_folder(folder)) return {};
  return "cannot write '" + folder.string() + "': " + std::strerror(errno);
}

std::string keep_file(const fs::path& file, std::string_view text) {
  if (std::string refusal = make_cache_folder(file.parent_path()); !refusal.empty()) return refusal;
  try {
    write_file_atomically(file, text, 0600);
  } catch (const DeviceError& refusal) {
    return refusal.what();
  }
  return {};
}

}  // namespace kiloband::opencl
