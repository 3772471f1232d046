// The scene file after includes, defaults, $names and references: objects with parameters,
// nothing interpreted yet.
#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostics.hpp"
#include "scene/xml/grammar.hpp"

namespace kiloband {

/// One element. Objects have `children` (parameters and nested objects), transforms have `steps`.
struct Node {
  TagKind kind = TagKind::kObject;
  std::string tag;
  std::string type;                               // objects
  std::string id;                                 // objects; references: what they name
  std::string name;                               // "_arg_N" where the file gives none
  bool legacy = false;                            // from a file of version < 2
  Place place, type_place, id_place, name_place;  // the element's name; values of its attributes
  std::vector<XmlAttribute> attributes;           // all others: value, x, filename ...
  std::vector<XmlElement> steps;
  std::vector<std::unique_ptr<Node>> children;
  std::vector<std::unique_ptr<Node>>
      left_out;            // children that were found wrong: readers see them no more (ReadErrors)
  Node* target = nullptr;  // references: the object meant

  bool used_as_part = false;  // another object has read this one
  bool used = false;          // somebody asked for this parameter
  /// Parameter names that readers of this object know, numbered in the order of asking. The node owns them:
  /// names like "endmember_3" are put together for one call.
  std::map<std::string, std::size_t, std::less<>> asked;

  bool is_named() const { return !name.starts_with("_arg_"); }
  const XmlAttribute* find(std::string_view attribute) const;
  /// The object itself, or what a reference means.
  Node& resolved() { return target ? *target : *this; }
};

struct SceneTree {
  std::deque<std::string> files;               // names as Place shows them; addresses are stable
  std::vector<std::filesystem::path> search;   // where relative file names are looked for, in order
  std::unique_ptr<Node> root;                  // <scene>
  std::set<std::filesystem::path> found = {};  // by find_file()
};

/// Expands a scene's text. `defines` are the -D options.
/// throws InputError for everything that is wrong without regard to what elements mean
SceneTree build_tree(std::string text, const std::string& name, const std::filesystem::path& directory,
                     const std::vector<std::pair<std::string, std::string>>& defines);

/// The first existing regular file: `name` itself if absolute, else in the search folders. The tree remembers it.
/// throws InputError  "file 'x' not found"
std::filesystem::path find_file(SceneTree& tree, const std::string& name, const Place& place);

/// Whole contents of a file.
/// throws InputError at `place` (unreadable, too large)
std::string read_text_file(const std::filesystem::path& file, const Place& place);

/// The <alias id= as=> elements of a scene.
using AliasList = std::vector<std::pair<XmlAttribute, XmlAttribute>>;  // (id, as)

/// Gives each reference its target. Checks: ids unique, targets exist, no object contains itself, nesting
/// (elements and references together) at most kMaxNesting.
void resolve_references(Node& root, const AliasList& aliases);

}  // namespace kiloband
