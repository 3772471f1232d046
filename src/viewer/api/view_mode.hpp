// What of an image is shown, and how: the frame parameters of docs/viewer.md.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "post/sensor_cube.hpp"
#include "viewer/api/access.hpp"
#include "viewer/api/viewed_image.hpp"
#include "viewer/display/picture_8bit.hpp"

namespace kiloband::viewer {

/// Responses that pages have uploaded, by their names.
class Responses {
 public:
  static constexpr std::size_t kMost = 32;

  /// csv: as a file of sensor responses (read_response_file)
  /// throws InputError  the name, the text, more than kMost
  void add(const std::string& name, const std::string& csv);
  /// throws InputError  no such name
  std::vector<NamedResponse> find(const std::string& name) const;
  std::vector<std::string> names() const;
  uint64_t number() const;  // grows with each add()

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::vector<NamedResponse>> responses_;
  uint64_t number_ = 0;
};

struct ViewParameters {
  enum class Mode { kColour, kResponse, kFalseColour, kChannel, kError, kTemperature };
  Mode mode = Mode::kColour;
  std::string response;
  std::array<Channel, 3> ranges;  // kFalseColour
  std::size_t channel = 0;        // kChannel, kTemperature
  double exposure = 0;            // stops, added to the automatic ones
  Tone tone = Tone::kSrgb;
  MapName map = MapName::kViridis;
  MapScale scale = MapScale::kLinear;
  std::optional<float> low, high;
  bool exact = false;  // PNG, else JPEG

  bool is_colour() const {
    return mode == Mode::kColour || mode == Mode::kResponse || mode == Mode::kFalseColour;
  }
};

/// throws InputError  a value that a parameter cannot have; parameters of other modes are not looked at
ViewParameters parse_view(const Request& request);

/// "color", "response:NAME" ...: the modes that make sense for these bands.
std::vector<std::string> modes_for(const std::vector<Band>& bands, bool errors, const Responses& responses);

/// throws InputError  the mode does not suit the image: no visible light, no such channel, no such response
Plane make_plane(const PixelSource& pixels, const ViewParameters& view, const Responses& responses,
                 unsigned threads);

/// What the axis of a colour bar says.
struct Legend {
  std::string label, unit;
};
Legend legend_of(const ViewParameters& view, const std::vector<Band>& bands);

/// A picture and what its header states of it.
struct Shown {
  Picture8 picture;
  nlohmann::json facts;  // low and high, or auto_stops
};
Shown show(const Plane& plane, const ViewParameters& view);

}  // namespace kiloband::viewer
