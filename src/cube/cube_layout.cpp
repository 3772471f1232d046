// Limits, checks and arithmetic that EXR and ENVI have in common.
#include "cube/cube_layout.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "cube/cube_text.hpp"

namespace kiloband {
namespace {

/// A name must fit into every format with its prefixes and suffixes, and into one line of a header.
/// what   whose name it is, for the message
void check_name(const std::string& name, const std::string& what, const std::string& where) {
  if (name.size() > kMaxNameLength)
    throw InputError(where + ": " + what + " '" + printable(name) + "': longer than " +
                     std::to_string(kMaxNameLength) + " bytes");
  if (std::any_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }))
    throw InputError(where + ": " + what + " '" + printable(name) + "': contains a control character");
}

/// Ordinary bands need a width that values can be divided by; derived ones only a name.
void check_band(const Band& band, std::size_t index, const std::string& where) {
  const Channel& c = band.channel;
  const std::string what = "band " + std::to_string(index);
  check_name(c.name, what, where);
  if (!std::isfinite(c.min_nm) || !std::isfinite(c.max_nm))
    throw InputError(where + ": " + what + ": wavelengths must be finite");
  if (band.derived) {
    if (c.name.empty()) throw InputError(where + ": " + what + ": a derived band must have a name");
  } else if (!(c.min_nm > 0 && c.min_nm < c.max_nm)) {
    throw InputError(where + ": " + what + ": interval " + format_number(c.min_nm) + "-" +
                     format_number(c.max_nm) + " nm: must be positive and ascending");
  }
}

}  // namespace

void check_cube_info(const CubeInfo& info, const std::string& where) {
  for (const uint32_t edge : {info.width, info.height})
    if (edge == 0 || edge > kMaxImageEdge)
      throw InputError(where + ": image size " + std::to_string(info.width) + "x" +
                       std::to_string(info.height) + ": must be between 1 and " +
                       std::to_string(kMaxImageEdge));
  if (info.bands.empty() || info.bands.size() > kMaxChannels)
    throw InputError(where + ": " + std::to_string(info.bands.size()) + " bands: must be between 1 and " +
                     std::to_string(kMaxChannels));
  if (info.aux.size() > kMaxAuxPlanes)
    throw InputError(where + ": " + std::to_string(info.aux.size()) + " auxiliary planes: at most " +
                     std::to_string(kMaxAuxPlanes));
  for (std::size_t k = 0; k < info.bands.size(); ++k) check_band(info.bands[k], k, where);
  std::set<std::string> names;
  for (const std::string& name : info.aux) {
    check_name(name, "auxiliary plane", where);
    if (name.empty()) throw InputError(where + ": an auxiliary plane must have a name");
    if (!names.insert(name).second)
      throw InputError(where + ": auxiliary plane '" + printable(name) + "': given twice");
  }
}

std::string band_text(const Band& band) {
  if (band.derived) return std::string("'") + printable(band.channel.name) + "'";
  return format_short(band.channel.min_nm) + "-" + format_short(band.channel.max_nm) + " nm";
}

ChannelList channels_of(const std::vector<Band>& bands) {
  ChannelList channels;
  for (const Band& band : bands)
    if (!band.derived) channels.push_back(band.channel);
  return channels;
}

double without_roundings(double nm) {
  return std::round(nm * 1e9) / 1e9;
}

std::string metadata_of(const CubeInfo& info, const std::string& key) {
  const auto found = info.metadata.find(key);
  return found == info.metadata.end() ? std::string() : found->second;
}

QuantityConversion::QuantityConversion(const std::vector<Band>& bands, Quantity from, Quantity to)
    : divide_(from == Quantity::kIntegral), same_(from == to) {
  width_.reserve(bands.size());
  for (const Band& band : bands) width_.push_back(from == to || band.derived ? 1.0 : band.channel.width_nm());
}

StripOrder::StripOrder(const CubeInfo& info, uint32_t rows_per_strip)
    : width_(info.width),
      height_(info.height),
      bands_(info.bands.size()),
      aux_(info.aux.size()),
      variance_(info.variance),
      rows_per_strip_(rows_per_strip) {
  if (rows_per_strip == 0 || (rows_per_strip % 32 != 0 && rows_per_strip != info.height))
    throw std::logic_error("cube writer: rows per strip must be a multiple of 32 or the height");
}

void StripOrder::accept(const CubeRows& strip) {
  // Only the last strip may be shorter: EXR tiles and ENVI blocks would be torn otherwise.
  const uint64_t expected = std::min<uint64_t>(rows_per_strip_, height_ - next_row_);
  if (finished_ || strip.y0 != next_row_ || strip.rows != expected || strip.rows == 0)
    throw std::logic_error("cube writer: strips must come once, whole and in ascending order");
  const uint64_t pixels = width_ * strip.rows;
  if (strip.mean.size() != pixels * bands_ || strip.variance.size() != (variance_ ? pixels * bands_ : 0) ||
      strip.aux.size() != pixels * aux_)
    throw std::logic_error("cube writer: a strip's buffers do not fit the cube");
  next_row_ += strip.rows;
}

void StripOrder::finish() {
  if (finished_ || next_row_ != height_) throw std::logic_error("cube writer: finish() before the last row");
  finished_ = true;
}

void check_read(const CubeInfo& info, uint32_t y0, uint32_t rows, std::size_t floats, std::size_t planes) {
  if (uint64_t{y0} + rows > info.height) throw std::logic_error("cube reader: rows outside the image");
  if (floats != std::size_t{rows} * info.width * planes)
    throw std::logic_error("cube reader: a buffer does not fit the rows");
}

ChannelList channels_from_centres(const std::vector<double>& centres_nm, const std::string& where) {
  // Neighbours are those in the spectrum, not those in the file: sort indices,
  // keep the file's order in the result.
  std::vector<std::size_t> order(centres_nm.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return centres_nm[a] < centres_nm[b]; });
  ChannelList channels(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double centre = centres_nm[order[i]];
    const bool first = i == 0, last = i + 1 == order.size();
    const double below = first ? HUGE_VAL : 0.5 * (centre - centres_nm[order[i - 1]]);
    const double above = last ? HUGE_VAL : 0.5 * (centres_nm[order[i + 1]] - centre);
    const double half = order.size() == 1 ? 0.5 : std::min(below, above);
    channels[order[i]] = {centre - half, centre + half, ""};
    if (!(half > 0) || !(centre - half > 0))
      throw InputError(where + ": band centre " + format_number(centre) +
                       " nm: intervals can only follow from centres that are distinct and positive");
  }
  return channels;
}

}  // namespace kiloband
