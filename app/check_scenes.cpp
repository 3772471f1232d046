#include "app/check_scenes.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "app/console/standard_output.hpp"
#include "base/error.hpp"
#include "scene/compile/flat_scene.hpp"

namespace kiloband {
namespace fs = std::filesystem;
namespace {

/// Where the markup at `at` ends that comes before the first element: a comment, an instruction, a document type.
std::size_t end_of_markup(const std::string& text, std::size_t at) {
  if (text.compare(at, 4, "<!--") == 0) return text.find("-->", at);
  if (text.compare(at, 2, "<?") == 0) return text.find("?>", at);
  const std::size_t end = text.find('>', at), subset = text.find('[', at);
  return subset < end ? text.find('>', text.find(']', subset)) : end;
}

/// Name of the first element of an XML file; nothing where it cannot be told: the reader says what is wrong.
std::optional<std::string> root_element(const fs::path& file) {
  constexpr std::streamsize kMost = 1 << 16;  // declarations and comments before it
  std::string text(kMost, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(text.data(), kMost);
  text.resize(static_cast<std::size_t>(stream.gcount()));
  std::size_t at = text.find('<');
  if (text.find('\0') != std::string::npos) return std::nullopt;  // UTF-16
  while (at != std::string::npos && (text.compare(at, 2, "<!") == 0 || text.compare(at, 2, "<?") == 0)) {
    const std::size_t end = end_of_markup(text, at);
    at = end == std::string::npos ? end : text.find('<', end);
  }
  if (at == std::string::npos) return std::nullopt;
  const std::size_t end = text.find_first_of(" \t\r\n/>", at);
  return text.substr(at + 1, end == std::string::npos ? end : end - at - 1);
}

std::vector<fs::path> scenes_below(const fs::path& folder) {
  std::error_code unknown;  // names that are too long, links to themselves
  if (!fs::is_directory(folder, unknown)) throw InputError(folder.string() + ": is not a folder");
  std::vector<fs::path> files;
  constexpr auto kOptions = fs::directory_options::skip_permission_denied;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, kOptions)) {
    if (entry.path().extension() == ".xml" && entry.is_regular_file(unknown) &&
        root_element(entry.path()).value_or("scene") == "scene")
      files.push_back(entry.path());
  }
  if (files.empty())
    throw InputError(folder.string() + ": no scene file (*.xml with <scene>) below this folder");
  std::ranges::sort(files);
  return files;
}

/// The error of a scene, a line for each thing that is wrong; nothing if it can be rendered.
std::optional<std::string> error_of(const fs::path& file, SceneOptions options) {
  options.scene = file.string();
  try {
    const DiagnosticSink silent;
    const LoadedScene loaded = load_scene(options, silent);
    compile_scene(loaded.description, {loaded.channels, loaded.guide, silent});
    return std::nullopt;
  } catch (const InputError& error) {
    return error.what();
  }
}

/// What is wrong, without the place and without what may have been meant: the same in many scenes.
std::string kind_of(const std::string& line) {
  constexpr std::string_view kBeforeMessage = ": error: ";
  const std::size_t place = line.find(kBeforeMessage);
  const std::size_t begin = place == std::string::npos ? 0 : place + kBeforeMessage.size();
  return line.substr(begin, line.find("; did you mean ") - begin);
}

/// Prints the lines of an error, and counts each kind of them once.
void report(const std::string& error, std::map<std::string, std::size_t>& scenes_with) {
  std::istringstream lines(error);
  std::set<std::string> kinds;
  for (std::string line; std::getline(lines, line);) {
    answer("  {}\n", line);
    if (!line.starts_with("(")) kinds.insert(kind_of(line));  // "(the first 20 errors; ...)"
  }
  for (const std::string& kind : kinds) ++scenes_with[kind];
}

}  // namespace

bool check_scenes(const fs::path& folder, const SceneOptions& options) {
  const std::vector<fs::path> files = scenes_below(folder);
  std::map<std::string, std::size_t> scenes_with;
  std::size_t loading = 0;
  for (const fs::path& file : files) {
    const auto error = error_of(file, options);
    answer("{} {}\n", error ? "stopped" : "loads  ", file.lexically_relative(folder).string());
    if (error)
      report(*error, scenes_with);
    else
      ++loading;
  }
  answer("{} of {} scenes load\n", loading, files.size());
  std::vector<std::pair<std::string, std::size_t>> kinds(scenes_with.begin(), scenes_with.end());
  std::ranges::stable_sort(kinds, std::ranges::greater{}, &std::pair<std::string, std::size_t>::second);
  for (const auto& [kind, count] : kinds) answer("{:>5} stopped by: {}\n", count, kind);
  return loading == files.size();
}

}  // namespace kiloband
