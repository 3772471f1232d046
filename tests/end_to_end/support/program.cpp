#include "tests/end_to_end/support/program.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>

namespace kiloband::test {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double kTimeout = 120;  // seconds; sanitizer builds are slow

struct Pipe {
  Pipe() {
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe2 failed");
  }
  int ends[2];
};

bool redirect(const Treatment& treatment, const Pipe& out, const Pipe& err) {
  if (dup2(err.ends[1], STDERR_FILENO) < 0) return false;
  if (treatment.err_closed) close(STDERR_FILENO);
  switch (treatment.out) {
    case StandardOutput::kRead:
      return dup2(out.ends[1], STDOUT_FILENO) >= 0;
    case StandardOutput::kFull:
      return dup2(open("/dev/full", O_WRONLY | O_CLOEXEC), STDOUT_FILENO) >= 0;
    case StandardOutput::kClosed:
      return close(STDOUT_FILENO) == 0;
    case StandardOutput::kBrokenPipe:
      break;
  }
  const Pipe broken;
  close(broken.ends[0]);
  return dup2(broken.ends[1], STDOUT_FILENO) >= 0;
}

[[noreturn]] void become_program(const TemporaryFolder& folder, const std::vector<std::string>& arguments,
                                 const Treatment& treatment, const Pipe& out, const Pipe& err) {
  std::vector<char*> argv;
  for (const std::string& word : treatment.under) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(const_cast<char*>(argv.empty() ? "kiloband" : KILOBAND_PROGRAM));
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  for (const int number : {SIGINT, SIGTERM, SIGPIPE, SIGXFSZ})
    signal(number, SIG_DFL);  // whatever runs the tests
  for (const auto& [name, value] : treatment.environment) setenv(name.c_str(), value.c_str(), 1);
  bool ready = chdir(folder.path().c_str()) == 0 && redirect(treatment, out, err);
  if (treatment.file_size_limit) {
    const rlimit limit{*treatment.file_size_limit, *treatment.file_size_limit};
    ready = ready && setrlimit(RLIMIT_FSIZE, &limit) == 0;
  }
  if (treatment.process_limit) {
    const rlimit limit{*treatment.process_limit, *treatment.process_limit};
    ready = ready && setrlimit(RLIMIT_NPROC, &limit) == 0 && setgid(65533) == 0 && setuid(65533) == 0;
  }
  if (treatment.unprivileged && geteuid() == 0) ready = ready && setgid(65534) == 0 && setuid(65534) == 0;
  if (ready && treatment.under.empty()) execv(KILOBAND_PROGRAM, argv.data());
  if (ready) execvp(argv.front(), argv.data());
  _exit(126);
}

/// Appends what is there to read; false at the end.
bool drain(int descriptor, std::string& text) {
  char buffer[4096];
  const ssize_t size = read(descriptor, buffer, sizeof buffer);
  if (size > 0) text.append(buffer, static_cast<std::size_t>(size));
  return size > 0;
}

/// Reads both pipes until the program has closed them; sends the signal on the way.
void follow(pid_t process, const Treatment& treatment, int out, int err, Outcome& outcome) {
  const auto start = Clock::now();
  const auto passed = [](Clock::time_point since) {
    return std::chrono::duration<double>(Clock::now() - since).count();
  };
  std::optional<Clock::time_point> trigger;
  bool sent = treatment.signal == 0, sent_again = sent || !treatment.again_after_seconds;
  pollfd pipes[2] = {{out, POLLIN, 0}, {err, POLLIN, 0}};
  std::string* texts[2] = {&outcome.out, &outcome.err};
  while (pipes[0].fd >= 0 || pipes[1].fd >= 0) {
    poll(pipes, 2, 10);
    for (int i = 0; i < 2; ++i) {
      if (pipes[i].fd >= 0 && pipes[i].revents != 0 && !drain(pipes[i].fd, *texts[i])) pipes[i].fd = -1;
    }
    if (!trigger && outcome.err.find(treatment.after_text) != std::string::npos) trigger = Clock::now();
    if (!sent && trigger && passed(*trigger) >= treatment.after_seconds) {
      sent = true;
      kill(process, treatment.signal);
      trigger = Clock::now();
    } else if (sent && !sent_again && passed(*trigger) >= *treatment.again_after_seconds) {
      sent_again = true;
      kill(process, treatment.signal);
    }
    if (passed(start) > kTimeout) kill(process, SIGKILL);
  }
  outcome.seconds = passed(start);
}

}  // namespace

Outcome run_program(const TemporaryFolder& folder, const std::vector<std::string>& arguments,
                    const Treatment& treatment) {
  const Pipe out, err;
  const pid_t process = fork();
  if (process < 0) throw std::runtime_error("fork failed");
  if (process == 0) become_program(folder, arguments, treatment, out, err);
  close(out.ends[1]);
  close(err.ends[1]);
  Outcome outcome;
  follow(process, treatment, out.ends[0], err.ends[0], outcome);
  close(out.ends[0]);
  close(err.ends[0]);
  int status = 0;
  waitpid(process, &status, 0);
  if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
  return outcome;
}

nlohmann::json read_json(const TemporaryFolder& folder, const std::string& name) {
  return nlohmann::json::parse(folder.read(name));
}

Outcome compare(const TemporaryFolder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "compare");
  return run_program(folder, arguments);
}

void expect_text(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << part << " is not in: " << text;
}

std::string cornell_box() {
  return KILOBAND_SOURCE_DIR "/scenes/cornell_box/cornell_box.xml";
}

std::vector<std::string> quiet_render(const std::string& scene, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"render", scene, "--quiet"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

std::string scene_text(const std::string& body) {
  return "<scene version=\"3.0.0\">\n" + body + "\n</scene>\n";
}

std::string complete_scene(const std::string& body) {
  return scene_text(body + "\n" + kSensor + kLight + kSphere);
}

}  // namespace kiloband::test
