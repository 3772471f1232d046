// $name parameters of scene files: -D definitions, <default> elements, substitution.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "scene/xml/document.hpp"

namespace kiloband {

class Substitution {
 public:
  /// throws InputError for a name that is not an identifier
  explicit Substitution(const std::vector<std::pair<std::string, std::string>>& defines);

  /// <default>: has no effect if the name is defined already.
  void set_default(const std::string& name, const std::string& value, const Place& place);
  /// Replaces each $name; "\$" stands for the sign itself. Values are not substituted again.
  /// throws InputError at `place`  undefined name, '$' without a name, result too long
  std::string apply(const std::string& text, const Place& place);
  /// throws InputError for a -D that the scene neither uses nor gives a default for
  void check_all_known(const Place& scene) const;

 private:
  struct Parameter {
    std::string value;
    bool known = false;  // the scene mentions it
  };
  const Parameter& look_up(const std::string& name, const Place& place);

  std::map<std::string, Parameter> parameters_;
  std::size_t total_bytes_ = 0;
};

}  // namespace kiloband
