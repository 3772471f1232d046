// Measurements of `kiloband tune` on disk: what is kept is found again, by its device alone, and nothing else is believed.
#include "src_gpu/tuning/tuning_store.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <thread>

#include "base/error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace kiloband::test::tuning_store_test {
namespace {

using namespace opencl;

DeviceInfo some_device() {
  DeviceInfo device;
  device.name = "Some GPU";
  device.driver_version = "1.2";
  device.compute_units = 8;
  return device;
}

TunedMethod measured(const std::string& method, uint32_t channels, uint32_t slots) {
  TunedMethod one;
  one.method = method;
  one.channels = channels;
  one.tuning.pool_slots = slots;
  one.scene = "a scene";
  one.speed_up = 1.25;
  return one;
}

class TuningStoreTest : public testing::Test {
 protected:
  void write(const std::string& text) const {
    std::filesystem::create_directories(store_.file(device_).parent_path());
    std::ofstream(store_.file(device_)) << text;
  }

  TemporaryFolder folder_;
  TuningStore store_{folder_.path() / "kiloband" / "tuning"};
  DeviceInfo device_ = some_device();
};

TEST_F(TuningStoreTest, FindsWhatItKept) {
  EXPECT_TRUE(store_.load(device_).empty());
  TunedMethod all = measured("dpept-batch", 64, 4096);
  all.tuning = {4096, uint64_t{1} << 25, 128, 64};
  all.items_of_path = 32;
  EXPECT_EQ(store_.save(device_, all), "");
  EXPECT_EQ(store_.save(device_, measured("pt", 64, 512)), "");
  const auto found = store_.load(device_);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].tuning, all.tuning);
  EXPECT_EQ(found[0].method, "dpept-batch");
  EXPECT_EQ(found[0].channels, 64u);
  EXPECT_EQ(found[0].items_of_path, 32u);
  EXPECT_EQ(found[0].scene, "a scene");
  EXPECT_EQ(found[0].speed_up, 1.25);
  EXPECT_EQ(found[1].tuning, (Tuning{512, {}, {}, {}}));
}

TEST_F(TuningStoreTest, ALaterMeasurementTakesThePlace) {
  store_.save(device_, measured("dpept-batch", 64, 4096));
  store_.save(device_, measured("dpept-batch", 8, 1024));
  store_.save(device_, measured("dpept-batch", 64, 2048));
  const auto found = store_.load(device_);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(tuning_for(found, "dpept-batch", 64, 1).pool_slots, 2048u);
  EXPECT_EQ(tuning_for(found, "dpept-batch", 8, 1).pool_slots, 1024u);
}

TEST_F(TuningStoreTest, OtherDevicesAndDriversHaveTheirOwn) {
  store_.save(device_, measured("dpept-batch", 64, 4096));
  DeviceInfo other = device_;
  other.driver_version = "1.3";
  EXPECT_TRUE(store_.load(other).empty());
  other = device_;
  other.compute_units = 4;  // half of it
  EXPECT_TRUE(store_.load(other).empty());
  EXPECT_FALSE(store_.forget(other));
  EXPECT_TRUE(store_.forget(device_));
  EXPECT_TRUE(store_.load(device_).empty());
}

TEST_F(TuningStoreTest, BelievesNoStrangeFile) {
  const std::string head = R"({"format": 2, "device": "Some GPU", "tuned": [)";
  const std::string one = R"({"method": "pt", "channels": 8, "scene": "", "speed_up": 1)";
  write(head + one + R"(, "pool_slots": 4096}]})");
  EXPECT_EQ(store_.load(device_).size(), 1u);
  for (const std::string& text :
       {std::string(), std::string("{"), std::string("[]"), head + "7]}",
        head + one + R"(, "pool_slots": 3}]})", head + one + R"(, "pool_slots": -4096}]})",
        head + one + R"(, "round_paths": 1e30}]})", head + one + R"(, "path_group": 0}]})",
        head + one + R"(, "evaluation_group": "64"}]})",
        std::string(R"({"format": 1, "device": "Some GPU", "tuned": []})"),
        std::string(R"({"format": 2, "device": "Another", "tuned": []})") + ""}) {
    write(text);
    EXPECT_TRUE(store_.load(device_).empty()) << text;
  }
}

