#include "scene/xml/substitute.hpp"

#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

// Defaults may contain earlier defaults, so that lengths can double with each line: both limits are needed.
constexpr std::size_t kMaxValueBytes = std::size_t{16} << 20;
constexpr std::size_t kMaxTotalBytes = std::size_t{256} << 20;
constexpr std::size_t kMostSuggestions = 1000;  // names that a misspelt one is compared with

bool is_name_start(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_name_part(char c) {
  return is_name_start(c) || (c >= '0' && c <= '9');
}

bool is_name(std::string_view text) {
  if (text.empty() || !is_name_start(text[0])) return false;
  for (const char c : text) {
    if (!is_name_part(c)) return false;
  }
  return true;
}

}  // namespace

Substitution::Substitution(const std::vector<std::pair<std::string, std::string>>& defines) {
  for (const auto& [name, value] : defines) {
    if (!is_name(name))
      throw InputError("-D " + name + "=" + value + ": '" + name + "' is not a parameter name");
    parameters_[name] = {value, false};
  }
}

void Substitution::set_default(const std::string& name, const std::string& value, const Place& place) {
  if (!is_name(name)) fail(place, "'" + name + "' is not a parameter name");
  parameters_.try_emplace(name, Parameter{value, true}).first->second.known = true;
}

const Substitution::Parameter& Substitution::look_up(const std::string& name, const Place& place) {
  const auto found = parameters_.find(name);
  if (found == parameters_.end()) {
    std::vector<std::string_view> names;
    for (const auto& entry : parameters_) {
      if (names.size() < kMostSuggestions) names.push_back(entry.first);
    }
    fail(place, "parameter '$" + name + "' is not defined (neither by <default> nor by -D)" +
                    suggestion(name, names));
  }
  found->second.known = true;
  return found->second;
}

std::string Substitution::apply(const std::string& text, const Place& place) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == '\\' && i + 1 < text.size() && text[i + 1] == '$') {
      result += '$';
      i += 2;
    } else if (text[i] != '$') {
      result += text[i++];
    } else {
      std::size_t end = ++i;
      if (end < text.size() && is_name_start(text[end])) {
        while (end < text.size() && is_name_part(text[end])) ++end;
      }
      if (end == i) fail(place, "'$' without a parameter name: write \\$ for the sign itself");
      result += look_up(text.substr(i, end - i), place).value;
      total_bytes_ += result.size();
      i = end;
    }
    if (result.size() > kMaxValueBytes || total_bytes_ > kMaxTotalBytes)
      fail(place, "too much text after substitution");
  }
  return result;
}

void Substitution::check_all_known(const Place& scene) const {
  std::vector<std::string_view> names;
  for (const auto& [name, parameter] : parameters_) {
    if (parameter.known && names.size() < kMostSuggestions) names.push_back(name);
  }
  for (const auto& [name, parameter] : parameters_) {
    if (!parameter.known)
      fail({scene.file, 0, 0}, "-D " + name + "=" + parameter.value + ": the scene has no parameter '$" +
                                   name + "'" + suggestion(name, names));
  }
}

}  // namespace kiloband
