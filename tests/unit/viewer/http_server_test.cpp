// A running server under the hands of clients that do as they like.
#include "viewer/server/http_server.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <thread>

#include "base/error.hpp"
#include "tests/support/effort.hpp"
#include "tests/unit/viewer/viewed_cube.hpp"

namespace kiloband::test {
namespace {

using namespace viewer;
using Clock = std::chrono::steady_clock;

/// A client's end of a connection.
class Client {
 public:
  explicit Client(int port, int receive_buffer = 0) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_buffer > 0)
      setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    const timeval patience{20, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  ~Client() { close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  bool send(const std::string& text) const {
    return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
  }
  /// What comes until the server hangs up, or `until` was part of it.
  std::string receive(const std::string& until = "") const {
    std::string text;
    char part[4096];
    for (;;) {
      const ssize_t size = recv(socket_, part, sizeof part, 0);
      if (size <= 0) return text;
      text.append(part, static_cast<std::size_t>(size));
      if (!until.empty() && text.find(until) != std::string::npos) return text;
    }
  }
  bool connected() const { return connected_; }

 private:
  int socket_;
  bool connected_ = false;
};

std::string request(const std::string& line, const std::string& more = "", const std::string& body = "") {
  std::string text = line + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + more;
  if (!body.empty()) text += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  return text + "\r\n" + body;
}

const std::string kPost = "X-Kiloband: 1\r\nContent-Type: application/json\r\n";

class RunningServer : public testing::Test {
 protected:
  static ServerLimits limits() {
    ServerLimits limits;
    limits.connections = 8;
    limits.body_bytes = 1000;
    limits.request_ms = 500;
    limits.answer_ms = 1000;
    return limits;
  }
  std::string ask(const std::string& text) {
    const Client client(server_.port());
    client.send(text);
    return client.receive();
  }
  std::string status(const std::string& text) {
    const std::string answer = ask(text);
    return answer.size() < 12 ? answer : answer.substr(9, 3);
  }

  ViewedCube cube_;
  HttpServer server_{cube_.api(), "127.0.0.1", 0, limits()};
};

TEST_F(RunningServer, AnswersItsOwnPage) {
  EXPECT_EQ(status(request("GET /")), "200");
  const std::string frame = ask(request("GET /api/frame?mode=channel&quality=exact"));
  EXPECT_NE(frame.find("X-Kiloband-Frame: {"), std::string::npos);
  EXPECT_NE(frame.find("Content-Type: image/png"), std::string::npos);
  EXPECT_NE(ask(request("POST /api/save", kPost, R"({"format": "exr", "name": "saved"})"))
                .find(R"({"files":["saved.exr"]})"),
            std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(cube_.output() / "saved.exr"));
}

TEST_F(RunningServer, RefusesOthers) {
  EXPECT_EQ(status("GET / HTTP/1.1\r\nHost: evil.com\r\nConnection: close\r\n\r\n"), "403");
  EXPECT_EQ(status("GET / HTTP/1.1\r\nConnection: close\r\n\r\n"), "403");
  EXPECT_EQ(status(request("GET /api/events", "Origin: http://evil.com\r\n")), "403");
  EXPECT_EQ(status(request("POST /api/save", "Content-Type: application/json\r\n", "{}")), "403");
  EXPECT_EQ(status(request("POST /api/save", kPost + "Origin: http://evil.com\r\n", "{}")), "403");
  EXPECT_EQ(status(request("POST /api/save",
                           "X-Kiloband: 1\r\nContent-Type: application/x-www-form-urlencoded\r\n", "a=b")),
            "415");
  EXPECT_EQ(status(request("POST /api/save", kPost + "Content-Encoding: gzip\r\n", "{}")), "415")
      << "what is packed might be without end";
  EXPECT_EQ(status(request("POST /api/save", kPost + "content-encoding: Identity\r\n", "{")), "400");
  EXPECT_EQ(status(request("POST /api/save", kPost, "{")), "400");
  EXPECT_EQ(status(request("GET /..%2f..%2fetc/passwd")), "404");
  EXPECT_EQ(status(request("DELETE /")), "405");
  EXPECT_EQ(status(request("HEAD /")), "405");
}

/// What is not read of a request is no further request: a page of another site may send any body, and the headers in it would be its own.
TEST_F(RunningServer, BodiesThatAreNotReadAreNoRequests) {
  const std::string save = R"({"format": "png", "name": "evil", "mode": "channel"})";
  const std::string hidden = "POST /api/save HTTP/1.1\r\nHost: localhost\r\n" + kPost +
                             "Content-Length: " + std::to_string(save.size()) + "\r\n\r\n" + save;
  const std::string length = "Content-Length: " + std::to_string(hidden.size()) + "\r\n\r\n";
  const std::string host = " HTTP/1.1\r\nHost: localhost\r\n";
  for (const std::string& head :
       {"POST /api/save" + host + "Origin: http://evil.com\r\nContent-Type: text/plain\r\n" + length,
        "POST /api/save" + host + "X-Kiloband: 1\r\nContent-Type: image/png\r\n" + length,
        "POST /api/save" + host + kPost + "Content-Encoding: gzip\r\n" + length, "GET /" + host + length,
        "PUT /api/save" + host + length, "POST /elsewhere" + host + length,
        "GET /" + host + "Transfer-Encoding: chunked\r\n\r\n",
        "GET /" + host + "Content-Length: 0\r\n" + length,
        "POST /api/control" + host + kPost + "Content-Length: 0\r\n" + length,
        "POST /" + std::string(9000, 'a') + host + "Origin: http://evil.com\r\n" + length,
        "POST /api/save" + host + "Cookie: a=" + std::string(9000, 'b') + "\r\n" + length,
        "POST /api/save HTTP/9.9\r\nHost: localhost\r\n" + length, std::string("EVIL / HTTP/1.1\r\n\r\n"),
        std::string("GET\n"), std::string("\x16\x03\x01\r\n")}) {
    const std::string answer = ask(head + hidden);
    std::size_t answers = 0;
    for (std::size_t at = answer.find("HTTP/1.1 "); at != std::string::npos;
         at = answer.find("HTTP/1.1 ", at + 1))
      ++answers;
    EXPECT_LE(answers, 1u) << head << "\n"
                           << answer.substr(0, 2000);  // none where the client was too fast to hear it
  }
  EXPECT_FALSE(std::filesystem::exists(cube_.output() / "evil.png"));
  const Client client(server_.port());  // others go on
  EXPECT_TRUE(client.send("GET /api/scene" + host + "\r\n"));
  EXPECT_NE(client.receive("}"), "");
  EXPECT_TRUE(client.send("GET /api/scene" + host + "\r\n"));
  EXPECT_NE(client.receive("}"), "");
}

TEST_F(RunningServer, BoundsWhatIsSent) {
  EXPECT_EQ(status(request("POST /api/save", kPost, std::string(1001, ' '))), "413");
  EXPECT_EQ(status(request("POST /api/save", kPost + "Content-Length: 99999999999\r\n")), "413");
  EXPECT_EQ(status(request("GET /" + std::string(9000, 'a'))), "414");
  const std::string endless = ask("GET / HTTP/1.1\r\nHost: localhost\r\n" + [] {
    std::string headers;
    for (int i = 0; i < 20000; ++i) headers += "X-" + std::to_string(i) + ": y\r\n";
    return headers;
  }());
  EXPECT_EQ(endless.find("200 OK"), std::string::npos);
  EXPECT_EQ(status(request("GET /")), "200") << "the server lives on";
}

/// Ranges that overlap would make a large answer of a small one.
TEST_F(RunningServer, IgnoresRanges) {
  const std::string whole = ask(request("GET /dygraph.min.js"));
  EXPECT_EQ(ask(request("GET /dygraph.min.js", "Range: bytes=0-,0-,0-,0-\r\n")).size(), whole.size());
}

TEST_F(RunningServer, DoesNotWaitForSlowWriters) {
  const auto start = Clock::now();
  const Client slow(server_.port());
  std::thread dripping([&] {
    for (int i = 0; i < 40 && slow.send("X"); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
  });
  slow.receive();
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(3));
  dripping.join();
}

/// Answers that nobody takes end with the time that an answer has.
TEST_F(RunningServer, DoesNotWaitForSlowReaders) {
  const Client slow(server_.port(), 4096);
  std::string many;
  for (int i = 0; i < 100; ++i) many += "GET /dygraph.min.js HTTP/1.1\r\nHost: localhost\r\n\r\n";
  slow.send(many);
  std::this_thread::sleep_for(std::chrono::milliseconds(2500));
  EXPECT_LT(slow.receive().size(), std::size_t{8} << 20) << "of 13 MB";
}

TEST_F(RunningServer, RefusesConnectionsBeyondItsLimit) {
  std::vector<std::unique_ptr<Client>> listening;
  for (int i = 0; i < 8; ++i) {
    listening.push_back(std::make_unique<Client>(server_.port()));
    listening.back()->send(request("GET /api/events"));
    EXPECT_NE(listening.back()->receive("event: status").find("200 OK"), std::string::npos);
  }
  EXPECT_EQ(server_.pages(), 8u);
  EXPECT_EQ(status(request("GET /")), "503");
  EXPECT_NE(ask(request("GET /")).find("Too many pages"), std::string::npos);
  listening.clear();
  const auto give_up = Clock::now() + std::chrono::seconds(10);
  while (server_.pages() > 0 && Clock::now() < give_up)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(server_.pages(), 0u) << "pages that have gone are noticed";
  EXPECT_EQ(status(request("GET /")), "200");
}

/// Browsers keep connections that they may need again: half a minute is long for those who find none.
TEST_F(RunningServer, IdleConnectionsMakeRoom) {
  ServerLimits patient;
  patient.connections = 8;
  patient.idle_if_crowded_ms = 100;
  const HttpServer server(cube_.api(), "127.0.0.1", 0, patient);
  std::vector<std::unique_ptr<Client>> idle;
  for (int i = 0; i < 8; ++i) {
    idle.push_back(std::make_unique<Client>(server.port()));
    idle.back()->send("GET /api/events HTTP/1.1\r\nHost: evil.com\r\n\r\n");
    EXPECT_NE(idle.back()->receive("}").find("403"), std::string::npos);
  }
  const auto start = Clock::now();
  std::string answer;
  while (answer.find("200 OK") == std::string::npos && Clock::now() - start < std::chrono::seconds(15)) {
    const Client late(server.port());
    late.send(request("GET /"));
    answer = late.receive();
  }
  EXPECT_NE(answer.find("200 OK"), std::string::npos)
      << "after " << (Clock::now() - start) / std::chrono::seconds(1) << " s";
}

TEST_F(RunningServer, EventsTellWhatThereIs) {
  const Client page(server_.port());
  page.send(request("GET /api/events"));
  const std::string text = page.receive("event: status\ndata: {");
  EXPECT_NE(text.find("event: scene\ndata: {\"revision\":1}"), std::string::npos);
  EXPECT_NE(text.find("event: frame\ndata: {\"frame\":1,\"revision\":1}"), std::string::npos);
}

TEST_F(RunningServer, EndsWhilePagesLook) {
  ViewedCube cube;
  auto server = std::make_unique<HttpServer>(cube.api(), "127.0.0.1", 0);
  const Client listening(server->port()), idle(server->port()), waiting(server->port());
  listening.send(request("GET /api/events"));
  listening.receive("event: status");
  waiting.send(request("GET /api/frame?mode=channel&after=1"));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // it waits for 10 s if nothing ends that
  const auto start = Clock::now();
  server.reset();
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(5));
}

TEST(HttpServer, APortIsTakenOnce) {
  ViewedCube cube;
  const HttpServer server(cube.api(), "127.0.0.1", 0);
  EXPECT_THROW(HttpServer(cube.api(), "127.0.0.1", server.port()), DeviceError);
  EXPECT_THROW(HttpServer(cube.api(), "no such address", 0), DeviceError);
}

/// Bytes of this process in memory.
std::size_t resident_bytes() {
  std::size_t pages = 0, resident = 0;
  std::FILE* const file = std::fopen("/proc/self/statm", "r");
  if (std::fscanf(file, "%zu %zu", &pages, &resident) != 2) resident = 0;
  std::fclose(file);
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// What of it is in use: allocated and not freed, in all of malloc's arenas.
std::size_t allocated_bytes() {
  const struct mallinfo2 memory = mallinfo2();
  return memory.uordblks + memory.hblkhd;
}

/// Of this process.
std::size_t threads() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

/// A thousand pages that come, look and go. When all have gone, neither what is in use (0.2 to 0.9 MiB were seen) nor what the process has
/// taken (0.5 to 0.7 MiB) is more than 2 KiB a page beyond what the first two hundred took. The threads of connections stay for later ones; how
/// many come about is up to the scheduler, some hundred at most, and each has taken memory of its own (40 KiB were seen). That a page
/// has gone is noticed when its next event is due: a hundred at a time are waited for.
TEST(HttpServer, AThousandPagesLeaveNothingBehind) {
  ViewedCube cube;
  ServerLimits many;
  many.connections = 1000;
  const HttpServer server(cube.api(), "127.0.0.1", 0, many);
  const auto all_have_gone = [&] {
    for (const auto end = Clock::now() + std::chrono::seconds(20); server.pages() > 0 && Clock::now() < end;)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return server.pages() == 0;
  };
  std::size_t resident = 0, allocated = 0, working = 0;
  for (int i = 0; i < 1200; ++i) {
    if (i == 200) {
      ASSERT_TRUE(all_have_gone());
      resident = resident_bytes(), allocated = allocated_bytes(), working = threads();
    }
    while (server.pages() > 100) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const Client events(server.port()), frames(server.port());
    events.send(request("GET /api/events"));
    frames.send(request("GET /api/frame?mode=channel"));
    ASSERT_NE(frames.receive().find("200 OK"), std::string::npos);
    ASSERT_NE(events.receive("event: frame").find("event: frame"), std::string::npos);
  }
  ASSERT_TRUE(all_have_gone());
  if (kAddressSanitizer || kThreadSanitizer)
    return;  // they keep what is freed, and notes of their own; leaks are theirs to find
  EXPECT_LT(allocated_bytes(), allocated + 1000 * 2048);
  const std::size_t more_threads = std::max(threads(), working) - working;
  EXPECT_LT(resident_bytes(), resident + 1000 * 2048 + more_threads * 65536);
  EXPECT_LT(threads(), 300u);
}

}  // namespace
}  // namespace kiloband::test
