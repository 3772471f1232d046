// Text files of numbers: reading a file whole, walking over its lines, numbers without locale.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text.hpp"

namespace kiloband {

/// Largest text file that is read into memory, bytes.
inline constexpr std::size_t kMaxTextBytes = std::size_t{1} << 28;

/// The file's bytes; a UTF-8 byte order mark is dropped.
/// throws InputError  "file: cannot be opened", "file: is not a regular file", "file: ... bytes: at most ..."
std::string read_text_file(const std::filesystem::path& file, std::size_t max_bytes = kMaxTextBytes);

/// Walks over the lines of a text: LF, CRLF or CR LF endings, no line ending in the result.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}
  /// False at the end of the text.
  bool next(std::string_view& line);
  /// 1-based number of the line that `next` returned last.
  int line_number() const { return line_number_; }

 private:
  std::string_view rest_;
  int line_number_ = 0;
};

/// Fields between commas (or semicolons), blanks around them removed; without either, between blanks. A line
/// with more than `max_fields` fields is cut there: what follows is in the last field.
std::vector<std::string_view> split_fields(std::string_view line,
                                           std::size_t max_fields = std::string_view::npos);

/// The number that the whole of `text` spells (a leading '+' is allowed; "nan" and "inf" are numbers); empty
/// otherwise. A number too large for a double is infinite, one too small is 0.
std::optional<double> to_number(std::string_view text);

/// "file:line: message".
std::string at_line(const std::filesystem::path& file, int line, const std::string& message);

}  // namespace kiloband
