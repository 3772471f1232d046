// Files of the program cache.
#include <sys/stat.h>

#include <fstream>

#include "src_gpu/device/program_cache.hpp"
#include "src_gpu/device/user_cache.hpp"
#include "tests/unit/src_gpu/device/gpu_fixture.hpp"

namespace kiloband::opencl::test {
namespace {

using Bytes = std::vector<unsigned char>;

/// Source: the published value of the 128-bit FNV-1a hash of nothing, which is its offset basis.
TEST(TextHash, IsFnv1a) {
  EXPECT_EQ(text_hash(""), "6c62272e07bb014262b821756295c58d");
  // (basis xor 'a') times the prime, computed by hand with Python's integers
  EXPECT_EQ(text_hash("a"), "d228cb696f1a8caf78912b704e4a8964");
}

TEST(ProgramCache, KeepsBytes) {
  const CacheFolder folder;
  const ProgramCache cache(folder.path() / "a" / "b");
  const std::string key = text_hash("program");
  EXPECT_FALSE(cache.load(key).has_value());
  const Bytes binary{1, 2, 3, 0, 255};
  EXPECT_EQ(cache.save(key, binary), "");
  EXPECT_EQ(cache.load(key), binary);
  cache.save(key, {9});
  EXPECT_EQ(cache.load(key), Bytes{9});
  // Only the file itself is left, for this user alone.
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "a" / "b")) {
    ++files;
    EXPECT_EQ(entry.status().permissions(),
              std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  }
  EXPECT_EQ(files, 1);
}

TEST(ProgramCache, OtherKeysFileIsNotTaken) {
  const CacheFolder folder;
  const ProgramCache cache(folder.path());
  cache.save(text_hash("one"), {1, 2, 3});
  std::filesystem::copy_file(cache.file(text_hash("one")), cache.file(text_hash("two")));
  EXPECT_FALSE(cache.load(text_hash("two")).has_value());
}

TEST(ProgramCache, WhatIsNoFileIsNotTaken) {
  const CacheFolder folder;
  const ProgramCache cache(folder.path());
  const std::string key = text_hash("program");
  std::filesystem::create_directory(cache.file(key));
  EXPECT_FALSE(cache.load(key).has_value());
  EXPECT_EQ(cache.save(key, {1}), "cannot write '" + cache.file(key).string() + "': Is a directory");
  EXPECT_FALSE(cache.load(key).has_value());
  const std::string pipe = text_hash("pipe");
  ASSERT_EQ(mkfifo(cache.file(pipe).c_str(), 0600), 0);
  EXPECT_FALSE(cache.load(pipe).has_value());  // and no waiting for a writer
}

TEST(ProgramCache, KeyDependsOnEverything) {
  DeviceInfo device;
  device.name = "d";
  const std::string key = ProgramCache::key("source", "options", device);
  EXPECT_EQ(key, ProgramCache::key("source", "options", device));
  EXPECT_NE(key, ProgramCache::key("sourceo", "ptions", device));
  EXPECT_NE(key, ProgramCache::key("source", "other", device));
  for (std::string DeviceInfo::*part : {&DeviceInfo::name, &DeviceInfo::driver_version, &DeviceInfo::platform,
                                        &DeviceInfo::platform_version}) {
    DeviceInfo other = device;
    other.*part = "other";
    EXPECT_NE(key, ProgramCache::key("source", "options", other));
  }
}

}  // namespace
}  // namespace kiloband::opencl::test
