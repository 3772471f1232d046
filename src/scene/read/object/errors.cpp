#include "scene/read/object/errors.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace kiloband {
namespace {

struct Found {
  Node* element = nullptr;
  Node* parent = nullptr;
};

/// The element whose start tag holds the position: the last that begins there or before, since elements begin in the
/// order of the text.
Found element_at(Node& root, const SourcePosition& position) {
  Found found;
  std::pair<int, int> begin{0, 0};
  const std::pair<int, int> end{position.line, position.column};
  const auto visit = [&](Node& node, Node* parent, const auto& self) -> void {
    const std::pair<int, int> place{node.place.line, node.place.column};
    if (node.place.file && *node.place.file == position.file && begin <= place && place <= end) {
      found = {&node, parent};
      begin = place;
    }
    for (const auto* nodes : {&node.children, &node.left_out})
      for (const auto& child : *nodes) self(*child, &node, self);
  };
  visit(root, nullptr, visit);
  return found;
}

/// The next attempt goes without the parameter or part. False: it is no such thing but a whole object of the scene, or
/// is left out already.
bool leave_out(const Node& root, const Found& found) {
  if (!found.parent || found.parent == &root) return false;
  auto& children = found.parent->children;
  const auto child = std::ranges::find(children, found.element, [](const auto& node) { return node.get(); });
  if (child == children.end()) return false;
  found.parent->left_out.push_back(std::move(*child));
  children.erase(child);
  return true;
}

}  // namespace

void ReadErrors::attempt(const std::function<void()>& read) {
  for (;;) {
    try {
      return read();
    } catch (const InputError& error) {
      const bool placed = error.position().line > 0;
      const Found found = placed ? element_at(root_, error.position()) : Found{};
      // An object that lacks what was left out may fail for that reason alone: this tells nothing new.
      if (!found.element || found.element->left_out.empty()) add(error);
      if (errors_.size() >= kMost) throw_if_any();
      if (!leave_out(root_, found)) return;
    }
  }
}

void ReadErrors::add(const InputError& error) {
  const bool placed = error.position().line > 0;
  const bool is_new = places_.insert(placed ? error.position().to_string() : error.what()).second;
  if (is_new) errors_.push_back(error);
}

void ReadErrors::throw_if_any() const {
  if (errors_.empty()) return;
  std::vector<InputError> sorted = errors_;
  std::ranges::stable_sort(sorted, {}, [](const InputError& error) {
    return std::tuple(error.position().file, error.position().line, error.position().column);
  });
  std::string text;
  for (const InputError& error : sorted) text += (text.empty() ? "" : "\n") + std::string(error.what());
  if (errors_.size() >= kMost)
    text += "\n(the first " + std::to_string(kMost) + " errors; there may be more)";
  throw InputError(text);
}

}  // namespace kiloband
