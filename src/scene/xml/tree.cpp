#include "scene/xml/tree.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>

#include "scene/xml/old_elements.hpp"
#include "scene/xml/substitute.hpp"
#include "scene/xml/values.hpp"

namespace kiloband {
namespace fs = std::filesystem;
namespace {

constexpr int kMaxIncludes = 1000;
constexpr std::size_t kMaxAliases = 1000;
constexpr std::size_t kMaxFolders = 100;  // each file name is looked for in all of them

/// What holds for one file while it is expanded.
struct FileState {
  bool legacy = false;
  int depth = 1;        // levels above, those of including files included
  bool at_root = true;  // directly under the main scene's root
};

/// "3.0.0" or "0.6": the first number; files before version 2 have camelCase names.
bool is_legacy(const XmlAttribute& version) {
  int numbers[3] = {0, 0, 0};
  const char* c = version.value.data();
  const char* const end = c + version.value.size();
  int count = 0;
  while (count < 3) {
    const auto [next, error] = std::from_chars(c, end, numbers[count]);
    if (error != std::errc{} || numbers[count] < 0) break;
    ++count;
    c = next;
    if (c == end || *c != '.') break;
    ++c;
  }
  if (count == 0 || c != end || version.value.back() == '.') {
    fail(version.value_place, "'" + version.value + "' is not a version such as 3.0.0");
  }
  if (numbers[0] > 3) fail(version.value_place, "version " + version.value + " is not supported (at most 3)");
  return numbers[0] < 2;
}

class Expander {
 public:
  Expander(SceneTree& tree, const std::vector<std::pair<std::string, std::string>>& defines)
      : tree_(tree), substitution_(defines) {}

  void run(std::string text, const std::string& name, const fs::path& directory) {
    tree_.files.push_back(name);
    tree_.search.push_back(directory);
    const XmlElement root = parse_xml(std::move(text), &tree_.files.back(), totals_);
    if (root.tag != "scene") fail(root.place, "the root element must be <scene>, found <" + root.tag + ">");
    FileState state;
    std::error_code error;
    chain_.push_back(fs::weakly_canonical(directory / fs::path(name).filename(), error));
    tree_.root = object(root, state);
    substitution_.check_all_known(root.place);
    resolve_references(*tree_.root, aliases_);
  }

 private:
  /// The value of an attribute after substitution.
  XmlAttribute substituted(const XmlAttribute& attribute) {
    XmlAttribute result = attribute;
    if (attribute.value.find('$') != std::string::npos) {
      result.value = substitution_.apply(attribute.value, attribute.value_place);
    }
    return result;
  }

  /// The element with its attributes after substitution, without its children.
  XmlElement substituted(const XmlElement& element, bool legacy) {
    XmlElement result{element.tag, element.place, {}, {}};
    if (legacy && result.tag == "lookAt") result.tag = "lookat";
    for (const XmlAttribute& attribute : element.attributes)
      result.attributes.push_back(substituted(attribute));
    return result;
  }

  void take_attributes(const XmlElement& element, Node& node) {
    for (const XmlAttribute& attribute : element.attributes) {
      if (attribute.name == "type") {
        node.type = attribute.value, node.type_place = attribute.value_place;
      } else if (attribute.name == "id") {
        node.id = attribute.value, node.id_place = attribute.value_place;
      } else if (attribute.name == "name") {
        if (attribute.value.empty()) fail(attribute.value_place, "<" + element.tag + ">: the name is empty");
        if (attribute.value[0] == '_') fail(attribute.value_place, "names starting with '_' are reserved");
        node.name = node.legacy ? snake_case(attribute.value) : attribute.value;
        node.name_place = attribute.value_place;
      } else {
        node.attributes.push_back(attribute);
      }
    }
  }

  std::unique_ptr<Node> object(const XmlElement& source, const FileState& outer) {
    if (outer.depth > kMaxNesting) {
      fail(source.place, "nested more than " + std::to_string(kMaxNesting) + " levels deep");
    }
    if (outer.legacy)
      if (const auto modern = modern_form(substituted(source, true))) return object(*modern, outer);
    FileState state = outer;
    if (source.tag == "scene") state.legacy = scene_version(source);
    const XmlElement element = substituted(source, state.legacy);
    const TagRule& rule = check_element(element);
    auto node = std::make_unique<Node>();
    node->kind = rule.kind;
    node->tag = element.tag;
    node->place = element.place;
    node->legacy = state.legacy;
    take_attributes(element, *node);
    ++state.depth;
    if (rule.kind == TagKind::kObject) {
      add_children(source, *node, state);
    } else if (rule.kind == TagKind::kTransform) {
      add_steps(source, *node, state);
    } else {
      refuse_children(source);
    }
    return node;
  }

  bool scene_version(const XmlElement& scene) {
    const XmlAttribute* version = scene.find("version");
    if (!version) fail(scene.place, "<scene>: attribute 'version' is missing");
    return is_legacy(substituted(*version));
  }

  void refuse_children(const XmlElement& element) const {
    if (element.children.empty()) return;
    fail(element.children[0].place, "<" + element.tag + "> cannot contain elements");
  }

  void add_steps(const XmlElement& element, Node& node, const FileState& state) {
    for (const XmlElement& child : element.children) {
      XmlElement step = substituted(child, state.legacy);
      if (check_element(step).kind != TagKind::kStep) {
        fail(step.place, "<" + step.tag + "> is not allowed in a transform");
      }
      refuse_children(child);
      node.steps.push_back(std::move(step));
    }
  }

