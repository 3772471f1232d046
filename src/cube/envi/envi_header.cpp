// The grammar of ENVI headers is small but loose: keys in any case, lists over many lines,
// ';' before comments.
#include "cube/envi/envi_header.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"
#include "files/output_target.hpp"

namespace kiloband {
namespace {

constexpr std::array<std::string_view, 2> kEnviFrameKeys{"major frame offsets", "minor frame offsets"};

/// Next line without its end; advances `position` and `line`.
std::string_view next_line(std::string_view text, std::size_t& position, int& line) {
  const std::size_t end = std::min(text.find('\n', position), text.size());
  const std::string_view result = text.substr(position, end - position);
  position = end + 1;
  ++line;
  return result;
}

/// Of a newer layout we might take the numbers for something else than they are.
void check_layout(const EnviHeader& header) {
  const EnviHeader::Entry* layout = header.find(kEnviLayoutKey);
  if (!layout || layout->value == "1") return;
  const bool newer = parse_unsigned(layout->value).value_or(0) > 1;
  throw InputError(header.where(*layout) + " '" + printable(layout->value) + "': must be 1" +
                   (newer ? ": the file was written by a newer kiloband, take that one to read it" : ""));
}

/// Offsets are bytes before and behind each frame of the data file.
void check_frame_offsets(const EnviHeader& header) {
  for (const std::string_view key : kEnviFrameKeys) {
    const EnviHeader::Entry* entry = header.find(key);
    if (!entry) continue;
    for (const std::string_view offset : split(entry->value, ','))
      if (parse_number(offset) != 0.0)
        throw InputError(header.where(*entry) + " '" + printable(entry->value) +
                         "': must be 0: images with bytes between their frames are not read");
  }
}

}  // namespace

EnviHeader::EnviHeader(const std::filesystem::path& file, std::string_view text) : file_(file) {
  std::size_t position = 0;
  int line = 0;
  const auto fail = [&](int at, const std::string& why) {
    throw InputError(file.string() + ":" + std::to_string(at) + ": " + why);
  };
  // Editors on some systems put a byte-order mark in front.
  if (text.starts_with("\xEF\xBB\xBF")) position = 3;
  if (trimmed(next_line(text, position, line)) != "ENVI")
    fail(1, "not an ENVI header: the first line must be 'ENVI'");
  while (position < text.size()) {
    const std::size_t begin = position;
    const std::string_view content = trimmed(next_line(text, position, line));
    if (content.empty() || content.front() == ';') continue;
    const std::size_t equals = content.find('=');
    if (equals == std::string_view::npos) fail(line, "'" + printable(content) + "': expected 'key = value'");
    Entry entry;
    entry.line = line;
    entry.key = trimmed(content.substr(0, equals));
    entry.lower = lowered(entry.key);
    const std::string_view value = trimmed(content.substr(equals + 1));
    entry.list = value.starts_with('{');
    if (entry.list) {  // up to the closing brace, perhaps many lines below; the rest of its line is dropped
      const std::size_t open = text.find('{', text.find('=', begin));
      const std::size_t close = text.find('}', open);
      if (close == std::string_view::npos) fail(entry.line, printable(entry.key) + ": '{' without '}'");
      entry.value = trimmed(text.substr(open + 1, close - open - 1));
      line = entry.line + static_cast<int>(std::count(text.begin() + begin, text.begin() + close, '\n'));
      position = std::min(text.find('\n', close), text.size()) + 1;
    } else {
      entry.value = value;
    }
    entries_.push_back(std::move(entry));
  }
}

const EnviHeader::Entry* EnviHeader::find(std::string_view lower_key) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const Entry& entry) { return entry.lower == lower_key; });
  return found == entries_.end() ? nullptr : &*found;
}

std::string EnviHeader::where(const Entry& entry) const {
  return file_.string() + ":" + std::to_string(entry.line) + ": " + printable(entry.key);
}

uint64_t EnviHeader::count(std::string_view key, uint64_t largest, std::optional<uint64_t> fallback) const {
  const Entry* entry = find(key);
  if (!entry && fallback) return *fallback;
  if (!entry) throw InputError(file_.string() + ": '" + std::string(key) + "' is missing");
  const auto value = parse_unsigned(entry->value);
  if (!value || *value > largest)
    throw InputError(where(*entry) + " '" + printable(entry->value) + "': must be a whole number, at most " +
                     std::to_string(largest));
  return *value;
}

