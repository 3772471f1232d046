// XML text to a plain tree of elements with exact positions; strict where pugixml is lenient.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"

namespace kiloband {

/// Where a byte stands: line and column are 1-based and count bytes.
/// `file` outlives the tree (SceneTree owns it).
struct Place {
  const std::string* file = nullptr;
  int line = 0;
  int column = 0;

  SourcePosition position() const;
};

[[noreturn]] void fail(const Place& place, const std::string& message);

/// Entities are replaced, tabs and line breaks have become blanks. value_place is the value's first byte.
struct XmlAttribute {
  std::string name;
  std::string value;
  Place place;
  Place value_place;
};

/// `place` is the first byte of the element's name.
struct XmlElement {
  std::string tag;
  Place place;
  std::vector<XmlAttribute> attributes;
  std::vector<XmlElement> children;

  const XmlAttribute* find(std::string_view attribute) const;
};

/// Limits against hostile input. Those of a scene count an included file as often as it is included.
inline constexpr int kMaxNesting = 64;                  // levels of elements, includes and references
inline constexpr std::size_t kMaxElements = 2'000'000;  // of a scene, of every kind
inline constexpr std::size_t kMaxAttributes = 16;       // of an element; none has a use for more than 5
inline constexpr std::size_t kMaxFileBytes = std::size_t{256} << 20;
inline constexpr std::size_t kMaxSceneBytes = std::size_t{1} << 30;

/// What the files of a scene have amounted to so far.
struct XmlTotals {
  std::size_t elements = 0;
  std::size_t bytes = 0;
};

/// Parses one file and adds it to `totals`. Refused besides what pugixml refuses: bad UTF-8, control
/// characters, DOCTYPE, encodings other than UTF-8, text between elements, no or several roots, duplicate
/// attributes, unknown entities, what passes a limit above.
/// throws InputError with position
XmlElement parse_xml(std::string text, const std::string* file, XmlTotals& totals);

}  // namespace kiloband