  void add_children(const XmlElement& element, Node& node, const FileState& state) {
    for (const XmlElement& child : element.children) add_child(child, node, state);
  }

  void add_child(const XmlElement& child, Node& parent, const FileState& outer) {
    FileState state = outer;
    state.at_root = outer.at_root && parent.tag == "scene";
    if (child.tag == "scene") fail(child.place, "<scene> is allowed as the root element only");
    static const std::vector<std::string_view> kDirectives = {"default", "include", "path", "alias"};
    if (std::find(kDirectives.begin(), kDirectives.end(), child.tag) != kDirectives.end()) {
      const XmlElement directive = substituted(child, state.legacy);
      check_element(directive);
      refuse_children(child);
      return follow(directive, parent, state);
    }
    auto node = object(child, state);
    if (node->kind == TagKind::kStep) fail(node->place, "<" + node->tag + "> is allowed in a transform only");
    adopt(std::move(node), parent);
  }

  /// Names unnamed parameters _arg_0, _arg_1 ... in their order.
  void adopt(std::unique_ptr<Node> node, Node& parent) {
    if (node->name.empty()) node->name = "_arg_" + std::to_string(unnamed_[&parent]++);
    parent.children.push_back(std::move(node));
  }

  void follow(const XmlElement& directive, Node& parent, const FileState& state) {
    if (directive.tag == "default") {
      const XmlAttribute& name = *directive.find("name");
      substitution_.set_default(name.value, directive.find("value")->value, name.value_place);
    } else if (directive.tag == "alias") {
      if (aliases_.size() == kMaxAliases)
        fail(directive.place, "more than " + std::to_string(kMaxAliases) + " aliases");
      aliases_.emplace_back(*directive.find("id"), *directive.find("as"));
    } else if (directive.tag == "path") {
      add_search_folder(directive, state);
    } else {
      include(directive, parent, state);
    }
  }

  void add_search_folder(const XmlElement& directive, const FileState& state) {
    if (!state.at_root) fail(directive.place, "<path> is allowed directly under <scene> only");
    if (tree_.search.size() > kMaxFolders)
      fail(directive.place, "more than " + std::to_string(kMaxFolders) + " folders");
    const XmlAttribute& value = *directive.find("value");
    const fs::path folder = tree_.search.front() / value.value;
    std::error_code error;
    if (!fs::is_directory(folder, error)) fail(value.value_place, "folder '" + value.value + "' not found");
    tree_.search.push_back(folder);
  }

  /// The children of the included file's <scene>, or its root element itself, take the place of <include>.
  void include(const XmlElement& directive, Node& parent, const FileState& outer) {
    const XmlAttribute& name = *directive.find("filename");
    const Place& place = name.value_place;
    const fs::path file = find_file(tree_, name.value, place);
    std::error_code error;
    const fs::path canonical = fs::weakly_canonical(file, error);
    FileState state = outer;
    if (std::find(chain_.begin(), chain_.end(), canonical) != chain_.end()) {
      fail(place, "file '" + name.value + "' includes itself");
    }
    if (++includes_ > kMaxIncludes) fail(place, "more than " + std::to_string(kMaxIncludes) + " includes");
    chain_.push_back(canonical);
    ++state.depth;
    tree_.files.push_back(file.string());
    const XmlElement root = parse_xml(read_text_file(file, place), &tree_.files.back(), totals_);
    if (root.tag == "scene") {
      state.legacy = scene_version(root);
      check_element(root);
      add_children(root, parent, state);
    } else {
      add_child(root, parent, state);
    }
    chain_.pop_back();
  }

  SceneTree& tree_;
  Substitution substitution_;
  AliasList aliases_;
  std::map<const Node*, int> unnamed_;
  std::vector<fs::path> chain_;  // files being read, outermost first
  XmlTotals totals_;
  int includes_ = 0;
};

}  // namespace

const XmlAttribute* Node::find(std::string_view attribute) const {
  for (const XmlAttribute& candidate : attributes) {
    if (candidate.name == attribute) return &candidate;
  }
  return nullptr;
}

SceneTree build_tree(std::string text, const std::string& name, const fs::path& directory,
                     const std::vector<std::pair<std::string, std::string>>& defines) {
  SceneTree tree;
  Expander(tree, defines).run(std::move(text), name, directory);
  return tree;
}

fs::path find_file(SceneTree& tree, const std::string& name, const Place& place) {
  if (name.empty()) fail(place, "the file name is empty");
  std::error_code error;
  for (const fs::path& folder : tree.search) {
    const fs::path candidate = folder / name;  // an absolute name replaces the folder
    const fs::file_status status = fs::status(candidate, error);
    if (fs::is_regular_file(status)) return *tree.found.insert(candidate).first;
    if (fs::exists(status)) fail(place, "'" + name + "' is not a regular file");
  }
  fail(place, "file '" + name + "' not found");
}

std::string read_text_file(const fs::path& file, const Place& place) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  if (error) fail(place, "cannot read '" + file.string() + "': " + error.message());
  if (size > kMaxFileBytes) fail(place, "'" + file.string() + "' is larger than 256 MiB");
  std::string text(size, '\0');
  std::ifstream in(file, std::ios::binary);
  if (!in.read(text.data(), static_cast<std::streamsize>(size)))
    fail(place, "cannot read '" + file.string() + "'");
  return text;
}

}  // namespace kiloband
