#include "viewer/api/event_stream.hpp"

#include "viewer/api/json_text.hpp"

namespace kiloband::viewer {
namespace {

using nlohmann::json;

constexpr std::chrono::milliseconds kStatusInterval{250};
constexpr std::chrono::seconds kAlive{
    5};  // a status comes at least this often, so that a client that has gone is noticed

json optional_json(const auto& value) {
  return value ? number_json(static_cast<double>(*value)) : json(nullptr);
}

json status_json(const ViewStatus& status, unsigned pages) {
  return {{"revision", status.newest.revision},
          {"frame", status.newest.frame},
          {"samples", status.newest.samples},
          {"target_samples", status.target_samples ? json(*status.target_samples) : json(nullptr)},
          {"seconds", number_json(status.seconds)},
          {"paths_per_second", number_json(status.paths_per_second)},
          {"frames_per_second", number_json(status.frames_per_second)},
          {"error", optional_json(status.error)},
          {"memory_bytes", status.memory_bytes},
          {"state", status.state},
          {"message", status.message},
          {"clients", pages}};
}

std::string event(const char* name, const std::string& data) {
  return std::string("event: ") + name + "\ndata: " + data + "\n\n";
}

}  // namespace

std::string EventStream::next(unsigned pages) {
  std::string text;
  const bool is_new = api_.image().wait_for_frame(frame_, kStatusInterval);
  const ViewStatus status = api_.image().status();
  if (const uint64_t scene = api_.scene_number(); scene != scene_) {
    scene_ = scene;
    text += event("scene", to_text({{"revision", status.newest.revision}}));
  }
  if (is_new) {
    frame_ = status.newest.frame;
    text += event("frame", to_text({{"frame", frame_}, {"revision", status.newest.revision}}));
  }
  const auto now = std::chrono::steady_clock::now();
  if (now - last_status_ < kStatusInterval) return text;
  std::string new_status = to_text(status_json(status, pages));
  if (new_status == status_ && now - last_status_ < kAlive) return text;
  last_status_ = now;
  status_ = std::move(new_status);
  return text + event("status", status_);
}

}  // namespace kiloband::viewer
