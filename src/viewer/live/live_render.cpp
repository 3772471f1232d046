#include "viewer/live/live_render.hpp"

#include <fmt/format.h>

#include <atomic>
#include <condition_variable>
#include <mutex>

#include "viewer/api/json_text.hpp"
#include "viewer/live/live_state.hpp"
#include "viewer/live/task_thread.hpp"

namespace kiloband::viewer {
namespace {

using nlohmann::json;

/// What other threads look at while the render thread works.
class Board {
 public:
  void set(const ViewStatus& status) {
    {
      const std::lock_guard lock(mutex_);
      status_ = status;
    }
    changed_.notify_all();
  }
  void set_scene(json scene) {
    const std::lock_guard lock(mutex_);
    scene_ = std::move(scene);
    ++scene_number_;
  }

  ViewStatus status() const {
    const std::lock_guard lock(mutex_);
    return status_;
  }
  json scene() const {
    const std::lock_guard lock(mutex_);
    return scene_;
  }
  uint64_t scene_number() const {
    const std::lock_guard lock(mutex_);
    return scene_number_;
  }
  bool wait_for_frame(uint64_t after, std::chrono::milliseconds most) const {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, most, [&] { return status_.newest.frame > after && !status_.blank; });
  }

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  ViewStatus status_;
  json scene_;
  uint64_t scene_number_ = 1;
};

class LiveRender final : public ViewedImage, public RenderControls {
 public:
  explicit LiveRender(LiveOptions options)
      : threads_(options.threads), state_(std::move(options), interrupt_) {
    publish();
    board_.set_scene(state_.scene_json());
    thread_ = std::make_unique<TaskThread>([this] { return step(); });
  }
  ~LiveRender() override {
    interrupt_ = true;
    thread_.reset();
  }

  json scene() override { return board_.scene(); }
  uint64_t scene_number() override { return board_.scene_number(); }
  ViewStatus status() override { return board_.status(); }
  bool wait_for_frame(uint64_t after, std::chrono::milliseconds most) override {
    return board_.wait_for_frame(after, most);
  }
  bool read_newer(uint64_t after, std::chrono::milliseconds most,
                  const std::function<void(const ImageView&)>& look) override {
    const auto is_newer = [this, after] {
      return state_.film() && state_.status().newest.frame > after && !state_.status().blank;
    };
    return thread_->perform_when(
        is_newer, [this, look] { show(look); }, most);
  }
  void read(const std::function<void(const ImageView&)>& look) override {
    thread_->perform([&] { show(look); });
  }
  unsigned threads() const override { return threads_; }
  RenderControls* controls() override { return this; }

  void set_camera(const json& wanted) override {
    change([&] { state_.set_camera(wanted); }, true);
  }
  void set_settings(const json& wanted) override {
    change([&] { state_.set_settings(wanted); }, true);
  }
  void set_spectrum(const json& wanted) override {
    change([&] { state_.set_spectrum(wanted); }, true);
  }
  void pause() override {
    change([&] { state_.pause(true); }, false);
  }
  void resume() override {
    change([&] { state_.pause(false); }, false);
  }
  void restart() override {
    change([&] { state_.restart(); }, true);
  }
  std::string camera_xml() override {
    std::string xml;
    thread_->perform([&] { xml = state_.camera_xml(); });
    return xml;
  }

 private:
  /// On the render thread.
  void show(const std::function<void(const ImageView&)>& look) {
    const LiveFilm* const film = state_.film();
    if (!film) throw InputError("there is no image yet");
    const auto [width, height] = state_.full_size();
    look({*film, state_.status().newest, state_.status().blank, width, height,
          [this] { return state_.metadata(); }});
  }

  /// interrupts: what is being rendered will not be needed
  void change(const std::function<void()>& action, bool interrupts) {
    if (interrupts) interrupt_ = true;
    thread_->perform([&] {
      interrupt_ = false;
      const uint64_t before = state_.status().newest.revision;
      action();
      publish();
      if (state_.status().newest.revision != before) board_.set_scene(state_.scene_json());
    });
  }

  bool step() {
    const bool was_ready = state_.is_ready();
    const uint64_t before = state_.status().newest.revision;
    const bool works = state_.work();
    if ((!was_ready && state_.is_ready()) || state_.status().newest.revision != before)
      board_.set_scene(state_.scene_json());
    publish();
    return works;
  }

  void publish() { board_.set(state_.status()); }

  const unsigned threads_;
  std::atomic<bool> interrupt_{false};
  Board board_;
  LiveState state_;  // of the render thread alone, but for the constructor
  std::unique_ptr<TaskThread> thread_;
};

}  // namespace

std::unique_ptr<ViewedImage> start_live_render(LiveOptions options) {
  return std::make_unique<LiveRender>(std::move(options));
}

}  // namespace kiloband::viewer
