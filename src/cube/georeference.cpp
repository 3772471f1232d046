#include "cube/georeference.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cube/band_lists.hpp"
#include "cube/cube_text.hpp"

namespace kiloband {
namespace {

using Metadata = std::map<std::string, std::string>;

constexpr char kLeftOut[] = "left out: it is of the image before it was cropped";

/// Keys of ENVI may be in any case.
Metadata::iterator find_entry(Metadata& metadata, std::string_view lower_key) {
  return std::ranges::find_if(metadata, [&](const auto& entry) { return lowered(entry.first) == lower_key; });
}

/// "1.5" plus a number of pixels.
std::optional<std::string> moved(std::string_view number, double by) {
  const auto value = parse_number(number);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return format_number(*value + by);
}

/// "{UTM, 1, 1, ...}": a pixel of the image, whose coordinates follow. Whether the first pixel is (1, 1) or (0, 0),
/// the same place has less in an image that begins later.
std::optional<std::string> moved_map_info(const std::string& value, uint32_t x0, uint32_t y0) {
  if (!is_list(value)) return std::nullopt;
  const std::string inside = value.substr(1, value.size() - 2);
  const std::vector<std::string_view> parts = split(inside, ',');
  if (parts.size() < 3) return std::nullopt;
  const auto x = moved(parts[1], -static_cast<double>(x0)), y = moved(parts[2], -static_cast<double>(y0));
  if (!x || !y) return std::nullopt;
  std::string list = "{" + std::string(trimmed(parts[0])) + ", " + *x + ", " + *y;
  for (std::size_t i = 3; i < parts.size(); ++i) list += ", " + std::string(trimmed(parts[i]));
  return list + "}";
}

/// To the new value, or away where there is none.
void move_or_drop(Metadata& metadata, Metadata::iterator entry, const std::optional<std::string>& value,
                  const DiagnosticSink& sink) {
  if (value) {
    entry->second = *value;
    return;
  }
  note(sink, {}, entry->first + " '" + printable(entry->second) + "': not understood, so it is " + kLeftOut);
  metadata.erase(entry);
}

/// Of the corner in a larger image, from which others link the two: 1 where only the other one is stated. So none is left without the
/// other.
void move_starts(Metadata& metadata, uint32_t x0, uint32_t y0, const DiagnosticSink& sink) {
  const std::pair<std::string_view, uint32_t> starts[] = {{"x start", x0}, {"y start", y0}};
  bool understood = true;
  for (const auto& [key, by] : starts) {
    auto entry = find_entry(metadata, key);
    if (entry == metadata.end()) entry = metadata.emplace(key, "1").first;
    const auto value = moved(entry->second, by);
    understood = understood && value;
    move_or_drop(metadata, entry, value, sink);
  }
  for (const auto& [key, by] : starts)
    if (const auto entry = find_entry(metadata, key); !understood && entry != metadata.end()) {
      note(sink, {}, entry->first + ": " + kLeftOut);
      metadata.erase(entry);
    }
}

}  // namespace

void crop_georeference(CubeInfo& info, uint32_t x0, uint32_t y0, const DiagnosticSink& sink) {
  if (x0 == 0 && y0 == 0) return;
  Metadata& metadata = info.metadata;
  for (const char* key : {"geo points", "rpc info"})
    if (const auto entry = find_entry(metadata, key); entry != metadata.end()) {
      note(sink, {}, entry->first + ": " + kLeftOut);
      metadata.erase(entry);
    }
  if (const auto entry = find_entry(metadata, "map info"); entry != metadata.end())
    move_or_drop(metadata, entry, moved_map_info(entry->second, x0, y0), sink);
  if (find_entry(metadata, "x start") == metadata.end() && find_entry(metadata, "y start") == metadata.end())
    return;
  move_starts(metadata, x0, y0, sink);
}

}  // namespace kiloband
