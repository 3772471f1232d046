#include "tests/unit/structure/source_tree.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace kiloband::test {
namespace {

namespace fs = std::filesystem;

SourceFile read_file(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return {fs::relative(file, KILOBAND_SOURCE_DIR).string(), text.str()};
}

}  // namespace

std::vector<SourceFile> read_files(const std::vector<std::string>& places) {
  std::vector<SourceFile> files;
  for (const std::string& place : places) {
    const fs::path path = fs::path(KILOBAND_SOURCE_DIR) / place;
    if (!fs::exists(path)) throw std::runtime_error("the project has no " + place);
    if (fs::is_regular_file(path)) {
      files.push_back(read_file(path));
      continue;
    }
    for (const auto& entry : fs::recursive_directory_iterator(path)) {
      if (entry.is_regular_file()) files.push_back(read_file(entry.path()));
    }
  }
  std::sort(files.begin(), files.end(),
            [](const SourceFile& a, const SourceFile& b) { return a.path < b.path; });
  return files;
}

std::vector<std::pair<int, std::string>> own_includes(const std::string& text) {
  static const std::regex kInclude(R"re(^\s*#\s*include\s*"([^"]+)".*)re");
  std::vector<std::pair<int, std::string>> found;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (std::smatch match; std::regex_match(line, match, kInclude)) found.emplace_back(number, match[1]);
  }
  return found;
}

bool starts_with(const std::string& text, const std::string& prefix) {
  return text.rfind(prefix, 0) == 0;
}

}  // namespace kiloband::test
