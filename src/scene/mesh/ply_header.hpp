// The header of a PLY file: what its body holds and where that begins.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/mesh/input.hpp"

namespace kiloband {

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

size_t byte_size(PlyType type);
bool is_integer(PlyType type);
/// The type's name in the original definition of the format: "uchar", "double" ...
const char* type_name(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;  // of the value, or of a list's items
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  // lists only, an integer type
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;  // names are distinct
  size_t line = 0;                      // of its declaration

  /// The property's place in the row, or -1.
  int find(const std::string& property_name) const;
};

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;  // names are distinct
  size_t body_offset = 0;            // first byte after the header
  size_t body_line = 0;              // its line

  const PlyElement* find(const std::string& element_name) const;
};

/// Reads and checks the header; the counts it states are checked against the bytes that follow.
/// throws InputError  with the line
PlyHeader read_ply_header(const MeshFile& file);

}  // namespace kiloband
