// Builds binary test files: numbers of either byte order, zlib streams, serialized meshes.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace kiloband::test {

/// The bytes of `value`.
template <typename T>
std::string raw(T value, std::endian order = std::endian::little) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (order != std::endian::native) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

template <typename T>
std::string raw(const std::vector<T>& values, std::endian order = std::endian::little) {
  std::string bytes;
  for (const T value : values) bytes += raw(value, order);
  return bytes;
}

inline std::string deflate(const std::string& plain) {
  uLongf size = compressBound(plain.size());
  std::string packed(size, '\0');
  const int status = compress(reinterpret_cast<Bytef*>(packed.data()), &size,
                              reinterpret_cast<const Bytef*>(plain.data()), plain.size());
  if (status != Z_OK) throw std::logic_error("compress failed");
  packed.resize(size);
  return packed;
}

/// What stands inside the zlib stream of a serialized mesh, by default a quad of two triangles
/// with z = 0 and no extras.
struct PlainMesh {
  uint32_t flags = 0x1000;
  std::string name = "quad";
  uint64_t vertices = 4, triangles = 2;
  std::string arrays = raw<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  std::string indices = raw<uint32_t>({0, 1, 2, 0, 2, 3});

  std::string bytes(int version) const {
    return raw(flags) + (version == 4 ? name + std::string(1, '\0') : "") + raw(vertices) + raw(triangles) +
           arrays + indices;
  }
};

/// A file of meshes given as zlib streams.
inline std::string serialized_file(int version, const std::vector<std::string>& streams) {
  std::string file, table;
  for (const std::string& stream : streams) {
    table += version == 4 ? raw<uint64_t>(file.size()) : raw<uint32_t>(static_cast<uint32_t>(file.size()));
    file += raw<uint16_t>(0x041C) + raw(static_cast<uint16_t>(version)) + stream;
  }
  return file + table + raw(static_cast<uint32_t>(streams.size()));
}

inline std::string serialized_file(const PlainMesh& mesh, int version = 4) {
  return serialized_file(version, {deflate(mesh.bytes(version))});
}

}  // namespace kiloband::test
