#include "viewer/api/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json_dump.hpp"
#include "base/text.hpp"
#include "cube/cube_layout.hpp"

namespace kiloband::viewer {
namespace {

using nlohmann::json;

constexpr int kMostLevels = 16;

/// Null where the member is absent or null.
const json* find_member(const json& object, const char* name) {
  const auto member = object.find(name);
  return member == object.end() || member->is_null() ? nullptr : &*member;
}

[[noreturn]] void refuse(const char* name, const std::string& rule) {
  throw InputError(fmt::format("'{}': must be {}", name, rule));
}

}  // namespace

json parse_object(std::string_view text) {
  int deepest = 0;
  const auto count_levels = [&](int depth, json::parse_event_t, json&) {
    deepest = std::max(deepest, depth);
    return depth <= kMostLevels;  // what is deeper is dropped, not kept
  };
  json value = json::parse(text, count_levels, false);
  if (deepest > kMostLevels) throw InputError("JSON: more than 16 levels");
  if (!value.is_object()) throw InputError("the body must be a JSON object");
  return value;
}

void check_members(const json& object, std::initializer_list<std::string_view> known) {
  for (const auto& [name, value] : object.items()) {
    if (std::ranges::find(known, name) == known.end())
      throw InputError(fmt::format("unknown member {}", quote_text(name)));
  }
}

std::optional<double> get_number(const json& object, const char* name) {
  const json* const member = find_member(object, name);
  if (!member) return std::nullopt;
  if (!member->is_number()) refuse(name, "a number");
  const double value = member->get<double>();
  if (!std::isfinite(value)) refuse(name, "finite");
  return value;
}

std::optional<std::string> get_text(const json& object, const char* name) {
  const json* const member = find_member(object, name);
  if (!member) return std::nullopt;
  if (!member->is_string()) refuse(name, "a text");
  return member->get<std::string>();
}

std::optional<bool> get_flag(const json& object, const char* name) {
  const json* const member = find_member(object, name);
  if (!member) return std::nullopt;
  if (!member->is_boolean()) refuse(name, "true or false");
  return member->get<bool>();
}

std::optional<std::array<double, 3>> get_triple(const json& object, const char* name) {
  const json* const member = find_member(object, name);
  if (!member) return std::nullopt;
  std::array<double, 3> triple{};
  const auto is_finite = [](const json& n) { return n.is_number() && std::isfinite(n.get<double>()); };
  if (!member->is_array() || member->size() != 3 || !std::ranges::all_of(*member, is_finite))
    refuse(name, "three finite numbers");
  for (std::size_t i = 0; i < 3; ++i) triple[i] = (*member)[i].get<double>();
  return triple;
}

json channels_json(const std::vector<Band>& bands) {
  json channels = json::array();
  for (const Band& band : bands) {
    channels.push_back({{"name", band.channel.name.empty() ? band_text(band) : band.channel.name},
                        {"min_nm", band.channel.min_nm},
                        {"max_nm", band.channel.max_nm},
                        {"unit", band.derived ? "" : "W m-2 sr-1 nm-1"},
                        {"derived", band.derived}});
  }
  return channels;
}

json number_json(double value) {
  return std::isfinite(value) ? json(value) : json(nullptr);
}

json numbers_json(std::span<const float> values) {
  json numbers = json::array();
  for (const float value : values) {
    // The shortest decimal of the float, not that of the double that it is.
    numbers.push_back(std::isfinite(value) ? json(std::stod(format_number(value))) : json(nullptr));
  }
  return numbers;
}

std::string to_text(const json& value) {
  return dump_json(value);
}

}  // namespace kiloband::viewer
