// A mesh file in memory, and the ways to say where it is wrong.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace kiloband {

/// The bytes of one file. Every fail* throws InputError with the file's name in front.
struct MeshFile {
  std::string name;  // as given by the caller
  std::string bytes;

  /// "name: message"
  [[noreturn]] void fail(const std::string& message) const;
  /// "name:line: message", line from 1
  [[noreturn]] void fail_line(size_t line, const std::string& message) const;
  /// "name: byte offset: message", offset from 0
  [[noreturn]] void fail_byte(size_t offset, const std::string& message) const;
};

/// Reads a regular file as a whole.
/// throws InputError  missing, not a regular file, empty, unreadable
MeshFile load_mesh_file(const std::filesystem::path& path);

}  // namespace kiloband
