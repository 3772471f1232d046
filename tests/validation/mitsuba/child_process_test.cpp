// Programs that the suite runs: arguments as they are, both outputs, how they end, how they are stopped.
#include "validation/suite/child_process.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <thread>

namespace kiloband::validation {
namespace {

std::vector<std::string> shell(const std::string& script) {
  return {"sh", "-c", script};
}

TEST(ChildProcess, ArgumentsArePassedAsTheyAre) {
  std::vector<std::string> command = shell("for a in \"$@\"; do printf '<%s>' \"$a\"; done");
  command.insert(command.end(), {"name", "a b", "'", "\"$(echo x)\"", "*", ";exit 1", "", "-o"});
  const ChildEnd end = run_child(command, {}, {});
  EXPECT_EQ(end.code, 0);
  EXPECT_EQ(end.out, "<a b><'><\"$(echo x)\"><*><;exit 1><><-o>");
}

TEST(ChildProcess, OutputsAreCaughtAndLinesAreTold) {
  std::vector<std::string> lines;
  const ChildEnd end = run_child(shell("echo one; echo bad >&2; sleep 0.1; printf 'two\\nrest'; cat; exit 3"),
                                 {}, [&](const std::string& line) { lines.push_back(line); });
  EXPECT_EQ(end.code, 3);
  EXPECT_EQ(end.out, "one\ntwo\nrest") << "and nothing comes from standard input";
  EXPECT_EQ(end.err, "bad\n");
  EXPECT_EQ(lines, (std::vector<std::string>{"one", "two"}));
  EXPECT_FALSE(end.stopped);
}

TEST(ChildProcess, StartsInTheRootFolder) {
  EXPECT_EQ(run_child({"pwd"}, {}, {}).out, "/\n");
}

TEST(ChildProcess, MuchOutput) {
  const ChildEnd end = run_child(shell("yes 0123456789 | head -n 50000"), {}, {});
  EXPECT_EQ(end.code, 0);
  EXPECT_EQ(end.out.size(), 50000u * 11);
}

TEST(ChildProcess, SaysHowItEnded) {
  EXPECT_EQ(run_child(shell("echo done; exit 2"), {}, {}).description(), "exit code 2: done");
  EXPECT_EQ(run_child(shell("echo x; printf 'a\\nwhy\\n\\n' >&2; exit 70"), {}, {}).description(),
            "exit code 70: why");
  EXPECT_EQ(run_child(shell("exit 4"), {}, {}).description(), "exit code 4");
  const ChildEnd killed = run_child(shell("kill -KILL $$"), {}, {});
  EXPECT_EQ(killed.code, -1);
  EXPECT_EQ(killed.description(), "ended by signal 9");
  const ChildEnd missing = run_child({"./no such program"}, {}, {});
  EXPECT_EQ(missing.code, -1);
  EXPECT_EQ(missing.description(), "not started: ./no such program: No such file or directory");
}

/// Not once it is a zombie: an orphan is reaped by another process.
bool runs(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const auto name_end = text.rfind(')');
  return name_end != std::string::npos && text.at(name_end + 2) != 'Z';
}

/// Its own children end too: the shell's sleep is in the same group.
TEST(ChildProcess, StopEndsTheWholeGroup) {
  std::atomic<bool> stop = false;
  pid_t sleeper = 0;
  const auto start = std::chrono::steady_clock::now();
  const ChildEnd end =
      run_child(shell("sleep 100 & echo $!; wait"), {&stop, {}}, [&](const std::string& line) {
        sleeper = std::stoi(line);
        stop = true;
      });
  EXPECT_TRUE(end.stopped);
  EXPECT_EQ(end.signal, SIGTERM);
  ASSERT_GT(sleeper, 0);
  for (int i = 0; i < 100 && runs(sleeper); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(runs(sleeper));
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), kStopSeconds);
}

}  // namespace
}  // namespace kiloband::validation
