// Identifiers and references: <ref id=...>, <alias id=... as=...>.
#include <algorithm>
#include <unordered_map>

#include "scene/xml/tree.hpp"
#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

class Resolver {
 public:
  void run(Node& root, const AliasList& aliases) {
    collect(root);
    for (const auto& [id, as] : aliases) add_alias(as);
    resolve_aliases(aliases);
    connect(root);
    height(root, root.place);
  }

 private:
  void add_id(const std::string& id, const Place& place, Node* node) {
    if (id.empty()) fail(place, "the id is empty");
    const auto [entry, is_new] = objects_.try_emplace(id, Entry{node, place});
    if (!is_new) {
      fail(place, "id '" + id + "' is taken: first used at " + entry->second.place.position().to_string());
    }
  }

  void collect(Node& node) {
    if (node.kind == TagKind::kObject && node.id_place.line > 0) add_id(node.id, node.id_place, &node);
    for (const auto& child : node.children) collect(*child);
  }

  void add_alias(const XmlAttribute& as) { add_id(as.value, as.value_place, nullptr); }

  /// Aliases may name aliases, in any order; each round resolves at least one or there is a cycle.
  void resolve_aliases(const AliasList& aliases) {
    std::vector<const AliasList::value_type*> open;
    for (const auto& alias : aliases) open.push_back(&alias);
    while (!open.empty()) {
      const std::size_t before = open.size();
      std::erase_if(open, [&](const auto* alias) {
        Node* node = look_up(alias->first.value, alias->first.value_place).node;
        if (node) objects_.at(alias->second.value).node = node;
        return node != nullptr;
      });
      if (open.size() == before)
        fail(open[0]->first.value_place, "alias '" + open[0]->first.value + "' refers to itself");
    }
  }

  struct Entry {
    Node* node;
    Place place;
  };

  const Entry& look_up(const std::string& id, const Place& place) const {
    const auto found = objects_.find(id);
    if (found != objects_.end()) return found->second;
    std::vector<std::string_view> names;
    for (const auto& entry : objects_) names.push_back(entry.first);
    std::sort(names.begin(), names.end());
    if (names.size() > 1000) names.resize(1000);
    fail(place, "no object has the id '" + id + "'" + suggestion(id, names));
  }

  void connect(Node& node) {
    if (node.kind == TagKind::kRef) node.target = look_up(node.id, node.id_place).node;
    for (const auto& child : node.children) connect(*child);
  }

  /// Levels from `node` down, references followed. -1 in the table: being visited,
  /// so that meeting it closes a cycle.
  int height(Node& node, const Place& from, int above = 0) {
    if (above > kMaxNesting)
      fail(from, "nested more than " + std::to_string(kMaxNesting) + " levels deep (with references)");
    const auto known = heights_.find(&node);
    if (known != heights_.end() && known->second < 0)
      fail(from, "reference '" + node.id + "' to an object that contains it");
    if (known != heights_.end()) return known->second;
    heights_[&node] = -1;
    int tallest = 0;
    for (const auto& child : node.children) {
      const Place& place = child->target ? child->id_place : child->place;
      tallest = std::max(tallest, height(child->resolved(), place, above + 1));
      if (above + tallest > kMaxNesting) {
        fail(place, "nested more than " + std::to_string(kMaxNesting) + " levels deep (with references)");
      }
    }
    return heights_[&node] = tallest + 1;
  }

  std::unordered_map<std::string, Entry> objects_;
  std::unordered_map<const Node*, int> heights_;
};

}  // namespace

void resolve_references(Node& root, const AliasList& aliases) {
  Resolver().run(root, aliases);
}

}  // namespace kiloband
