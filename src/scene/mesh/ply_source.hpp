// The two ways in which a PLY body stores numbers, behind one shape: read() one number,
// problem(), fail(), finish().
#pragma once

#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "scene/mesh/binary.hpp"
#include "scene/mesh/ply_header.hpp"
#include "scene/mesh/text.hpp"

namespace kiloband {

/// Numbers as text, separated by blanks or newlines.
class PlyTextSource {
 public:
  PlyTextSource(const MeshFile& file, const PlyHeader& header)
      : file_(file), tokens_(std::string_view(file.bytes).substr(header.body_offset), header.body_line) {}

  /// The next number into `value`: finite, and for integer types a whole number in the type's range.
  /// returns false with problem() set
  bool read(PlyType type, double& value) {
    const std::string_view token = tokens_.next();
    if (token.empty()) return refuse("the file ends too early");
    if (const char* problem = parse_number(token, value)) return refuse(quote_text(token) + " " + problem);
    if (is_integer(type) && !fits(type, value))
      return refuse(quote_text(token) + " is not of type " + type_name(type));
    return true;
  }

  const std::string& problem() const { return problem_; }
  [[noreturn]] void fail(const std::string& message) const { file_.fail_line(tokens_.line(), message); }
  /// throws InputError  if anything is left
  void finish() {
    if (const auto token = tokens_.next(); !token.empty())
      fail("unexpected " + quote_text(token) + " after the last element");
  }

 private:
  static bool fits(PlyType type, double value) {
    const bool is_signed = type == PlyType::kInt8 || type == PlyType::kInt16 || type == PlyType::kInt32;
    const double values = std::ldexp(1.0, static_cast<int>(8 * byte_size(type)));
    const double low = is_signed ? -values / 2 : 0;
    return value == std::floor(value) && value >= low && value < low + values;
  }
  bool refuse(std::string problem) {
    problem_ = std::move(problem);
    return false;
  }

  const MeshFile& file_;
  TokenStream tokens_;
  std::string problem_;
};

/// Numbers in binary, of the header's byte order, without padding.
class PlyBinarySource {
 public:
  PlyBinarySource(const MeshFile& file, const PlyHeader& header)
      : file_(file),
        order_(header.format == PlyFormat::kLittleEndian ? std::endian::little : std::endian::big),
        begin_(header.body_offset),
        end_(begin_) {}

  /// As PlyTextSource; floats need not be finite.
  bool read(PlyType type, double& value) {
    begin_ = end_;
    if (file_.bytes.size() - begin_ < byte_size(type)) return false;
    end_ = begin_ + byte_size(type);
    value = load(type, file_.bytes.data() + begin_);
    return true;
  }

  std::string problem() const { return "the file ends too early"; }
  [[noreturn]] void fail(const std::string& message) const { file_.fail_byte(begin_, message); }
  void finish() {
    begin_ = end_;
    const size_t left = file_.bytes.size() - begin_;
    if (left > 0) fail(std::to_string(left) + " unexpected bytes after the last element");
  }

 private:
  double load(PlyType type, const char* bytes) const {
    switch (type) {
      case PlyType::kInt8:
        return load_number<int8_t>(bytes, order_);
      case PlyType::kUint8:
        return load_number<uint8_t>(bytes, order_);
      case PlyType::kInt16:
        return load_number<int16_t>(bytes, order_);
      case PlyType::kUint16:
        return load_number<uint16_t>(bytes, order_);
      case PlyType::kInt32:
        return load_number<int32_t>(bytes, order_);
      case PlyType::kUint32:
        return load_number<uint32_t>(bytes, order_);
      case PlyType::kFloat32:
        return load_number<float>(bytes, order_);
      case PlyType::kFloat64:
        return load_number<double>(bytes, order_);
    }
    return 0;
  }

  const MeshFile& file_;
  std::endian order_;
  size_t begin_;  // of the number read last
  size_t end_;
};

}  // namespace kiloband
