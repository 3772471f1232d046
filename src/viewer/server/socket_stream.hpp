// A connection of a client that may be slow, hostile or gone.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <string>

#include "viewer/server/httplib.hpp"

namespace kiloband::viewer {

/// Reads and writes with deadlines for whole requests and answers: a client that sends or takes a byte now and then is
/// not waited for. All waiting ends soon after `stopping` becomes true.
class SocketStream final : public httplib::Stream {
 public:
  using Clock = std::chrono::steady_clock;
  struct Limits {
    std::chrono::milliseconds between_requests{30000}, between_if_crowded{5000}, request{15000},
        answer{60000};
    std::size_t request_bytes = std::size_t{5} << 20;
  };

  SocketStream(int socket, const std::atomic<bool>& stopping, const Limits& limits);

  /// Waits for the first byte of the next request, while is_crowded() not so long. False: the client is gone, or had nothing to ask.
  bool wait_for_request(const std::function<bool()>& is_crowded);
  /// From now on every write has a deadline of its own: for a stream of events.
  void answer_without_end() { endless_ = true; }
  /// Whether a further request may be read: what the client has sent of this one might be taken for it, unless all of it is known to be read.
  void end_after_answer() { is_last_ = true; }
  void go_on_after_answer() { is_last_ = false; }
  bool is_last() const { return is_last_; }
  /// The client has hung up.
  bool is_gone() const;

  bool is_readable() const override;
  bool is_writable() const override;
  ssize_t read(char* to, size_t size) override;
  ssize_t write(const char* from, size_t size) override;
  using httplib::Stream::write;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

 private:
  bool wait_for(short events, Clock::time_point deadline) const;

  int socket_;
  const std::atomic<bool>& stopping_;
  Limits limits_;
  Clock::time_point read_deadline_, write_deadline_;
  bool answering_ = false, endless_ = false, is_last_ = true;
  std::size_t bytes_left_ = 0;
  std::string buffer_;
  std::size_t next_ = 0;
};

}  // namespace kiloband::viewer
