// What a page looks at: an image that may change while it is looked at. A stored cube and a live render are both one.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "viewer/display/plane.hpp"

namespace kiloband::viewer {

/// One state of an image. Frames are numbered from 1 on and only grow; a revision begins whenever the image starts afresh.
struct FrameStamp {
  uint64_t frame = 0;
  uint64_t revision = 0;
  uint64_t samples = 0;  // of the pixel that has the fewest
};

struct ViewStatus {
  FrameStamp newest;
  bool blank =
      false;  // the image starts afresh and has no sample yet: the newest frame is not to be looked at
  std::string state;    // "loading", "rendering", "paused", "done", "failed"
  std::string message;  // of "failed", and warnings
  std::optional<uint64_t> target_samples;
  double seconds = 0;  // spent on this revision
  double paths_per_second = 0, frames_per_second = 0;
  std::optional<double> error;  // relative, of the worst channel: BandErrors::worst
  uint64_t memory_bytes = 0;
};

/// What is being read: pixels and what they are of.
struct ImageView {
  const PixelSource& pixels;
  FrameStamp stamp;
  bool blank;                        // as of ViewStatus
  uint32_t full_width, full_height;  // where pixels are those of a reduced image
  /// What a saved cube is to state. To be called while the image is looked at.
  std::function<std::map<std::string, std::string>()> metadata;
};

/// What a page may ask of a render; a stored cube has none of it. All throw InputError with what is wrong.
class RenderControls {
 public:
  virtual ~RenderControls() = default;
  /// The bodies of the requests of docs/viewer.md.
  virtual void set_camera(const nlohmann::json& wanted) = 0;
  virtual void set_settings(const nlohmann::json& wanted) = 0;
  virtual void set_spectrum(const nlohmann::json& wanted) = 0;
  virtual void pause() = 0;
  virtual void resume() = 0;
  virtual void restart() = 0;
  /// To be pasted into a scene file.
  virtual std::string camera_xml() = 0;
};

/// All functions are called from any thread.
class ViewedImage {
 public:
  virtual ~ViewedImage() = default;

  /// The members of /api/scene that the image knows.
  virtual nlohmann::json scene() = 0;
  /// Grows whenever scene() changes.
  virtual uint64_t scene_number() = 0;
  virtual ViewStatus status() = 0;

  /// Waits until there is a frame with a number above `after`. False: there is none yet.
  virtual bool wait_for_frame(uint64_t after, std::chrono::milliseconds most) = 0;
  /// Calls `look` with the image as soon as there is a frame with a number above `after`: before the next one is begun, so
  /// that who asks in time gets every frame. False: there was none within `most`.
  virtual bool read_newer(uint64_t after, std::chrono::milliseconds most,
                          const std::function<void(const ImageView&)>& look) = 0;
  /// Calls `look` with the newest image, which stays as it is meanwhile.
  /// throws InputError  there is none yet; what look() throws
  virtual void read(const std::function<void(const ImageView&)>& look) = 0;

  /// Threads that may compute what is shown.
  virtual unsigned threads() const = 0;
  /// Null: the image cannot be rendered anew.
  virtual RenderControls* controls() = 0;
};

}  // namespace kiloband::viewer
