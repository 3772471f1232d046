// Channels: the wavelength intervals that an image is made of.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace kiloband {

/// One channel: the interval [min_nm, max_nm], min < max.
/// `name` is empty for channels without a name of their own.
struct Channel {
  double min_nm = 0;
  double max_nm = 0;
  std::string name;

  double width_nm() const { return max_nm - min_nm; }
  double centre_nm() const { return 0.5 * (min_nm + max_nm); }
};

/// Any number of channels in the user's order; they may overlap, leave gaps and differ in width.
using ChannelList = std::vector<Channel>;

/// Parses "380:780:40" (first edge : last edge : count of equal channels, nm) or "400-410, 450-500".
/// throws InputError  with the text and the rule it breaks (reversed or empty interval, count 0, not a
///                    number, more than kMaxChannels, wavelengths that are not finite and positive)
ChannelList parse_channels(std::string_view text);

/// Reads a CSV of "min,max" per line (header line, '#' comments; both may state another unit than nm).
/// throws InputError  "file:line: ..."
ChannelList read_channels_file(const std::filesystem::path& file);

/// The hull [smallest min, largest max] of a non-empty list, nm.
Channel hull(const ChannelList& channels);

inline constexpr std::size_t kMaxChannels = 1u << 20;

}  // namespace kiloband
