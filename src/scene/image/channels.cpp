#include "scene/image/channels.hpp"

#include <algorithm>

namespace kiloband {
namespace {

int find(const std::vector<std::string>& names, const std::string& name) {
  const auto place = std::find(names.begin(), names.end(), name);
  return place == names.end() ? -1 : static_cast<int>(place - names.begin());
}

/// The channels prefix + R, G, B, or none.
ImageChannels find_rgb(const std::vector<std::string>& names, const std::string& prefix) {
  const int r = find(names, prefix + "R"), g = find(names, prefix + "G"), b = find(names, prefix + "B");
  return r >= 0 && g >= 0 && b >= 0 ? ImageChannels{{r, g, b}, 3} : ImageChannels{};
}

}  // namespace

ImageChannels choose_channels(const std::vector<std::string>& names, int alpha) {
  if (const ImageChannels rgb = find_rgb(names, ""); rgb.count > 0) return rgb;
  const bool is_xyz = find(names, "X") >= 0 || find(names, "Z") >= 0;
  if (const int y = find(names, "Y"); y >= 0 && !is_xyz) return {{y}, 1};
  for (const std::string& name : names) {
    if (!name.ends_with(".R")) continue;
    if (const ImageChannels layer = find_rgb(names, name.substr(0, name.size() - 1)); layer.count > 0)
      return layer;
  }
  const int colours = static_cast<int>(names.size()) - (alpha >= 0 ? 1 : 0);
  if (colours == 1) return {{alpha == 0 ? 1 : 0}, 1};
  return {};
}

bool has_spectra(const std::vector<std::string>& names) {
  return std::ranges::any_of(names, [](const std::string& name) {
    const std::size_t number = name.starts_with("S0.") ? 3 : name.starts_with("T.") ? 2 : name.size();
    const bool has_number = number < name.size() && name[number] >= '0' && name[number] <= '9';
    return has_number && (name.ends_with('m') || name.ends_with("Hz"));
  });
}

}  // namespace kiloband
