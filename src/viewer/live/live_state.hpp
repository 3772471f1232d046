// The render behind a page: scene, backend and film, and how they change. Of one thread.
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <memory>

#include "viewer/api/viewed_image.hpp"
#include "viewer/live/live_film.hpp"
#include "viewer/live/live_settings.hpp"
#include "viewer/live/scene_spectra.hpp"

namespace kiloband::viewer {

class LiveState {
 public:
  /// Nothing is compiled yet: the first work() does that.
  /// interrupt: ends a piece of work early
  LiveState(LiveOptions options, const std::atomic<bool>& interrupt);

  /// A piece of work: compiling, or a pass over the film (over a part of it where passes are long). A camera that nobody
  /// has moved for a second is seen at full size from then on, in a new revision, paused or not. False: nothing is left to do. What goes wrong is told by status(); throws nothing.
  bool work();

  /// Null: nothing was compiled.
  const LiveFilm* film() const { return film_; }
  /// Whether scene, backend and film are those of the settings; else work() makes them next.
  bool is_ready() const { return scene_ && film_; }
  std::pair<uint32_t, uint32_t> full_size() const;
  const ViewStatus& status() const { return status_; }
  nlohmann::json scene_json() const;
  std::map<std::string, std::string> metadata() const;
  std::string camera_xml() const;

  /// All but pause() begin a new revision; all throw InputError and leave everything as it was.
  void set_camera(const nlohmann::json& wanted);
  void set_settings(const nlohmann::json& wanted);
  void set_spectrum(const nlohmann::json& wanted);
  void restart();
  void pause(bool paused);

 private:
  using Clock = std::chrono::steady_clock;

  /// throws InputError  a film of this many channels is not to be had
  void check_film(std::size_t channels) const;
  void compile();
  void look_along_the_axis();
  /// The film's: channels and derived ones.
  std::vector<Band> bands() const;
  std::unique_ptr<LiveFilm> make_film(const Sensor& sensor) const;
  void use_film(bool reduced);
  void move_to(const Sensor& sensor, bool reduced);
  void begin_revision();
  void render_some();
  void measure(std::size_t blocks, double seconds);
  void update_error();
  void fail(const std::exception& error);
  void set_state();
  uint32_t reduction() const;
  bool is_done() const;
  bool is_reduced() const { return film_ && film_ == small_.get(); }

  LiveOptions options_;
  const std::atomic<bool>& interrupt_;
  LiveSettings settings_;
  ChannelList channels_;
  DerivedChannels derived_;
  SpectrumEdits edits_;
  Sensor sensor_;
  double distance_ = 1, scene_size_ = 1;  // m: to what the camera looks at; of the scene

  std::shared_ptr<FlatScene> scene_;  // null: to be compiled
  std::unique_ptr<Backend> backend_;
  std::vector<double> units_;
  std::unique_ptr<LiveFilm> full_, small_;
  LiveFilm* film_ = nullptr;
  uint32_t small_factor_ = 0;
  Clock::time_point last_moving_{};  // when a page has last said that it moves the camera
  bool variance_ = true, paused_ = false, failed_ = false;

  ViewStatus status_;
  double pass_seconds_ = 0;  // of a full film
  double busy_seconds_ = 0;  // of this revision
  uint64_t paths_ = 0;       // of this revision
  Clock::time_point last_error_{};
};

}  // namespace kiloband::viewer
