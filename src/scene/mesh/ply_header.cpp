#include "scene/mesh/ply_header.hpp"

#include <array>
#include <charconv>
#include <optional>
#include <set>

#include "scene/mesh/text.hpp"

namespace kiloband {
namespace {

struct TypeRow {
  PlyType type;
  const char* name;      // original definition
  const char* new_name;  // the common later one
  size_t bytes;
  bool integer;
};

constexpr std::array<TypeRow, 8> kTypes = {{{PlyType::kInt8, "char", "int8", 1, true},
                                            {PlyType::kUint8, "uchar", "uint8", 1, true},
                                            {PlyType::kInt16, "short", "int16", 2, true},
                                            {PlyType::kUint16, "ushort", "uint16", 2, true},
                                            {PlyType::kInt32, "int", "int32", 4, true},
                                            {PlyType::kUint32, "uint", "uint32", 4, true},
                                            {PlyType::kFloat32, "float", "float32", 4, false},
                                            {PlyType::kFloat64, "double", "float64", 8, false}}};

class HeaderReader {
 public:
  explicit HeaderReader(const MeshFile& file) : file_(file), rest_(file.bytes) {}
  PlyHeader read();

 private:
  /// Reads one line's keyword and its arguments.
  /// returns false at end_header
  bool read_line();
  void read_format(LineTokens& tokens);
  void read_element(LineTokens& tokens);
  void read_property(LineTokens& tokens);
  PlyType type(LineTokens& tokens);
  PlyType integer_type(LineTokens& tokens);
  void check_counts() const;
  [[noreturn]] void fail(const std::string& message) const { file_.fail_line(line_, "header: " + message); }

  const MeshFile& file_;
  std::string_view rest_;
  size_t line_ = 0;
  std::optional<PlyFormat> format_;
  PlyHeader header_;
  std::set<std::string> element_names_;
  std::set<std::string> property_names_;  // of the last element
};

PlyHeader HeaderReader::read() {
  line_ = 1;
  LineTokens magic(take_line(rest_));
  if (magic.next() != "ply" || !magic.next().empty()) fail("not a PLY file: the first line must be 'ply'");
  do {
    if (rest_.empty()) fail("the file ends before 'end_header'");
    ++line_;
  } while (read_line());
  if (!format_) fail("no 'format' line");
  header_.format = *format_;
  header_.body_offset = file_.bytes.size() - rest_.size();
  header_.body_line = line_ + 1;
  check_counts();
  return std::move(header_);
}

bool HeaderReader::read_line() {
  LineTokens tokens(take_line(rest_));
  const std::string_view keyword = tokens.next();
  if (keyword == "comment" || keyword == "obj_info" || keyword.empty()) return true;
  if (keyword == "format") {
    read_format(tokens);
  } else if (keyword == "element") {
    read_element(tokens);
  } else if (keyword == "property") {
    read_property(tokens);
  } else if (keyword != "end_header") {
    fail("unknown keyword " + quote_text(keyword));
  }
  if (const auto extra = tokens.next(); !extra.empty())
    fail("unexpected " + quote_text(extra) + " at the end of the line");
  return keyword != "end_header";
}

void HeaderReader::read_format(LineTokens& tokens) {
  if (format_) fail("second 'format' line");
  const std::string_view name = tokens.next();
  if (name == "ascii") format_ = PlyFormat::kAscii;
  if (name == "binary_little_endian") format_ = PlyFormat::kLittleEndian;
  if (name == "binary_big_endian") format_ = PlyFormat::kBigEndian;
  if (!format_)
    fail("format " + quote_text(name) + ": must be ascii, binary_little_endian or binary_big_endian");
  if (const auto version = tokens.next(); version != "1.0")
    fail("version " + quote_text(version) + ": must be 1.0");
}

void HeaderReader::read_element(LineTokens& tokens) {
  PlyElement element;
  element.name = tokens.next();
  element.line = line_;
  if (element.name.empty()) fail("element without a name");
  if (!element_names_.insert(element.name).second) fail("second element " + quote_text(element.name));
  property_names_.clear();
  const std::string_view count = tokens.next();
  const char* end = count.data() + count.size();
  const auto [stop, error] = std::from_chars(count.data(), end, element.count);
  if (count.empty() || error != std::errc() || stop != end) {
    fail("element " + quote_text(element.name) + ": " + quote_text(count) + " is not a count");
  }
  header_.elements.push_back(std::move(element));
}

void HeaderReader::read_property(LineTokens& tokens) {
  if (header_.elements.empty()) fail("property before the first element");
  PlyProperty property;
  LineTokens ahead = tokens;
  property.is_list = ahead.next() == "list";
  if (property.is_list) {
    tokens = ahead;
    property.count_type = integer_type(tokens);
  }
  property.type = type(tokens);
  property.name = tokens.next();
  if (property.name.empty()) fail("property without a name");
  if (!property_names_.insert(property.name).second) {
    fail("element " + quote_text(header_.elements.back().name) + ": second property " +
         quote_text(property.name));
  }
  header_.elements.back().properties.push_back(std::move(property));
}

PlyType HeaderReader::type(LineTokens& tokens) {
  const std::string_view name = tokens.next();
  for (const TypeRow& row : kTypes) {
    if (name == row.name || name == row.new_name) return row.type;
  }
  fail("unknown type " + quote_text(name));
}

PlyType HeaderReader::integer_type(LineTokens& tokens) {
  const PlyType result = type(tokens);
  if (!is_integer(result))
    fail(std::string("list count of type ") + type_name(result) + ": must be an integer type");
  return result;
}

/// Nothing is allocated for an element before its rows are known to fit: a row takes at least the bytes of
/// its scalars and list counts, in text at least one digit and one blank for each.
void HeaderReader::check_counts() const {
  for (const PlyElement& element : header_.elements) {
    size_t row_bytes = 0;
    for (const PlyProperty& property : element.properties) {
      const size_t binary = byte_size(property.is_list ? property.count_type : property.type);
      row_bytes += header_.format == PlyFormat::kAscii ? 2 : binary;
    }
    // The last number of a text needs no blank.
    const size_t available = rest_.size() + (header_.format == PlyFormat::kAscii ? 1 : 0);
    if (row_bytes > 0 && element.count > available / row_bytes) {
      file_.fail_line(element.line, "header: element " + quote_text(element.name) + ": " +
                                        std::to_string(element.count) + " rows of at least " +
                                        std::to_string(row_bytes) + " bytes, but only " +
                                        std::to_string(rest_.size()) + " bytes follow the header");
    }
  }
}

}  // namespace

size_t byte_size(PlyType type) {
  return kTypes[static_cast<size_t>(type)].bytes;
}
bool is_integer(PlyType type) {
  return kTypes[static_cast<size_t>(type)].integer;
}
const char* type_name(PlyType type) {
  return kTypes[static_cast<size_t>(type)].name;
}

int PlyElement::find(const std::string& property_name) const {
  for (size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property_name) return static_cast<int>(i);
  }
  return -1;
}

const PlyElement* PlyHeader::find(const std::string& element_name) const {
  for (const PlyElement& element : elements) {
    if (element.name == element_name) return &element;
  }
  return nullptr;
}

PlyHeader read_ply_header(const MeshFile& file) {
  return HeaderReader(file).read();
}

}  // namespace kiloband
