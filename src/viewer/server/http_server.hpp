// Hands an Api to browsers.
#pragma once

#include <memory>
#include <string>

#include "viewer/api/api.hpp"

namespace kiloband::viewer {

struct ServerLimits {
  std::size_t connections = 48;
  std::size_t body_bytes = std::size_t{4} << 20;
  /// Milliseconds for a whole request to arrive, and for a whole answer to be taken.
  unsigned request_ms = 15000, answer_ms = 60000;
  /// Milliseconds that a connection may be idle while more than half of them are open (otherwise twice request_ms): browsers keep six.
  unsigned idle_if_crowded_ms = 5000;
};

/// Answers requests on threads of its own, from the constructor to the destructor.
class HttpServer {
 public:
  /// address: numeric, or a name of this machine; port 0: any that is free
  /// throws DeviceError  it cannot be bound
  HttpServer(Api& api, const std::string& address, int port, const ServerLimits& limits = {});
  ~HttpServer();

  int port() const;
  /// Pages that listen to events.
  unsigned pages() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kiloband::viewer
