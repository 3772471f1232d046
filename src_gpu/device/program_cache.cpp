#include "src_gpu/device/program_cache.hpp"

#include <cstdlib>
#include <fstream>

#include "src_gpu/device/user_cache.hpp"

namespace kiloband::opencl {
namespace {

namespace fs = std::filesystem;

/// File: magic, key, hash of the binary, its size (8 bytes, least significant first), the binary.
constexpr std::string_view kMagic = "kbprog1\n";
constexpr std::size_t kHashLength = 32;
constexpr std::size_t kHeaderLength = kMagic.size() + 2 * kHashLength + 8;
constexpr uint64_t kLargest = uint64_t{256} << 20;  // no program is that large: the file is not ours

std::string header_of(const std::string& key, const std::vector<unsigned char>& binary) {
  std::string header = std::string(kMagic) + key;
  header += text_hash({reinterpret_cast<const char*>(binary.data()), binary.size()});
  for (int byte = 0; byte < 8; ++byte)
    header += static_cast<char>(uint64_t{binary.size()} >> (8 * byte) & 255);
  return header;
}

}  // namespace

ProgramCache ProgramCache::of_user() {
  return ProgramCache(user_cache("programs"));
}

std::string ProgramCache::key(const std::string& source, const std::string& options,
                              const DeviceInfo& device) {
  std::string all = joined_parts(
      {source, options, device.name, device.driver_version, device.platform, device.platform_version});
  const char* method = std::getenv("POCL_WORK_GROUP_METHOD");  // part of what PoCL compiles
  if (device.is_pocl() && method) all += method;
  return text_hash(all);
}

std::optional<std::vector<unsigned char>> ProgramCache::load(const std::string& key) const {
  if (folder_.empty()) return std::nullopt;
  std::error_code error;
  const uint64_t size = fs::is_regular_file(file(key), error) ? fs::file_size(file(key), error) : 0;
  if (error || size <= kHeaderLength || size > kLargest) return std::nullopt;
  std::ifstream stream(file(key), std::ios::binary);
  std::string header(kHeaderLength, '\0');
  std::vector<unsigned char> binary(size - kHeaderLength);
  stream.read(header.data(), static_cast<std::streamsize>(header.size()));
  stream.read(reinterpret_cast<char*>(binary.data()), static_cast<std::streamsize>(binary.size()));
  if (!stream || header != header_of(key, binary)) return std::nullopt;
  return binary;
}

std::string ProgramCache::save(const std::string& key, const std::vector<unsigned char>& binary) const {
  if (folder_.empty() || binary.empty()) return {};
  std::string text = header_of(key, binary);
  text.append(reinterpret_cast<const char*>(binary.data()), binary.size());
  return keep_file(file(key), text);  // is executed: for this user alone
}

}  // namespace kiloband::opencl
