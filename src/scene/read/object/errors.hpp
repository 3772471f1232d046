// All that is wrong with a scene in one run, instead of one error per run.
#pragma once

#include <cstddef>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "scene/xml/tree.hpp"

namespace kiloband {

/// Collects InputErrors of the objects of a scene, each place once. An object that failed at one of its parameters
/// or parts, or at those of an object that it refers to, is read again without that (Node::left_out), as long as
/// this finds more.
class ReadErrors {
 public:
  static constexpr std::size_t kMost = 20;

  explicit ReadErrors(Node& root) : root_(root) {}

  /// Runs the reader of an object, which may be called several times.
  /// throws InputError  all errors, once there are kMost
  void attempt(const std::function<void()>& read);
  /// throws InputError  whose what() has a line for each error, in the order of the text, if there are any
  void throw_if_any() const;

 private:
  void add(const InputError& error);

  Node& root_;
  std::vector<InputError> errors_;
  std::set<std::string> places_;
};

}  // namespace kiloband
