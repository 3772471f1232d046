#include "viewer/server/http_server.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <thread>

#include "base/text.hpp"
#include "viewer/api/event_stream.hpp"
#include "viewer/api/json_text.hpp"
#include "viewer/server/connection_threads.hpp"
#include "viewer/server/socket_stream.hpp"

namespace kiloband::viewer {
namespace {

constexpr int kMostRequests = 1000;  // of one connection

/// The connection whose request is answered on this thread.
thread_local SocketStream* connection = nullptr;

Request to_request(const httplib::Request& from) {
  Request request{from.method, from.path, {}, {}, from.body};
  for (const auto& [name, value] : from.params) request.query.emplace(name, value);
  for (const auto& [name, value] : from.headers) request.headers.emplace(lowered(name), value);
  return request;
}

/// cpp-httplib unpacks bodies, and bounds them by their packed size alone: 4 MiB hold gigabytes.
bool is_packed(const httplib::Request& request) {
  return std::ranges::any_of(request.headers, [](const auto& header) {
    return lowered(header.first) == "content-encoding" && lowered(header.second) != "identity";
  });
}

/// Whether a request may have a body that was not read. A page of another site could have put a request into it, which would come from
/// no page at all.
bool leaves_body(const httplib::Request& request, int status) {
  if (request.get_header_value_count("Content-Length") > 1) return true;  // the first is looked at alone
  const bool has_body =
      request.has_header("Transfer-Encoding") ||
      (request.has_header("Content-Length") && request.get_header_value("Content-Length") != "0");
  return has_body && !(request.method == "POST" && status < 400);
}

const std::string& busy_answer() {
  static constexpr std::string_view kWords =
      "Too many pages are open at this viewer. Try again in some seconds.\n";
  static const std::string answer = fmt::format(
      "HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain\r\nContent-Length: {}\r\nRetry-After: 5\r\n"
      "Connection: close\r\n\r\n{}",
      kWords.size(), kWords);
  return answer;
}

void fill_response(const Response& from, httplib::Response& to) {
  to.status = from.status;
  for (const auto& [name, value] : from.headers) to.set_header(name, value);
  if (!from.type.empty()) to.set_content(from.body, from.type);
}

}  // namespace

struct HttpServer::Impl final : httplib::Server {
  Impl(Api& served, const ServerLimits& server_limits) : api(served), limits(server_limits) {
    new_task_queue = [this] { return threads = new ConnectionThreads(limits.connections); };
    set_tcp_nodelay(true);
    set_keep_alive_max_count(kMostRequests);  // what answers state; serve() sees to it
    set_keep_alive_timeout(30);
    set_payload_max_length(limits.body_bytes);
    set_socket_options([](socket_t socket) {
      const int yes = 1;  // not SO_REUSEPORT: a second server on the port is to fail
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    set_pre_routing_handler(
        [this](const auto& request, auto& response) { return before_body(request, response); });
    Post("/api/[a-z]*", [this](const httplib::Request& request, httplib::Response& response) {
      fill_response(api.answer(to_request(request), [this] { return is_over(); }), response);
    });
    set_post_routing_handler([](const httplib::Request& request, httplib::Response& response) {
      if (!connection->is_last() && !leaves_body(request, response.status)) return;
      connection->end_after_answer();
      response.set_header("Connection", "close");
    });
    set_error_handler([](const httplib::Request&, httplib::Response& response) {
      if (!response.body.empty()) return;
      const char* const message =
          response.status == 413 ? "the request is too large" : "a request that is none";
      fill_response(refusal(response.status, message), response);
    });
  }

  /// Everything but the answers to POST is known before a body is read. Requests whose heads the library refuses (too long, none) do not
  /// come here: of these it is not known whether a body follows.
  HandlerResponse before_body(const httplib::Request& request, httplib::Response& response) {
    connection->go_on_after_answer();
    const Request asked = to_request(request);
    if (asked.path == "/api/events" && !api.refuse(asked)) {
      stream_events(response);
      return HandlerResponse::Handled;
    }
    if (asked.method == "POST" && !api.refuse(asked) && asked.path.size() < 40 &&
        asked.path.starts_with("/api/")) {
      if (is_packed(request)) {
        fill_response(refusal(415, "the body must be sent as it is, without a Content-Encoding"), response);
        return HandlerResponse::Handled;
      }
      const std::string type = asked.header("content-type");
      if (type.starts_with("application/json") || type.starts_with("text/plain"))
        return HandlerResponse::Unhandled;
      fill_response(refusal(415, "the body must be application/json or text/plain"), response);
      return HandlerResponse::Handled;
    }
    fill_response(api.answer(asked, [this] { return is_over(); }), response);
    return HandlerResponse::Handled;
  }

  /// Of the connection of this thread: nobody waits for its answer.
  bool is_over() const { return stopping || connection->is_gone(); }

  void stream_events(httplib::Response& response) {
    response.set_header("Cache-Control", "no-store");
    response.set_header("X-Content-Type-Options", "nosniff");
    connection->answer_without_end();
    ++pages;
    const auto stream = std::make_shared<EventStream>(api);
    response.set_chunked_content_provider(
        "text/event-stream",
        [this, stream](std::size_t, httplib::DataSink& sink) {
          if (is_over()) return false;
          const std::string text = stream->next(pages);
          return text.empty() || sink.write(text.data(), text.size());
        },
        [this](bool) { --pages; });
  }

  bool process_and_close_socket(socket_t socket) override {
    if (ConnectionThreads::is_refusing()) {
      send(socket, busy_answer().data(), busy_answer().size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    } else {
      serve(socket);
    }
    shutdown(socket, SHUT_RDWR);
    close(socket);
    return true;
  }

  void serve(socket_t socket) {
    SocketStream::Limits stream_limits;
    stream_limits.request = std::chrono::milliseconds(limits.request_ms);
    stream_limits.between_requests = 2 * stream_limits.request;
    stream_limits.between_if_crowded = std::chrono::milliseconds(limits.idle_if_crowded_ms);
    stream_limits.answer = std::chrono::milliseconds(limits.answer_ms);
    stream_limits.request_bytes = limits.body_bytes + (1u << 16);
    SocketStream stream(socket, stopping, stream_limits);
    connection = &stream;
    bool closed = false;
    for (int i = 1; i <= kMostRequests && !closed && !stopping &&
                    stream.wait_for_request([this] { return threads->is_crowded(); });
         ++i) {
      const auto forget_ranges = [](httplib::Request& request) { request.ranges.clear(); };
      if (!process_request(stream, i == kMostRequests, closed, forget_ranges) || stream.is_last()) break;
    }
    connection = nullptr;
  }

  Api& api;
  ServerLimits limits;
  int bound_port = 0;
  std::atomic<unsigned> pages{0};
  std::atomic<bool> stopping{false};
  ConnectionThreads* threads = nullptr;  // the library's, while it listens
  std::thread thread;
};

HttpServer::HttpServer(Api& api, const std::string& address, int port, const ServerLimits& limits)
    : impl_(std::make_unique<Impl>(api, limits)) {
  errno = 0;
  const bool bound = port == 0 ? (impl_->bound_port = impl_->bind_to_any_port(address)) > 0
                               : impl_->bind_to_port(address, impl_->bound_port = port);
  if (!bound)
    throw DeviceError(fmt::format("cannot listen on {} port {}: {}", address, port,
                                  errno ? std::strerror(errno) : "no such address"));
  impl_->thread = std::thread([this] { impl_->listen_after_bind(); });
  while (!impl_->is_running()) std::this_thread::yield();
}

HttpServer::~HttpServer() {
  impl_->stopping = true;
  impl_->stop();
  impl_->thread.join();
}

int HttpServer::port() const {
  return impl_->bound_port;
}
unsigned HttpServer::pages() const {
  return impl_->pages;
}

}  // namespace kiloband::viewer
