#include "viewer/api/view_mode.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/number.hpp"
#include "base/temporary_folder.hpp"
#include "base/text.hpp"
#include "cube/channel_cover.hpp"
#include "cube/cube_layout.hpp"
#include "spectral/files/spectrum_files.hpp"
#include "viewer/api/plain_names.hpp"

namespace kiloband::viewer {
namespace {

using Mode = ViewParameters::Mode;

constexpr const char* kResponse = "response:";
constexpr double kMostStops = 60;
constexpr double kThermalNm = 1500;  // from here on surfaces of a few hundred kelvin emit

std::optional<double> parse_value(const Request& request, const std::string& name) {
  const std::string text = request.parameter(name);
  double value = 0;
  if (text.empty()) return std::nullopt;
  if (read_number(text, value) != NumberText::kNumber || !std::isfinite(value))
    throw InputError(fmt::format("{}={}: must be a finite number", name, quote_text(text)));
  return value;
}

/// The same within what a float holds.
std::optional<float> parse_float(const Request& request, const std::string& name) {
  const std::optional<double> value = parse_value(request, name);
  if (!value) return std::nullopt;
  constexpr float kMost = std::numeric_limits<float>::max();
  if (std::abs(*value) > kMost)
    throw InputError(fmt::format("{}={:g}: must be within {:g}", name, *value, kMost));
  return static_cast<float>(*value);
}

/// "400-500", in nm.
Channel parse_range(const Request& request, const std::string& name) {
  const std::string text = request.parameter(name);
  const std::size_t dash = text.find('-');
  Channel range;
  const bool numbers =
      dash != std::string::npos &&
      read_number(std::string_view(text).substr(0, dash), range.min_nm) == NumberText::kNumber &&
      read_number(std::string_view(text).substr(dash + 1), range.max_nm) == NumberText::kNumber;
  if (!numbers || !(range.min_nm > 0) || !(range.max_nm > range.min_nm) || !std::isfinite(range.max_nm))
    throw InputError(fmt::format("{}={}: must be a range in nm, such as 600-700", name, quote_text(text)));
  return range;
}

/// The value's place among the names; 0 where the parameter is absent.
std::size_t parse_choice(const Request& request, const std::string& name,
                         std::initializer_list<std::string_view> choices) {
  const std::string text = request.parameter(name);
  if (text.empty()) return 0;
  const auto* const found = std::ranges::find(choices, text);
  if (found != choices.end()) return static_cast<std::size_t>(found - choices.begin());
  throw InputError(fmt::format("{}={}: must be {}", name, quote_text(text), fmt::join(choices, ", ")));
}

std::size_t parse_channel(const Request& request) {
  const std::string text = request.parameter("channel");
  const auto channel = whole_number<uint32_t>(text.empty() ? "0" : text);
  if (!channel) throw InputError("channel=" + quote_text(text) + ": must be a whole number from 0");
  return *channel;
}

void parse_mode(const Request& request, ViewParameters& view) {
  const std::string mode = request.parameter("mode");
  if (mode.starts_with(kResponse)) {
    view.mode = Mode::kResponse;
    view.response = mode.substr(std::string_view(kResponse).size());
    return;
  }
  static constexpr Mode kModes[] = {Mode::kColour, Mode::kFalseColour, Mode::kChannel, Mode::kError,
                                    Mode::kTemperature};
  view.mode = kModes[parse_choice(request, "mode", {"color", "false", "channel", "error", "temperature"})];
}

/// The first three responses as red, green, blue; one as grey.
RgbWeights response_weights(const std::vector<NamedResponse>& responses, const std::vector<Band>& bands) {
  RgbWeights weights(bands.size(), {0, 0, 0});
  const ChannelCover cover(channels_of(bands));
  for (std::size_t c = 0; c < 3; ++c) {
    const NamedResponse& response = responses[std::min(c, responses.size() - 1)];
    const SensorWeights sensor = sensor_weights(response.second, bands, cover);
    for (std::size_t k = 0; k < bands.size(); ++k) weights[k][c] = static_cast<float>(sensor.weight[k]);
  }
  return weights;
}

RgbWeights colour_weights(const ViewParameters& view, const std::vector<Band>& bands,
                          const Responses& responses) {
  if (view.mode == Mode::kResponse) return response_weights(responses.find(view.response), bands);
  if (view.mode == Mode::kFalseColour) return range_weights(bands, view.ranges);
  if (!shows_visible_light(bands)) throw InputError("mode=color: no channel lies in 380-780 nm");
  return preview_weights(bands);
}

void check_channel(const ViewParameters& view, const std::vector<Band>& bands) {
  if (view.channel >= bands.size())
    throw InputError(fmt::format("channel={}: the image has {} channels", view.channel, bands.size()));
  if (view.mode == Mode::kTemperature && bands[view.channel].derived)
    throw InputError(
        fmt::format("channel={}: a sensor response has no brightness temperature", view.channel));
}

/// What is given stays: where an automatic end is beyond it, that end moves.
void make_room(const ViewParameters& view, MapRange& range) {
  if (range.high > range.low) return;
  const bool logarithmic = view.scale == MapScale::kLogarithmic;
  const auto beside = [](float value, float sign) {  // 0 or twice as far from it
    if (value == 0) return sign;
    return value * sign > 0 ? 2 * value : 0;
  };
  if (view.high && !view.low)
    range.low = logarithmic ? range.high / 10 : beside(range.high, -1);
  else if (view.low && !view.high)
    range.high = logarithmic ? range.low * 10 : beside(range.low, 1);
}

}  // namespace

void Responses::add(const std::string& name, const std::string& csv) {
  check_plain_name(name, "the response's name");
  const ScratchFolder folder;
  const std::filesystem::path file = folder.write(name + ".csv", csv);
  std::vector<NamedResponse> read;
  try {
    read = read_response_file(file);
  } catch (const InputError& error) {  // the page's user knows no such file
    std::string message = error.what();
    replace_all(message, folder.path().string() + "/", "");
    throw InputError(message);
  }
  const std::lock_guard lock(mutex_);
  if (responses_.size() >= kMost && !responses_.contains(name))
    throw InputError(fmt::format("there are {} responses already: no more are kept", kMost));
  responses_[name] = std::move(read);
  ++number_;
}

std::vector<NamedResponse> Responses::find(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = responses_.find(name);
  if (found == responses_.end()) throw InputError("no response " + quote_text(name) + " was uploaded");
  return found->second;
}

std::vector<std::string> Responses::names() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [name, responses] : responses_) names.push_back(name);
  return names;
}

