// JSON of requests and answers: what is asked for, checked; numbers as a page can read them.
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cube/cube_io.hpp"

namespace kiloband::viewer {

/// throws InputError  no JSON, more than 16 levels of nesting, no object
nlohmann::json parse_object(std::string_view text);

/// throws InputError  a member that is not among these
void check_members(const nlohmann::json& object, std::initializer_list<std::string_view> known);

/// A member of an object; nothing where it is absent.
/// throws InputError  it is something else, or not finite
std::optional<double> get_number(const nlohmann::json& object, const char* name);
std::optional<std::string> get_text(const nlohmann::json& object, const char* name);
std::optional<bool> get_flag(const nlohmann::json& object, const char* name);
std::optional<std::array<double, 3>> get_triple(const nlohmann::json& object, const char* name);

/// [{"name", "min_nm", "max_nm", "unit", "derived"}]
nlohmann::json channels_json(const std::vector<Band>& bands);
/// Numbers with the digits of single precision; null for what is not finite.
nlohmann::json numbers_json(std::span<const float> values);
nlohmann::json number_json(double value);

/// Invalid UTF-8 is replaced: nothing that a user has named can make an answer fail.
std::string to_text(const nlohmann::json& value);

}  // namespace kiloband::viewer
