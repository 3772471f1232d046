#include "scene/xml/document.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <pugixml.hpp>

#include "base/text.hpp"
#include "base/utf8.hpp"

namespace kiloband {
namespace {

/// Byte offsets to lines and columns. Lines end at '\n'.
class LineTable {
 public:
  LineTable(std::string_view text, const std::string* file) : file_(file), size_(text.size()) {
    starts_.push_back(0);
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\n') starts_.push_back(i + 1);
    }
  }

  Place at(std::size_t offset) const {
    offset = std::min(offset, size_);
    const auto next = std::upper_bound(starts_.begin(), starts_.end(), offset);
    const auto line = static_cast<int>(next - starts_.begin());
    return {file_, line, static_cast<int>(offset - *(next - 1)) + 1};
  }

 private:
  const std::string* file_;
  std::size_t size_;
  std::vector<std::size_t> starts_;
};

void check_characters(std::string_view text, const LineTable& lines) {
  for (std::size_t i = 0; i < text.size();) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c < 0x20 && c != '\t' && c != '\n' && c != '\r') {
      fail(lines.at(i), "control character with code " + std::to_string(c) + " is not allowed in XML");
    }
    const std::size_t length = utf8_length(text, i);
    if (length == 0) fail(lines.at(i), "not valid UTF-8");
    i += length;
  }
}

/// Counts elements by their start tags before memory is taken for any; comments are passed over.
void count_elements(std::string_view text, const LineTable& lines, XmlTotals& totals) {
  for (std::size_t i = text.find('<'); i < text.size(); i = text.find('<', i + 1)) {
    if (text.substr(i).starts_with("<!--")) {
      i = text.find("-->", i + 4);
      if (i == std::string_view::npos) return;  // pugixml says what is wrong
    } else if (i + 1 < text.size() && text[i + 1] != '/' && text[i + 1] != '!' && text[i + 1] != '?' &&
               ++totals.elements > kMaxElements) {
      fail(lines.at(i + 1), "more than " + std::to_string(kMaxElements) +
                                " elements, those of included files counted each time");
    }
  }
}

void check_size(std::string_view text, const LineTable& lines, XmlTotals& totals) {
  if (text.size() > kMaxFileBytes) fail(lines.at(0), "larger than 256 MiB");
  totals.bytes += text.size();
  if (totals.bytes > kMaxSceneBytes)
    fail(lines.at(0), "the files of the scene are larger than 1 GiB together");
}

/// Appends a code point as UTF-8.
void append_utf8(std::string& out, uint32_t code) {
  if (code < 0x80) {
    out += static_cast<char>(code);
  } else if (code < 0x800) {
    out += static_cast<char>(0xC0 | (code >> 6));
    out += static_cast<char>(0x80 | (code & 0x3F));
  } else {
    if (code < 0x10000) {
      out += static_cast<char>(0xE0 | (code >> 12));
    } else {
      out += static_cast<char>(0xF0 | (code >> 18));
      out += static_cast<char>(0x80 | ((code >> 12) & 0x3F));
    }
    out += static_cast<char>(0x80 | ((code >> 6) & 0x3F));
    out += static_cast<char>(0x80 | (code & 0x3F));
  }
}

/// Replaces "#65", "#x41" or a predefined name; false if there is no such character or name.
bool append_entity(std::string& out, std::string_view name) {
  constexpr std::pair<std::string_view, char> kNames[] = {
      {"lt", '<'}, {"gt", '>'}, {"amp", '&'}, {"quot", '"'}, {"apos", '\''}};
  for (const auto& [known, character] : kNames) {
    if (name == known) return out += character, true;
  }
  if (!name.starts_with('#')) return false;
  name.remove_prefix(1);
  const bool hex = name.starts_with('x');
  if (hex) name.remove_prefix(1);
  uint32_t code = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), code, hex ? 16 : 10);
  const bool valid = error == std::errc{} && end == name.data() + name.size() && code >= 0x20 &&
                     code <= 0x10FFFF && (code < 0xD800 || code > 0xDFFF);
  if (valid) append_utf8(out, code);
  return valid;
}

/// Turns pugixml's nodes into XmlElements. Parsing replaces nothing in the buffer,
/// so pointers give exact offsets.
class Converter {
 public:
  Converter(const char* base, const LineTable& lines) : base_(base), lines_(lines) {}

  XmlElement document(const pugi::xml_document& document) {
    pugi::xml_node root;
    for (const pugi::xml_node node : document.children()) {
      if (node.type() == pugi::node_declaration) {
        check_encoding(node);
      } else if (node.type() != pugi::node_element) {
        refuse(node);
      } else if (root) {
        fail(place(node), std::string("a second root element <") + node.name() + ">");
      } else {
        root = node;
      }
    }
    if (!root) fail(lines_.at(0), "no root element");
    return element(root, 1);
  }

 private:
  Place place(const pugi::xml_node& node) const {
    return lines_.at(static_cast<std::size_t>(node.offset_debug()));
  }
  Place place(const char* text) const { return lines_.at(static_cast<std::size_t>(text - base_)); }

  void check_encoding(const pugi::xml_node& declaration) const {
    const std::string encoding = lowered(declaration.attribute("encoding").value());
    if (!encoding.empty() && encoding != "utf-8" && encoding != "us-ascii") {
      fail(place(declaration.attribute("encoding").value()),
           "encoding '" + encoding + "' is not supported: use UTF-8");
    }
  }

