// The project's own files as text: what the structure tests look at.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace kiloband::test {

struct SourceFile {
  std::string path;  // from the project's root, "src/post/png.cpp"
  std::string text;
};

/// All text files below these folders of the project (or these files), sorted by path.
/// throws std::runtime_error  one of them does not exist
std::vector<SourceFile> read_files(const std::vector<std::string>& places);

/// Targets of the #include "..." lines with their line numbers.
std::vector<std::pair<int, std::string>> own_includes(const std::string& text);

bool starts_with(const std::string& text, const std::string& prefix);

}  // namespace kiloband::test
