#include "validation/suite/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include "base/error.hpp"
#include "base/text.hpp"

namespace kiloband::validation {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kPollMilliseconds = 50;

/// Both ends close when a program is started; the child's copy does not.
class Pipe {
 public:
  Pipe() {
    if (pipe2(ends_, O_CLOEXEC) != 0) throw DeviceError(std::string("no pipe: ") + std::strerror(errno));
  }
  ~Pipe() {
    close_write_end();
    close(ends_[0]);
  }
  Pipe(const Pipe&) = delete;

  int read_end() const { return ends_[0]; }
  int write_end() const { return ends_[1]; }
  void close_write_end() {
    if (ends_[1] >= 0) close(ends_[1]);
    ends_[1] = -1;
  }

 private:
  int ends_[2] = {-1, -1};
};

/// posix_spawnp with the pipes as output, in "/". Returns an error number, 0 for none.
int spawn(const std::vector<std::string>& command, const Pipe& out, const Pipe& err, pid_t& process) {
  std::vector<char*> arguments;
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out.write_end(), 1);
  posix_spawn_file_actions_adddup2(&actions, err.write_end(), 2);
  posix_spawn_file_actions_addchdir_np(&actions, "/");
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  const int error = posix_spawnp(&process, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  return error;
}

/// A running child; what it prints is collected, what it prints on standard output also told line by line.
class Child {
 public:
  Child(pid_t process, const Pipe& out, const Pipe& err, const std::function<void(const std::string&)>& heard)
      : process_(process),
        pipes_{{{out.read_end(), POLLIN, 0}, {err.read_end(), POLLIN, 0}}},
        heard_(heard) {}

  ChildEnd follow(const Watch& watch) {
    int status = 0;
    while (waitpid(process_, &status, WNOHANG) != process_) {
      listen(kPollMilliseconds);
      if (watch.stopped()) stop();
    }
    // What it left in the pipes; what its own children may still write is not waited for.
    while (listen(0)) {
    }
    if (WIFEXITED(status)) end_.code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) end_.signal = WTERMSIG(status);
    return end_;
  }

 private:
  /// Returns whether there was something.
  bool listen(int milliseconds) {
    if (pipes_[0].fd < 0 && pipes_[1].fd < 0)  // closed both, but runs
      std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    if (poll(pipes_.data(), pipes_.size(), milliseconds) <= 0) return false;
    const bool out = read_from(pipes_[0], end_.out), err = read_from(pipes_[1], end_.err);
    for (auto end = end_.out.find('\n', told_); heard_ && end != std::string::npos;
         end = end_.out.find('\n', told_)) {
      heard_(end_.out.substr(told_, end - told_));
      told_ = end + 1;
    }
    return out || err;
  }

  static bool read_from(pollfd& pipe, std::string& text) {
    if (pipe.fd < 0 || pipe.revents == 0) return false;
    std::array<char, 4096> buffer;
    const ssize_t count = read(pipe.fd, buffer.data(), buffer.size());
    if (count > 0) text.append(buffer.data(), static_cast<std::size_t>(count));
    if (count == 0) pipe.fd = -1;
    return count > 0;
  }

  void stop() {
    if (!end_.stopped) {
      end_.stopped = true;
      kill(-process_, SIGTERM);
      stopped_at_ = Clock::now();
    } else if (std::chrono::duration<double>(Clock::now() - stopped_at_).count() > kStopSeconds) {
      kill(-process_, SIGKILL);
    }
  }

  pid_t process_;
  std::array<pollfd, 2> pipes_;
  const std::function<void(const std::string&)>& heard_;
  ChildEnd end_;
  std::size_t told_ = 0;  // bytes of end_.out
  Clock::time_point stopped_at_;
};

std::string last_line(std::string_view text) {
  text = trimmed(text);
  return std::string(text.substr(text.rfind('\n') + 1));
}

}  // namespace

std::string ChildEnd::description() const {
  const std::string said = last_line(err.empty() ? out : err);
  const std::string how = signal != 0 ? fmt::format("ended by signal {}", signal)
                          : code >= 0 ? fmt::format("exit code {}", code)
                                      : "not started";
  return said.empty() ? how : how + ": " + said;
}

ChildEnd run_child(const std::vector<std::string>& command, const Watch& watch,
                   const std::function<void(const std::string& line)>& heard) {
  Pipe out, err;
  pid_t process = 0;
  if (const int error = spawn(command, out, err, process); error != 0) {
    ChildEnd end;
    end.err = command.front() + ": " + std::strerror(error);
    return end;
  }
  out.close_write_end();
  err.close_write_end();
  return Child(process, out, err, heard).follow(watch);
}

}  // namespace kiloband::validation
