#include "viewer/server/socket_stream.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>

namespace kiloband::viewer {
namespace {

constexpr std::chrono::milliseconds kLook{200};  // how often `stopping` is looked at
constexpr std::size_t kBuffer = 16384;

}  // namespace

SocketStream::SocketStream(int socket, const std::atomic<bool>& stopping, const Limits& limits)
    : socket_(socket), stopping_(stopping), limits_(limits) {}

/// Whether the socket is ready (or broken, which the next call on it will tell) before the deadline.
bool SocketStream::wait_for(short events, Clock::time_point deadline) const {
  while (!stopping_) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
    if (left.count() <= 0) return false;
    pollfd poll_socket{socket_, events, 0};
    const int ready = poll(&poll_socket, 1, static_cast<int>(std::min(left, kLook).count()));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
  }
  return false;
}

bool SocketStream::wait_for_request(const std::function<bool()>& is_crowded) {
  const auto start = Clock::now();
  while (next_ == buffer_.size() && !wait_for(POLLIN, Clock::now() + kLook)) {
    const auto limit = is_crowded() ? limits_.between_if_crowded : limits_.between_requests;
    if (stopping_ || Clock::now() - start > limit) return false;
  }
  read_deadline_ = Clock::now() + limits_.request;
  bytes_left_ = limits_.request_bytes;
  answering_ = endless_ = false;
  is_last_ = true;  // until its head has been understood
  return !is_gone();
}

bool SocketStream::is_gone() const {
  if (next_ < buffer_.size()) return false;
  char byte = 0;
  const ssize_t size = recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return size == 0 || (size < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
}

bool SocketStream::is_readable() const {
  return next_ < buffer_.size() || wait_for(POLLIN, read_deadline_);
}

bool SocketStream::is_writable() const {
  return !is_gone() && wait_for(POLLOUT, endless_ ? Clock::now() + limits_.request : write_deadline_);
}

ssize_t SocketStream::read(char* to, size_t size) {
  if (next_ == buffer_.size()) {
    buffer_.resize(kBuffer);
    next_ = 0;
    ssize_t received = -1;
    do {
      if (!wait_for(POLLIN, read_deadline_)) break;
      received = recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    } while (received < 0 && (errno == EAGAIN || errno == EINTR));
    buffer_.resize(received > 0 ? static_cast<std::size_t>(received) : 0);
    if (received <= 0) return received;
  }
  const std::size_t part = std::min({size, buffer_.size() - next_, bytes_left_});
  if (part == 0) return -1;  // a request without end
  std::copy_n(buffer_.data() + next_, part, to);
  next_ += part;
  bytes_left_ -= part;
  return static_cast<ssize_t>(part);
}

ssize_t SocketStream::write(const char* from, size_t size) {
  if (!answering_ || endless_) write_deadline_ = Clock::now() + (endless_ ? limits_.request : limits_.answer);
  answering_ = true;
  std::size_t sent = 0;
  while (sent < size) {
    if (!wait_for(POLLOUT, write_deadline_)) return -1;
    const ssize_t part = send(socket_, from + sent, size - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (part < 0 && errno != EAGAIN && errno != EINTR) return -1;
    if (part > 0) sent += static_cast<std::size_t>(part);
  }
  return static_cast<ssize_t>(size);
}

/// Nobody is known by an address here.
void SocketStream::get_remote_ip_and_port(std::string& ip, int& port) const {
  ip.clear(), port = 0;
}
void SocketStream::get_local_ip_and_port(std::string& ip, int& port) const {
  ip.clear(), port = 0;
}

}  // namespace kiloband::viewer
