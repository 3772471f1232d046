// An answer that cannot be written is an error; a reader that has enough is none.
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/end_to_end/support/program.hpp"

namespace kiloband::test {
namespace {

using Names = std::vector<std::string>;

/// Every command that prints a result.
const std::vector<Names> kCommands{{"info", "scene.xml"},
                                   {"info", "--materials"},
                                   {"trace", "scene.xml", "--pixel", "4,4", "--backend", "cpu"},
                                   {"compare", "a.hdr", "b.hdr", "--json", "c.json"},
                                   {"validate", "--list", "--quick", "--backends", "cpu"},
                                   {"devices"},
                                   {"--version"},
                                   {"render", "--help"}};

class Answers : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("scene.xml", complete_scene(""));
    for (const char* seed : {"1", "2"}) {
      const std::string output = *seed == '1' ? "a.hdr" : "b.hdr";
      const Outcome outcome =
          run_program(folder_, quiet_render("scene.xml", {"--spp", "8", "--replicates", "2", "--seed", seed,
                                                          "--keep-replicates", "-o", output}));
      ASSERT_EQ(outcome.code, 0) << outcome.err;
    }
  }

  void expect_failure(const Names& arguments, StandardOutput out, const std::string& reason) {
    const Outcome outcome = run_program(folder_, arguments, {.out = out});
    EXPECT_EQ(outcome.code, 3) << arguments.front();
    EXPECT_EQ(outcome.err, "kiloband: cannot write to standard output: " + reason + "\n")
        << arguments.front();
  }

  TemporaryFolder folder_;
};

TEST_F(Answers, ThatCannotBeWrittenAreAnError) {
  for (const Names& command : kCommands)
    expect_failure(command, StandardOutput::kFull, "No space left on device");
  EXPECT_NE(folder_.read("c.json"), "");  // what was asked for in a file is there
  for (const Names& command : {kCommands.front(), kCommands.back()})
    expect_failure(command, StandardOutput::kClosed, "Bad file descriptor");
}

/// As `kiloband info scene.xml | head -1`.
TEST_F(Answers, OfWhichTheReaderHasEnoughEndQuietly) {
  for (const Names& command : {kCommands.front(), kCommands.back()}) {
    const Outcome outcome = run_program(folder_, command, {.out = StandardOutput::kBrokenPipe});
    EXPECT_EQ(outcome.signal, SIGPIPE) << command.front();
    EXPECT_EQ(outcome.err, "") << command.front();
  }
}

/// A render answers nothing, so it needs no standard output; and no message goes into the files that would
/// otherwise be opened in place of closed streams.
TEST_F(Answers, ARenderNeedsNone) {
  const std::string expected = folder_.read("a.img");
  const Names render{"render",  "scene.xml", "--spp",        "8", "--seed", "1",
                     "--stats", "s.json",    "--replicates", "2", "-o",     "a.hdr"};
  const Outcome outcome = run_program(folder_, render, {.out = StandardOutput::kClosed, .err_closed = true});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(folder_.read("a.img"), expected);
  EXPECT_EQ(read_json(folder_, "s.json")["spp"], 8);
}

}  // namespace
}  // namespace kiloband::test
