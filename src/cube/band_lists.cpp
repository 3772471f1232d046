#include "cube/band_lists.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "cube/cube_text.hpp"

namespace kiloband {
namespace {

constexpr std::array<std::string_view, 6> kOfBands{"bbl",
                                                   "data gain values",
                                                   "data offset values",
                                                   "data reflectance gain values",
                                                   "data reflectance offset values",
                                                   "solar irradiance"};

std::string picked_list(const std::vector<std::string_view>& entries,
                        const std::vector<std::size_t>& picked) {
  std::string list;
  for (const std::size_t band : picked)
    list += (list.empty() ? "{" : ", ") + std::string(trimmed(entries[band]));
  return list + "}";
}

}  // namespace

bool is_list(const std::string& value) {
  const auto control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  return value.size() >= 2 && value.front() == '{' && value.find_first_of("{}", 1) == value.size() - 1 &&
         value.back() == '}' && std::ranges::none_of(value, control);
}

void pick_band_lists(std::map<std::string, std::string>& metadata, std::size_t bands,
                     const std::vector<std::size_t>& picked) {
  for (auto entry = metadata.begin(); entry != metadata.end();) {
    auto& [key, value] = *entry;
    const bool of_bands = std::ranges::find(kOfBands, lowered(key)) != kOfBands.end() && is_list(value);
    const std::string inside = of_bands ? value.substr(1, value.size() - 2) : std::string();
    const std::vector<std::string_view> entries = split(inside, ',');
    if (!of_bands || entries.size() != bands) {
      ++entry;
    } else if (picked.empty()) {
      entry = metadata.erase(entry);
    } else {
      value = picked_list(entries, picked);
      ++entry;
    }
  }
}

}  // namespace kiloband
