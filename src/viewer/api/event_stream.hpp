// The events of one page: /api/events.
#pragma once

#include <chrono>
#include <string>

#include "viewer/api/api.hpp"

namespace kiloband::viewer {

/// What has changed since the last look, never more: a page that reads slowly gets fewer events, not older ones.
class EventStream {
 public:
  explicit EventStream(Api& api) : api_(api) {}

  /// Events as text/event-stream, after at most a quarter of a second; may be empty.
  /// pages: that look now, for the status
  std::string next(unsigned pages);

 private:
  Api& api_;
  uint64_t frame_ = 0, scene_ = 0;
  std::chrono::steady_clock::time_point last_status_{};
  std::string status_;
};

}  // namespace kiloband::viewer
