// Files that belong together, and temporary files.
#include "files/file_set.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <future>
#include <regex>
#include <thread>

#include "tests/support/special_files.hpp"
#include "tests/unit/cube/cube_support.hpp"

namespace kiloband {
namespace {

using namespace test;
using Names = std::vector<std::string>;
using namespace std::chrono_literals;

/// Two files of one set, each with the same text.
class Pair {
 public:
  Pair(const TemporaryFolder& folder, const std::string& text)
      : data_(folder / "x.img"), header_(folder / "x.hdr") {
    data_.write_at(0, text);
    header_.write_at(0, text);
    set_.add(data_);
    set_.add(header_);
  }
  FileSet& set() { return set_; }

 private:
  AtomicFile data_, header_;
  FileSet set_;
};

TEST(FileSet, WhoComesSecondReplacesAllFilesOfTheFirst) {
  const TemporaryFolder folder;
  Pair first(folder, "first"), second(folder, "second");
  std::atomic<bool> begun = false, second_done = false;
  first.set().before([&] {  // names are about to change
    begun = true;
    std::this_thread::sleep_for(100ms);
    EXPECT_FALSE(second_done);
  });
  auto one = std::async(std::launch::async, [&] { first.set().commit(); });
  while (!begun) std::this_thread::yield();
  second.set().commit();
  second_done = true;
  one.get();
  EXPECT_EQ(folder.read("x.img"), "second");
  EXPECT_EQ(folder.read("x.hdr"), "second");
}

TEST(FileSet, FoldersAreClaimedInOneOrder) {
  const TemporaryFolder folder;
  for (const char* name : {"a", "b"}) std::filesystem::create_directory(folder / name);
  const auto write = [&](const char* first, const char* second) {
    for (int i = 0; i < 50; ++i) {
      AtomicFile one(folder / first), two(folder / second);
      FileSet set;
      set.add(one);
      set.add(two);
      set.commit();
    }
  };
  const auto start = std::chrono::steady_clock::now();
  auto there = std::async(std::launch::async, write, "a/x", "b/x");
  write("b/x", "a/x");
  there.get();
  EXPECT_LT(std::chrono::steady_clock::now() - start, 9s);  // below the patience with a lock that is not free
}

/// Without a claim (here: a pipe is among the files) another's file may come in between.
TEST(FileSet, AMixtureIsFoundAndTakenApart) {
  const TemporaryFolder folder;
  make_pipe(folder / "pipe");
  AtomicFile data(folder / "x.img"), pipe(folder / "pipe"), header(folder / "x.hdr");
  FileSet set;
  for (AtomicFile* file : {&data, &pipe, &header}) set.add(*file);
  auto commit = std::async(std::launch::async, [&] { return error_of<DeviceError>([&] { set.commit(); }); });
  while (!std::filesystem::exists(folder / "x.img")) std::this_thread::yield();
  write_file_atomically(folder / "x.img", std::string("another's"));
  read_file(folder / "pipe");  // now the set goes on
  EXPECT_EQ(commit.get(), "cannot write '" + (folder / "x.img").string() +
                              "': another process has written it at the same time");
  EXPECT_EQ(folder.list(), (Names{"pipe", "x.img"}));
  EXPECT_EQ(folder.read("x.img"), "another's");
}

TEST(TemporaryFile, HasNoNameOrOneThatCannotBeGuessed) {
  const TemporaryFolder folder;
  std::string before;
  for (int i = 0; i < 2; ++i) {
    TemporaryFile named;
    ASSERT_EQ(named.create_named(folder.path()), 0);
    ASSERT_EQ(folder.list().size(), 1u);
    const std::string name = folder.list().front();
    EXPECT_TRUE(std::regex_match(name, std::regex("\\.kiloband-[0-9a-f]{16}\\.partial"))) << name;
    EXPECT_NE(name, before);
    before = name;
  }
  EXPECT_EQ(folder.list(), Names{});
}

TEST(TemporaryFile, IsPublishedInEitherWay) {
  const TemporaryFolder folder;
  for (const bool named : {false, true}) {
    for (const char* text : {"old", "new"}) {  // where nothing stands, and in place of what does
      TemporaryFile file;
      ASSERT_EQ(named ? file.create_named(folder.path()) : file.create(folder.path()), 0);
      ASSERT_EQ(write(file.descriptor(), text, 3), 3);
      EXPECT_EQ(file.publish(folder / "file"), 0);
      EXPECT_EQ(folder.read("file"), text);
      remove_temporary_files();  // which it is no longer
      EXPECT_EQ(folder.list(), Names{"file"});
    }
  }
}

TEST(TemporaryFile, AllAreRemovedWhenASignalEndsTheProcess) {
  const TemporaryFolder folder;
  TemporaryFile first, second;
  ASSERT_EQ(first.create_named(folder.path()), 0);
  ASSERT_EQ(second.create_named(folder.path()), 0);
  const pid_t child = fork();
  if (child == 0) {
    remove_temporary_files();  // a child's signals are not ours
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  EXPECT_EQ(folder.list().size(), 2u);
  remove_temporary_files();
  EXPECT_EQ(folder.list(), Names{});
}

}  // namespace
}  // namespace kiloband
