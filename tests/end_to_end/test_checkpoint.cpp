// Checkpoints: what is refused before the render, what happens where one cannot be written, and kills.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/end_to_end/support/kills.hpp"
#include "tests/end_to_end/support/program.hpp"
#include "tests/support/effort.hpp"

namespace kiloband::test {
namespace {

using Names = std::vector<std::string>;

Names checkpointed_box(const Names& more) {
  Names arguments{"--size", "64x64", "--bands", "400:700:3", "-o", "a.hdr", "--checkpoint", "c"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return quiet_render(cornell_box(), arguments);
}

TEST(Checkpoint, OneThatExistsNeedsResume) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_program(folder, checkpointed_box({"--spp", "4"})).code, 0);
  const std::string before = folder.read("c");
  const Outcome again = run_program(folder, checkpointed_box({"--spp", "4"}));
  EXPECT_EQ(again.code, 2);
  EXPECT_EQ(again.err,
            "kiloband: --checkpoint c: exists: --resume goes on from it; remove it to render anew\n");
  EXPECT_EQ(folder.read("c"), before);
  EXPECT_EQ(run_program(folder, checkpointed_box({"--spp", "8", "--resume"})).code, 0);
}

/// The checkpoint says how many replicates are kept: none of them may be another output.
TEST(Checkpoint, ItsReplicatesAreOutputs) {
  const TemporaryFolder folder;
  Names render = quiet_render(cornell_box(), {"--size", "4x4", "--bands", "400:700:2", "--keep-replicates",
                                              "--checkpoint", "c", "-o", "q.hdr"});
  Names begun = render, resumed = render;
  begun.insert(begun.end(), {"--spp", "40", "--replicates", "20"});
  resumed.insert(resumed.end(), {"--spp", "80", "--resume", "-o", "q.r19.hdr"});
  ASSERT_EQ(run_program(folder, begun).code, 0);
  const Names files = folder.list();
  const Outcome outcome = run_program(folder, resumed);
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_EQ(folder.list(), files);
}

/// The scene asks for variances where there can be any; of one replicate there are none.
TEST(Checkpoint, ScenesThatAskForVariancesGoOnWithOneReplicate) {
  const TemporaryFolder folder;
  folder.write("m.xml",
               R"(<scene version="3.0.0"><integrator type="moment"><integrator type="path"/></integrator>
    <sensor type="perspective"/><emitter type="constant"/></scene>)");
  Names render =
      quiet_render("m.xml", {"--size", "4x4", "--bands", "400:700:2", "--checkpoint", "c", "-o", "m.hdr"});
  Names begun = render, resumed = render;
  begun.insert(begun.end(), {"--spp", "4", "--replicates", "1"});
  resumed.insert(resumed.end(), {"--spp", "8", "--resume"});
  ASSERT_EQ(run_program(folder, begun).code, 0);
  const Outcome outcome = run_program(folder, resumed);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
}

TEST(Checkpoint, WhatIsNoRegularFileIsRefusedAtOnce) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  std::filesystem::create_directory(folder / "folder");
  for (const auto& [name, kind] : {std::pair{"pipe", "a named pipe"}, std::pair{"folder", "a folder"},
                                   std::pair{"/dev/null", "a device"}}) {
    for (const Names& more : {Names{}, Names{"--resume"}}) {
      Names arguments = quiet_render(cornell_box(), {"-o", "a.hdr", "--checkpoint", name});
      arguments.insert(arguments.end(), more.begin(), more.end());
      const Outcome outcome = run_program(folder, arguments);
      EXPECT_EQ(outcome.code, 2);
      EXPECT_EQ(outcome.err, std::string("kiloband: --checkpoint ") + name + ": is " + kind +
                                 ": must be a regular file, or not be there yet\n");
    }
  }
  const Outcome none =
      run_program(folder, quiet_render(cornell_box(), {"-o", "a.hdr", "--checkpoint", "none/c"}));
  EXPECT_EQ(none.code, 3);
  EXPECT_EQ(none.err, "kiloband: cannot write 'none/c': No such file or directory\n");
  EXPECT_EQ(folder.list(), (Names{"folder", "pipe"}));
}

/// A limit of the file size stands for a full disk: the image, 49 kB, fits; the smallest checkpoint, 66 kB of one
/// replicate, does not.
TEST(Checkpoint, OneThatDoesNotFitTheDiskIsAWarning) {
  if (kThreadSanitizer) GTEST_SKIP() << "ThreadSanitizer maps a file that such a limit cuts";
  const TemporaryFolder folder;
  const Outcome outcome =
      run_program(folder, checkpointed_box({"--spp", "64", "--checkpoint-interval", "0.01s"}),
                  {.file_size_limit = 60'000});
  EXPECT_EQ(outcome.code, 0);
  const std::string reason = "warning: checkpoint: cannot write 'c': File too large: ";
  EXPECT_EQ(outcome.err, reason + "the render goes on, the next attempt follows in 0.01 s\n" + reason +
                             "this render has none, only its image\n");
  EXPECT_EQ(folder.list(), (Names{"a.hdr", "a.img"}));
  EXPECT_EQ(read_cube(folder / "a.hdr").info.samples_per_pixel, 64u);
}

TEST(Checkpoint, TheOldOneStaysWhereANewOneDoesNotFit) {
  if (kThreadSanitizer) GTEST_SKIP() << "ThreadSanitizer maps a file that such a limit cuts";
  const TemporaryFolder folder;
  ASSERT_EQ(run_program(folder, checkpointed_box({"--spp", "4"})).code, 0);
  const std::string before = folder.read("c");
  const Outcome outcome = run_program(folder, checkpointed_box({"--spp", "8", "--resume"}),
                                      {.file_size_limit = before.size() - 1});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err,
            "warning: checkpoint: cannot write 'c': File too large: what it holds is older than the image\n");
  EXPECT_EQ(folder.read("c"), before);
  EXPECT_EQ(read_cube(folder / "a.hdr").info.samples_per_pixel, 8u);
}

TEST(Checkpoint, KilledRendersEndWithTheBitsOfUninterruptedOnes) {
  const Names cpu{"--backend", "cpu", "--spp", "144"};
  const auto with = [&](const Names& more) {
    Names all = cpu;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  expect_same_files_after_kills(with({"--variance"}), 2, 1);
  expect_same_files_after_kills(with({"--sampler", "independent", "--replicates", "2"}), 2,
                                2);  // over chunks
}

}  // namespace
}  // namespace kiloband::test
