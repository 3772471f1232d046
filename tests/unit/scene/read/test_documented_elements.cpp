// The table "Elements" of docs/scene_format.md against the reader.
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "support.hpp"

namespace kiloband::test::test_documented_elements {
namespace {

struct DocumentedType {
  std::string element, type;
  bool is_read = false;
};

/// What stands between pairs of ` in a cell.
std::vector<std::string> quoted(const std::string& cell) {
  std::vector<std::string> words;
  for (std::size_t at = cell.find('`'); at != cell.npos;) {
    const std::size_t end = cell.find('`', at + 1);
    words.push_back(cell.substr(at + 1, end - at - 1));
    at = cell.find('`', end + 1);
  }
  return words;
}

std::vector<std::string> cells_of(const std::string& row) {
  std::vector<std::string> cells;
  for (std::size_t at = row.find('|'); at != row.npos && at + 1 < row.size();) {
    const std::size_t end = row.find('|', at + 1);
    cells.push_back(row.substr(at + 1, end - at - 1));
    at = end;
  }
  return cells;
}

/// The rows of the table, a type each.
std::vector<DocumentedType> documented_types() {
  std::vector<DocumentedType> types;
  std::ifstream file(KILOBAND_SOURCE_DIR "/docs/scene_format.md");
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("## ")) inside = line == "## Elements";
    if (!inside || !line.starts_with("| `")) continue;
    const std::vector<std::string> cells = cells_of(line);
    EXPECT_EQ(cells.size(), 4u) << line;
    const std::string& read = cells.at(1);
    EXPECT_TRUE(read == " yes " || read == " differs " || read == " no ") << line;
    for (const std::string& type : quoted(cells.at(2)))
      types.push_back({quoted(cells.at(0)).at(0), type, read != " no "});
  }
  return types;
}

/// A scene with such an element where it may stand.
std::string scene_with(const std::string& element, const std::string& type) {
  const std::string text = "<" + element + " type=\"" + type + "\"/>";
  if (element == "sensor") return scene(text + kLight + kSphere);
  if (element == "film" || element == "sampler")
    return scene(R"(<sensor type="perspective">)" + text + "</sensor>" + kLight + kSphere);
  if (element == "rfilter")
    return scene(R"(<sensor type="perspective"><film type="hdrfilm">)" + text + "</film></sensor>" + kLight +
                 kSphere);
  if (element == "medium") return complete_scene("<medium type=\"" + type + "\" name=\"atmosphere\"/>");
  return complete_scene(text);
}

/// Whether the reader knows the type; with what it needs it is another matter.
bool is_known(const DocumentedType& documented) {
  const std::string error = error_of(scene_with(documented.element, documented.type));
  return error.find(documented.element + " type '" + documented.type + "' is not supported") == error.npos;
}

TEST(DocumentedElements, AreReadAsTheTableSays) {
  std::set<std::pair<std::string, std::string>> seen;
  for (const DocumentedType& documented : documented_types()) {
    EXPECT_EQ(is_known(documented), documented.is_read) << documented.element << ' ' << documented.type;
    EXPECT_TRUE(seen.emplace(documented.element, documented.type).second)
        << documented.type << " stands twice";
  }
  EXPECT_GT(seen.size(), 100u);
}

}  // namespace
}  // namespace kiloband::test::test_documented_elements