  [[noreturn]] void refuse(const pugi::xml_node& node) const {
    if (node.type() == pugi::node_doctype) fail(place(node), "document type declarations are not supported");
    const char* text = node.value();
    fail(place(text + std::strspn(text, " \t\r\n")), "text between elements is not allowed");
  }

  std::string decode(const char* raw) const {
    std::string out;
    for (const char* c = raw; *c; ++c) {
      if (*c == '<') fail(place(c), "'<' in an attribute value: write &lt;");
      if (*c != '&') {
        out += *c == '\t' || *c == '\n' || *c == '\r' ? ' ' : *c;
        continue;
      }
      const char* end = c + std::strcspn(c, "; ");
      const std::string name(c + 1, end);
      if (*end != ';' || !append_entity(out, name))
        fail(place(c), "unknown entity '&" + name.substr(0, 20) + "'");
      c = end;
    }
    return out;
  }

  XmlAttribute attribute(const XmlElement& owner, const pugi::xml_attribute& source) const {
    if (owner.find(source.name())) {
      fail(place(source.name()), std::string("attribute '") + source.name() + "' is given twice");
    }
    return {source.name(), decode(source.value()), place(source.name()), place(source.value())};
  }

  XmlElement element(const pugi::xml_node& node, int depth) {
    XmlElement result{node.name(), place(node), {}, {}};
    if (depth > kMaxNesting)
      fail(result.place, "nested more than " + std::to_string(kMaxNesting) + " levels deep");
    for (const pugi::xml_attribute source : node.attributes()) {
      result.attributes.push_back(attribute(result, source));
      if (result.attributes.size() > kMaxAttributes)
        fail(result.attributes.back().place,
             "<" + result.tag + ">: more than " + std::to_string(kMaxAttributes) + " attributes");
    }
    for (const pugi::xml_node child : node.children()) {
      if (child.type() != pugi::node_element) refuse(child);
      result.children.push_back(element(child, depth + 1));
    }
    return result;
  }

  const char* base_;
  const LineTable& lines_;
};

/// Where the tag at `at` ends; '>' in attribute values does not count.
std::size_t end_of_tag(std::string_view text, std::size_t at) {
  for (char quote = 0; at < text.size(); ++at) {
    if (quote == 0 && text[at] == '>') return at;
    if (quote == 0 && (text[at] == '"' || text[at] == '\''))
      quote = text[at];
    else if (text[at] == quote)
      quote = 0;
  }
  return text.size();
}

/// ": <shape> of line 3 is not closed" for the innermost element that is open at the end, or where another is closed.
std::string unclosed_element(std::string_view text, const LineTable& lines) {
  std::vector<std::pair<std::string_view, std::size_t>> open;  // names and places
  for (std::size_t at = text.find('<'); at < text.size(); at = text.find('<', at)) {
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("<!") || rest.starts_with("<?")) {
      const std::string_view end = rest.starts_with("<!--") ? "-->" : rest.starts_with("<?") ? "?>" : ">";
      at = std::min(text.find(end, at), text.size());
      continue;
    }
    const std::size_t end = end_of_tag(text, at);
    const bool closes = rest.starts_with("</");
    std::string_view name = text.substr(at + (closes ? 2 : 1), end - at - (closes ? 2 : 1));
    const bool is_empty = name.ends_with('/');
    name = name.substr(0, name.find_first_of(" \t\r\n/"));
    if (closes && (open.empty() || open.back().first != name)) break;
    if (closes) open.pop_back();
    if (!closes && !is_empty) open.emplace_back(name, at + 1);
    at = end;
  }
  if (open.empty()) return {};
  return ": <" + std::string(open.back().first.substr(0, 40)) + "> of line " +
         std::to_string(lines.at(open.back().second).line) + " is not closed";
}

}  // namespace

SourcePosition Place::position() const {
  return {file ? *file : std::string(), line, column};
}

void fail(const Place& place, const std::string& message) {
  throw InputError(place.position(), message);
}

const XmlAttribute* XmlElement::find(std::string_view attribute) const {
  for (const XmlAttribute& candidate : attributes) {
    if (candidate.name == attribute) return &candidate;
  }
  return nullptr;
}

XmlElement parse_xml(std::string text, const std::string* file, XmlTotals& totals) {
  const LineTable lines(text, file);
  check_size(text, lines, totals);
  check_characters(text, lines);
  count_elements(text, lines, totals);
  // No escapes, no white space conversion: the buffer stays as it is, and undefined entities remain visible.
  constexpr unsigned kFlags =
      pugi::parse_fragment | pugi::parse_cdata | pugi::parse_doctype | pugi::parse_declaration;
  constexpr std::size_t kMostCopied = std::size_t{1} << 24;  // parsing cuts names out of the text
  const std::string copy = text.size() <= kMostCopied ? text : std::string();
  pugi::xml_document document;
  const auto result = document.load_buffer_inplace(text.data(), text.size(), kFlags, pugi::encoding_utf8);
  if (!result) {
    const bool is_open = result.status == pugi::status_end_element_mismatch;
    fail(lines.at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0))),
         std::string("not well-formed XML: ") + result.description() +
             (is_open ? unclosed_element(copy, lines) : ""));
  }
  return Converter(text.data(), lines).document(document);
}

}  // namespace kiloband