uint64_t Responses::number() const {
  const std::lock_guard lock(mutex_);
  return number_;
}

ViewParameters parse_view(const Request& request) {
  ViewParameters view;
  parse_mode(request, view);
  if (view.mode == Mode::kFalseColour)
    view.ranges = {parse_range(request, "r"), parse_range(request, "g"), parse_range(request, "b")};
  view.channel = parse_channel(request);
  view.exposure = parse_value(request, "exposure").value_or(0);
  if (std::abs(view.exposure) > kMostStops)
    throw InputError(
        fmt::format("exposure={}: must be from -{} to {} stops", view.exposure, kMostStops, kMostStops));
  view.tone = static_cast<Tone>(parse_choice(request, "tone", {"srgb", "filmic"}));
  view.map = static_cast<MapName>(parse_choice(request, "map", {"viridis", "cividis", "magma", "grey"}));
  view.scale = static_cast<MapScale>(parse_choice(request, "scale", {"linear", "log"}));
  view.exact = parse_choice(request, "quality", {"lossy", "exact"}) == 1;
  view.low = parse_float(request, "low");
  view.high = parse_float(request, "high");
  if (view.scale == MapScale::kLogarithmic &&
      ((view.low && !(*view.low > 0)) || (view.high && !(*view.high > 0))))
    throw InputError("low and high: must be above 0 on a logarithmic scale");
  return view;
}

std::vector<std::string> modes_for(const std::vector<Band>& bands, bool errors, const Responses& responses) {
  std::vector<std::string> modes;
  const ChannelList channels = channels_of(bands);
  if (shows_visible_light(bands)) modes.emplace_back("color");
  for (const std::string& name : responses.names()) modes.push_back(kResponse + name);
  if (!channels.empty()) modes.emplace_back("false");
  modes.emplace_back("channel");
  if (errors) modes.emplace_back("error");
  if (!channels.empty() && hull(channels).max_nm > kThermalNm) modes.emplace_back("temperature");
  return modes;
}

Plane make_plane(const PixelSource& pixels, const ViewParameters& view, const Responses& responses,
                 unsigned threads) {
  if (view.is_colour())
    return weighted_plane(pixels, colour_weights(view, pixels.bands(), responses), threads);
  if (view.mode == Mode::kError) return error_plane(pixels, threads);
  check_channel(view, pixels.bands());
  if (view.mode == Mode::kTemperature) return temperature_plane(pixels, {view.channel}, threads);
  return channel_plane(pixels, {view.channel}, threads);
}

Legend legend_of(const ViewParameters& view, const std::vector<Band>& bands) {
  if (view.mode == Mode::kError) return {"relative standard error", "1"};
  if (view.is_colour()) return {"", ""};
  check_channel(view, bands);
  const Band& band = bands[view.channel];
  if (view.mode == Mode::kTemperature) return {"brightness temperature, " + band_text(band), "K"};
  if (band.derived) return {band_text(band), ""};
  return {"spectral radiance, " + band_text(band), "W m-2 sr-1 nm-1"};
}

Shown show(const Plane& plane, const ViewParameters& view) {
  if (view.is_colour()) {
    const double automatic = automatic_stops(plane);
    return {tone_map(plane, automatic + view.exposure, view.tone), {{"auto_stops", automatic}}};
  }
  MapRange range = automatic_range(plane, view.scale);
  if (view.low) range.low = *view.low;
  if (view.high) range.high = *view.high;
  make_room(view, range);
  if (!(range.high > range.low)) range.high = std::nextafter(range.low, INFINITY);
  return {map_colours(plane, view.map, view.scale, range), {{"low", range.low}, {"high", range.high}}};
}

}  // namespace kiloband::viewer
