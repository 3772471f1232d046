#include "scene/read/errors.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace kiloband {
namespace {

/// The element whose start tag holds the position: the last that begins there or before, since elements begin in the
/// order of the text.
Node* element_at(Node& root, const SourcePosition& position) {
  Node* found = nullptr;
  std::pair<int, int> begin{0, 0};
  const std::pair<int, int> end{position.line, position.column};
  const auto visit = [&](Node& node, const auto& self) -> void {
    const std::pair<int, int> place{node.place.line, node.place.column};
    if (node.place.file && *node.place.file == position.file && begin <= place && place <= end) {
      found = &node;
      begin = place;
    }
    for (const auto& child : node.children) self(*child, self);
  };
  visit(root, visit);
  return found;
}

bool lacks_a_part(const Node& object) {
  return std::ranges::any_of(object.children, [](const auto& child) { return child->left_out; });
}

}  // namespace

/// An object that lacks what was left out may fail for that reason alone: this tells nothing new.
void ReadErrors::add(const InputError& error) {
  const bool placed = error.position().line > 0;
  const Node* element = placed ? element_at(root_, error.position()) : nullptr;
  if (element && lacks_a_part(*element)) return;
  const bool is_new = places_.insert(placed ? error.position().to_string() : error.what()).second;
  if (is_new) errors_.push_back(error);
}

/// The next attempt goes without the parameter or part that failed. False: it was no such thing, but the whole
/// object, or is left out already.
bool ReadErrors::leave_out(const InputError& error) {
  if (error.position().line == 0) return false;
  Node* element = element_at(root_, error.position());
  if (!element || element == &root_ || element->left_out) return false;
  const bool whole =
      std::ranges::any_of(root_.children, [&](const auto& child) { return child.get() == element; });
  if (whole) return false;
  element->left_out = true;
  return true;
}

void ReadErrors::attempt(const std::function<void()>& read) {
  for (;;) {
    try {
      return read();
    } catch (const InputError& error) {
      add(error);
      if (errors_.size() >= kMost) throw_if_any();
      if (!leave_out(error)) return;
    }
  }
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
