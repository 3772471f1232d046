#include "spectral/channels.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "base/error.hpp"
#include "spectral/files/spectrum_units.hpp"
#include "spectral/files/text_table.hpp"

namespace kiloband {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";  // line ends are none: a list is one line

// From gamma rays to radio waves, and Planck's law stays a number.
constexpr double kMinWavelengthNm = 1e-3, kMaxWavelengthNm = 1e9;

/// One interval's rules; `where` is put in front of the message.
void check_interval(const std::string& where, double min_nm, double max_nm) {
  for (const double edge_nm : {min_nm, max_nm})
    if (!std::isfinite(edge_nm) || edge_nm <= 0)
      throw InputError(where + ": wavelength " + format_number(edge_nm) + " nm: must be finite and positive");
  for (const double edge_nm : {min_nm, max_nm})
    if (edge_nm < kMinWavelengthNm || edge_nm > kMaxWavelengthNm)
      throw InputError(where + ": wavelength " + format_number(edge_nm) +
                       " nm: must be from 0.001 to 1e+09 nm");
  if (min_nm == max_nm) throw InputError(where + ": the interval is empty");
  if (min_nm > max_nm)
    throw InputError(where + ": the interval is reversed: " + format_number(min_nm) + " nm is above " +
                     format_number(max_nm) + " nm");
}

void check_count(const std::string& where, std::size_t count) {
  if (count > kMaxChannels)
    throw InputError(where + ": " + std::to_string(count) + " channels: at most " +
                     std::to_string(kMaxChannels));
}

double edge_number(const std::string& where, std::string_view text) {
  const std::optional<double> value = to_number(text);
  if (!value) throw InputError(where + ": " + quote_text(text) + " is not a number");
  return *value;
}

std::size_t parse_count(const std::string& where, std::string_view text) {
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  const bool whole = !text.empty() && end == text.data() + text.size();
  if (whole && error == std::errc::result_out_of_range)
    throw InputError(where + ": " + quote_text(text) + " channels: at most " + std::to_string(kMaxChannels));
  if (!whole || error != std::errc{} || count == 0)
    throw InputError(where + ": count " + quote_text(text) + ": must be a whole number from 1");
  check_count(where, count);
  return count;
}

/// "first:last:count": the edges are first + (last - first) i / count,
/// so that neighbours share their edge exactly.
ChannelList parse_range(const std::string& where, std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t colon; (colon = text.find(':')) != std::string_view::npos; text.remove_prefix(colon + 1))
    parts.push_back(trimmed(text.substr(0, colon), kBlanks));
  parts.push_back(trimmed(text, kBlanks));
  if (parts.size() != 3) throw InputError(where + ": must be FIRST:LAST:COUNT or MIN-MAX, MIN-MAX, ...");
  const double first_nm = edge_number(where, parts[0]);
  const double last_nm = edge_number(where, parts[1]);
  check_interval(where, first_nm, last_nm);
  const std::size_t count = parse_count(where, parts[2]);

  const auto edge_nm = [&](std::size_t i) {
    return i == count ? last_nm
                      : first_nm + (last_nm - first_nm) * static_cast<double>(i) / static_cast<double>(count);
  };
  ChannelList channels(count);
  for (std::size_t i = 0; i < count; ++i) {
    channels[i] = {edge_nm(i), edge_nm(i + 1), {}};
    // Too many channels for the precision of a double.
    check_interval(where, channels[i].min_nm, channels[i].max_nm);
  }
  return channels;
}

/// Where the minus sign between two numbers is: not the first character, and not part of an exponent.
std::size_t find_dash(std::string_view item) {
  for (std::size_t i = 1; i < item.size(); ++i)
    if (item[i] == '-' && item[i - 1] != 'e' && item[i - 1] != 'E') return i;
  return std::string_view::npos;
}

Channel parse_interval(const std::string& where, std::string_view item) {
  if (item.empty()) throw InputError(where + ": an interval is missing");
  const std::size_t dash = find_dash(item);
  if (dash == std::string_view::npos)
    throw InputError(where + ": " + quote_text(item) + ": must be FIRST:LAST:COUNT or MIN-MAX, MIN-MAX, ...");
  const double min_nm = edge_number(where, trimmed(item.substr(0, dash), kBlanks));
  const double max_nm = edge_number(where, trimmed(item.substr(dash + 1), kBlanks));
  check_interval(where + ": " + quote_text(item), min_nm, max_nm);
  return {min_nm, max_nm, {}};
}

/// A first line such as "min_nm,max_nm": no field of it is a number.
bool is_header(const std::vector<std::string_view>& fields) {
  return std::none_of(fields.begin(), fields.end(),
                      [](std::string_view f) { return to_number(f).has_value(); });
}

Channel parse_line(const std::string& where, const std::vector<std::string_view>& fields,
                   WavelengthUnit unit) {
  if (fields.size() != 2) throw InputError(where + ": must be MIN,MAX");
  double min_nm = to_nanometres(edge_number(where, fields[0]), unit);
  double max_nm = to_nanometres(edge_number(where, fields[1]), unit);
  if (unit == WavelengthUnit::kWavenumber) std::swap(min_nm, max_nm);
  check_interval(where, min_nm, max_nm);
  return {min_nm, max_nm, {}};
}

}  // namespace

ChannelList parse_channels(std::string_view text) {
  const std::string where = "bands " + quote_text(text);
  if (trimmed(text, kBlanks).empty()) throw InputError(where + ": no channels");
  if (text.find(':') != std::string_view::npos) return parse_range(where, text);
  check_count(where, 1 + static_cast<std::size_t>(std::count(text.begin(), text.end(), ',')));
  ChannelList channels;
  for (std::size_t comma = 0; comma != std::string_view::npos;) {
    comma = text.find(',');
    channels.push_back(parse_interval(where, trimmed(text.substr(0, comma), kBlanks)));
    if (comma != std::string_view::npos) text.remove_prefix(comma + 1);
  }
  return channels;
}

ChannelList read_channels_file(const std::filesystem::path& file) {
  const std::string text = read_text_file(file);
  ChannelList channels;
  bool first = true;
  WavelengthUnit unit = WavelengthUnit::kNanometre;
  LineReader lines(text);
  for (std::string_view line; lines.next(line);) {
    const std::size_t hash = line.find('#');
    if (hash != std::string_view::npos && first)
      unit = unit_in_comment(file.string(), line.substr(hash + 1)).value_or(unit);
    line = trimmed(line.substr(0, hash), kBlanks);
    if (line.empty()) continue;
    const std::vector<std::string_view> fields = split_fields(line, 4);
    const bool header = first && is_header(fields);
    first = false;
    if (header) unit = unit_of_column(file.string(), line).value_or(unit);
    if (header) continue;
    const std::string where = file.string() + ":" + std::to_string(lines.line_number());
    channels.push_back(parse_line(where, fields, unit));
    check_count(where, channels.size());
  }
  if (channels.empty()) throw InputError(file.string() + ": no channels");
  return channels;
}

Channel hull(const ChannelList& channels) {
  if (channels.empty()) throw std::logic_error("hull of no channels");
  Channel result{channels.front().min_nm, channels.front().max_nm, {}};
  for (const Channel& channel : channels) {
    result.min_nm = std::min(result.min_nm, channel.min_nm);
    result.max_nm = std::max(result.max_nm, channel.max_nm);
  }
  return result;
}

}  // namespace kiloband
