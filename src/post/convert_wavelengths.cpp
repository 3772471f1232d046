// Wavelengths for bands that have names only (convert.hpp).
#include <set>

#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"
#include "post/convert_bands.hpp"

namespace kiloband {
namespace {

/// "red=600-700": the last '=' separates, so that names may contain it.
Channel parse_entry(std::string_view entry) {
  const std::size_t equals = entry.rfind('=');
  const std::string name(trimmed(entry.substr(0, equals)));
  if (equals == std::string_view::npos || name.empty())
    throw InputError("wavelengths '" + printable(entry) +
                     "': must be NAME=MIN-MAX in nm, such as red=600-700");
  const ChannelList one = parse_channels(trimmed(entry.substr(equals + 1)));
  if (one.size() != 1)
    throw InputError("wavelengths '" + printable(entry) + "': must be one interval such as 600-700");
  return {one[0].min_nm, one[0].max_nm, name};
}

bool has_wavelengths(const Band& band) {
  return !band.derived || band.channel.max_nm > band.channel.min_nm;
}

std::size_t find_band(const std::vector<Band>& bands, const std::string& name) {
  std::string known;
  for (std::size_t k = 0; k < bands.size(); ++k) {
    if (bands[k].channel.name == name && !has_wavelengths(bands[k])) return k;
    if (bands[k].channel.name == name)
      throw InputError("wavelengths of band '" + printable(name) + "': the cube states them itself");
    if (!has_wavelengths(bands[k]) && known.size() < 200)
      known += ", '" + printable(bands[k].channel.name) + "'";
  }
  throw InputError("wavelengths of band '" + printable(name) + "': the cube has no such band" +
                   (known.empty() ? "; all of its bands have wavelengths"
                                  : "; without wavelengths are " + known.substr(2)));
}

}  // namespace

ChannelList parse_band_wavelengths(std::string_view text) {
  ChannelList named;
  std::set<std::string> names;
  for (const std::string_view line : split(text, '\n')) {
    for (const std::string_view entry : split(line.substr(0, line.find('#')), ',')) {
      if (trimmed(entry).empty()) continue;
      named.push_back(parse_entry(trimmed(entry)));
      if (!names.insert(named.back().name).second)
        throw InputError("wavelengths of band '" + printable(named.back().name) + "': given twice");
    }
  }
  if (named.empty())
    throw InputError("wavelengths: none are given (NAME=MIN-MAX in nm, such as red=600-700)");
  return named;
}

NamedBands give_wavelengths(const std::vector<Band>& bands, const ChannelList& named) {
  NamedBands result{bands, {}};
  for (const Channel& channel : named) {
    const std::size_t k = find_band(result.bands, channel.name);
    result.bands[k] = {channel, false};
    result.order.push_back(k);
  }
  const std::set<std::size_t> given(result.order.begin(), result.order.end());
  for (std::size_t k = 0; k < bands.size(); ++k)
    if (!given.contains(k)) result.order.push_back(k);
  return result;
}

}  // namespace kiloband