std::vector<std::string> EnviHeader::texts(std::string_view key, std::size_t size) const {
  const Entry* entry = find(key);
  if (!entry) return {};
  const auto parts = split(entry->value, ',');
  if (parts.size() != size)
    throw InputError(where(*entry) + ": " + std::to_string(parts.size()) + " entries for " +
                     std::to_string(size) + " bands");
  std::vector<std::string> texts;
  for (const std::string_view part : parts) texts.emplace_back(trimmed(part));
  return texts;
}

std::vector<double> EnviHeader::numbers(std::string_view key, std::size_t size) const {
  std::vector<double> values;
  for (const std::string& text : texts(key, size)) {
    const auto value = parse_number(text);
    if (!value || !std::isfinite(*value))
      throw InputError(where(*find(key)) + ": '" + printable(text) + "' is not a number");
    values.push_back(*value);
  }
  return values;
}

uint64_t EnviStorage::bytes_per_value() const {
  // Codes of the format; read_envi_storage lets no others pass.
  switch (data_type) {
    case 1:
      return 1;
    case 2:
    case 12:
      return 2;
    case 5:
    case 14:
    case 15:
      return 8;
    default:
      return 4;
  }
}

EnviStorage read_envi_storage(const EnviHeader& header) {
  check_layout(header);
  EnviStorage storage;
  storage.samples = static_cast<uint32_t>(header.count("samples", kMaxImageEdge));
  storage.lines = static_cast<uint32_t>(header.count("lines", kMaxImageEdge));
  storage.bands = static_cast<uint32_t>(header.count("bands", kMaxChannels));
  for (const char* key : {"samples", "lines", "bands"})
    if (header.count(key, kMaxImageEdge) == 0)
      throw InputError(header.where(*header.find(key)) + " '0': must be at least 1");
  storage.offset = header.count("header offset", uint64_t{1} << 40, 0);
  storage.big_endian = header.count("byte order", 1) == 1;
  storage.data_type = static_cast<int>(header.count("data type", 1000));
  // 6 and 9 are complex; 7, 8, 10 and 11 are not numbers of one pixel.
  constexpr std::array kReadable = {1, 2, 3, 4, 5, 12, 13, 14, 15};
  if (std::find(kReadable.begin(), kReadable.end(), storage.data_type) == kReadable.end())
    throw InputError(header.where(*header.find("data type")) + " '" + std::to_string(storage.data_type) +
                     "': must be 1, 2, 3, 4, 5, 12, 13, 14 or 15 (real numbers)");
  const EnviHeader::Entry* interleave = header.find("interleave");
  if (!interleave) throw InputError(header.file().string() + ": 'interleave' is missing");
  const std::string kind = lowered(interleave->value);
  if (kind != "bsq" && kind != "bil" && kind != "bip")
    throw InputError(header.where(*interleave) + " '" + printable(interleave->value) +
                     "': must be bsq, bil or bip");
  storage.interleave = kind == "bsq"   ? EnviInterleave::kBsq
                       : kind == "bil" ? EnviInterleave::kBil
                                       : EnviInterleave::kBip;
  check_frame_offsets(header);
  return storage;
}

std::filesystem::path envi_stem(const std::filesystem::path& header) {
  std::filesystem::path stem = header;
  return stem.replace_extension();
}

std::filesystem::path envi_output_stem(const std::filesystem::path& header) {
  const OutputTarget target = find_output_target(header);
  return envi_stem(target.special ? header : target.file);
}

std::filesystem::path envi_file(const std::filesystem::path& stem, EnviContent content,
                                const char* extension) {
  std::filesystem::path file = stem;
  if (content == EnviContent::kVariance) file += ".var";
  if (content == EnviContent::kAux) file += ".aux";
  file += extension;
  return file;
}

bool is_envi_part(const EnviHeader& header, EnviContent content) {
  if (!header.find(kEnviLayoutKey)) return false;
  if (content == EnviContent::kAux) return !header.find(kEnviMinKey);  // planes have no wavelengths
  // The first versions had no such key: of their headers only those of variances state an ignored value.
  if (const EnviHeader::Entry* stated = header.find(kEnviContentKey)) return stated->value == "variance";
  return header.find("data ignore value") != nullptr;
}

bool is_reserved_envi_key(std::string_view lower_key) {
  constexpr std::array<std::string_view, 16> kReserved = {
      "description",      "samples",   "lines",      "bands",         "header offset",
      "file type",        "data type", "interleave", "byte order",    "wavelength",
      "wavelength units", "fwhm",      "band names", "default bands", "data ignore value",
      "file compression"};
  return lower_key.starts_with("kiloband ") || std::ranges::count(kEnviFrameKeys, lower_key) > 0 ||
         std::find(kReserved.begin(), kReserved.end(), lower_key) != kReserved.end();
}

}  // namespace kiloband
