#include "spectral/files/text_table.hpp"

#include <algorithm>
#include <fstream>

#include "base/error.hpp"
#include "base/number.hpp"

namespace kiloband {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/// Fields between blanks; runs of blanks count once.
void split_blanks(std::string_view line, std::size_t max_fields, std::vector<std::string_view>& fields) {
  std::size_t at = 0;
  while (at < line.size()) {
    while (at < line.size() && is_blank(line[at])) ++at;
    if (at == line.size()) break;
    std::size_t end = at;
    while (end < line.size() && !is_blank(line[end])) ++end;
    if (fields.size() + 1 == max_fields) end = line.size();
    fields.push_back(line.substr(at, end - at));
    at = end;
  }
}

}  // namespace

std::string read_text_file(const std::filesystem::path& file, std::size_t max_bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw InputError(file.string() + ": cannot be opened: no such file");
  // A directory opens and a device never ends: only regular files have a size that can be checked beforehand.
  if (!std::filesystem::is_regular_file(status)) throw InputError(file.string() + ": is not a regular file");
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) throw InputError(file.string() + ": cannot be opened: " + error.message());
  if (size > max_bytes)
    throw InputError(file.string() + ": " + std::to_string(size) + " bytes: at most " +
                     std::to_string(max_bytes));
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string() + ": cannot be opened");
  std::string text(static_cast<std::size_t>(size), '\0');
  stream.read(text.data(), static_cast<std::streamsize>(size));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  if (text.find('\n') == std::string::npos)
    std::ranges::replace(text, '\r', '\n');  // old Macs' ends of lines
  return text;
}

bool LineReader::next(std::string_view& line) {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find('\n');
  line = rest_.substr(0, end);
  rest_ = end == std::string_view::npos ? std::string_view{} : rest_.substr(end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  ++line_number_;
  return true;
}

std::vector<std::string_view> split_fields(std::string_view line, std::size_t max_fields) {
  std::vector<std::string_view> fields;
  const std::size_t first_separator = line.find_first_of(",;");
  if (first_separator == std::string_view::npos) {
    split_blanks(line, max_fields, fields);
    return fields;
  }
  const char separator = line[first_separator];
  while (fields.size() + 1 < max_fields) {
    const std::size_t end = line.find(separator);
    fields.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    line = line.substr(end + 1);
  }
  fields.push_back(trimmed(line));
  return fields;
}

std::optional<double> to_number(std::string_view text) {
  double value = 0;
  if (read_number(text, value) == NumberText::kNone) return std::nullopt;
  return value;
}

std::string at_line(const std::filesystem::path& file, int line, const std::string& message) {
  return file.string() + ":" + std::to_string(line) + ": " + message;
}

}  // namespace kiloband