TEST_F(TuningStoreTest, SaysWhyNothingIsKept) {
  EXPECT_NE(TuningStore({}).save(device_, measured("pt", 8, 512)), "");
  std::ofstream(folder_.path() / "file") << "no folder";
  const TuningStore blocked(folder_.path() / "file" / "tuning");
  EXPECT_NE(blocked.save(device_, measured("pt", 8, 512)).find("cannot write"), std::string::npos);
  EXPECT_FALSE(blocked.forget(device_));
}

TEST_F(TuningStoreTest, WhatCannotBeReadIsNoError) {
  const std::filesystem::path file = store_.file(device_);
  std::filesystem::create_directories(file / "in the file's place");
  EXPECT_TRUE(store_.load(device_).empty());
  EXPECT_NE(store_.save(device_, measured("pt", 8, 512)), "");
  EXPECT_NE(store_.refusal(device_), "");
  EXPECT_THROW(store_.forget(device_), DeviceError);
  std::filesystem::remove_all(file);
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  EXPECT_TRUE(store_.load(device_).empty());  // without waiting for somebody who writes
}

/// What save() would say after minutes of measuring.
TEST_F(TuningStoreTest, SaysBeforehandWhatCannotBeKept) {
  EXPECT_EQ(store_.refusal(device_), "");
  EXPECT_TRUE(store_.load(device_).empty());
  EXPECT_NE(TuningStore({}).refusal(device_), "");
  std::ofstream(folder_.path() / "file") << "no folder";
  EXPECT_NE(TuningStore(folder_.path() / "file" / "tuning").refusal(device_), "");
}

TEST_F(TuningStoreTest, DevicesMayHaveNamesInAnyEncoding) {
  for (const char* name : {"Gr\xe4"
                           "fik",
                           "Gr\xc3\xa4"
                           "fik",
                           "\"quoted\"\n\\"}) {
    device_.name = name;
    EXPECT_EQ(store_.save(device_, measured("pt", 8, 512)), "");
    EXPECT_EQ(store_.save(device_, measured("dpept-batch", 8, 1024)), "");
    EXPECT_EQ(store_.load(device_).size(), 2u) << name;
  }
}

TEST_F(TuningStoreTest, MeasurementsAtTheSameTimeAreAllKept) {
  constexpr uint32_t kEach = 20;
  const auto keep = [&](const std::string& method) {
    for (uint32_t channels = 1; channels <= kEach; ++channels)
      EXPECT_EQ(store_.save(device_, measured(method, channels, 512)), "");
  };
  {
    const std::jthread other(keep, "pt");
    keep("dpept-batch");
  }
  EXPECT_EQ(store_.load(device_).size(), 2 * kEach);
}

TEST(Tuning, OfTheNearestNumberOfChannels) {
  const std::vector<TunedMethod> tuned{measured("dpept-batch", 8, 800), measured("dpept-batch", 512, 51200),
                                       measured("pt", 64, 6400)};
  EXPECT_EQ(tuning_for(tuned, "dpept-batch", 1, 1).pool_slots, 800u);
  EXPECT_EQ(tuning_for(tuned, "dpept-batch", 63, 1).pool_slots, 800u);
  EXPECT_EQ(tuning_for(tuned, "dpept-batch", 65, 1).pool_slots, 51200u);
  EXPECT_EQ(tuning_for(tuned, "dpept-path", 64, 1), Tuning{});
  EXPECT_EQ(tuning_for({}, "pt", 64, 1), Tuning{});
}

/// Groups of 256 are two pixels of 128 work-items, and eight of 32.
TEST(Tuning, GroupsOfEvaluationAreThoseOfPathsSharedByAsMany) {
  TunedMethod one = measured("dpept-batch", 512, 800);
  one.tuning.evaluation_group = 256;
  one.items_of_path = 128;
  EXPECT_EQ(tuning_for({one}, "dpept-batch", 512, 128), one.tuning);
  EXPECT_EQ(tuning_for({one}, "dpept-batch", 512, 32), (Tuning{800, {}, {}, {}}));
}

TEST(Tuning, WhatIsAskedForComesFirst) {
  const Tuning asked{64, {}, 32, {}}, found{128, 1024, {}, {}};
  EXPECT_EQ(merged(asked, found), (Tuning{64, 1024, 32, {}}));
  EXPECT_EQ(describe(merged(asked, found)),
            "paths in flight 64, paths of a round 1024, group of path generation 32");
  EXPECT_EQ(describe({}), "the usual sizes");
}

}  // namespace
}  // namespace kiloband::test::tuning_store_test
