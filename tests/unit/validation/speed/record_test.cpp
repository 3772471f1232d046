// Records as CSV and JSON, the list of cases.
#include "validation/speed/record.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "base/error.hpp"
#include "tests/support/temporary_folder.hpp"
#include "validation/speed/bench.hpp"

namespace kiloband::speed {
namespace {

Record small_record() {
  Record record;
  record.group = "channels";
  record.setup.scene = "box";
  record.setup.backend = "cpu";
  record.setup.channels = 8;
  record.quantity = "paths_per_second", record.unit = "1/s";
  record.value = 1234567.25, record.error = 0.5;
  record.error_kind = "half range";
  record.repetitions = 3;
  record.note = "a \"note\", with commas";
  record.command = "kiloband render box.xml";
  return record;
}

TEST(SpeedRecord, Csv) {
  EXPECT_EQ(
      to_csv({small_record(), Record{}}),
      "case,scene,backend,method,wavelengths,sampler,dispersion,channels,part,width,height,pool,depth,replicates,samples,"
      "series,channel_nm,quantity,value,error,unit,error_kind,repetitions,note,command\n"
      "channels,box,cpu,,,,,8,,,,,,,,,,paths_per_second,1234567.25,0.5,1/s,half range,3,"
      "\"a \"\"note\"\", with commas\",kiloband render box.xml\n"
      ",,,,,,,,,,,,,,,,,,,,,,,,\n");
}

TEST(SpeedRecord, JsonLeavesOutWhatDoesNotApply) {
  EXPECT_EQ(to_json(small_record()).dump(),
            R"({"case":"channels","scene":"box","backend":"cpu","channels":8,"quantity":"paths_per_second",)"
            R"("value":1234567.25,"error":0.5,"unit":"1/s","error_kind":"half range","repetitions":3,)"
            R"("note":"a \"note\", with commas","command":"kiloband render box.xml"})");
  EXPECT_EQ(to_json(Record{}).dump(), R"({"value":null,"error":null})");
}

/// Paths have any bytes, such as Latin-1's e with an acute accent: what was measured is written all the same.
TEST(SpeedRecord, BytesThatAreNoTextAreReplaced) {
  const test::TemporaryFolder folder;
  RunOutcome run;
  run.cases.emplace_back().records = {small_record()};
  run.cases[0].records[0].command = "kiloband bench --data d\xe9";
  write_results(folder.path(), run, {}, {});
  const auto written = nlohmann::json::parse(std::ifstream(folder / "bench.json"));
  EXPECT_EQ(written["records"][0]["command"], "kiloband bench --data d\xef\xbf\xbd");
}

TEST(SpeedCases, ByName) {
  EXPECT_EQ(chosen_cases({}).size(), cases().size());
  const auto chosen = chosen_cases({"peers", "channels"});
  ASSERT_EQ(chosen.size(), 2u);
  EXPECT_EQ(chosen[0].name, "channels") << "they run in their own order";
  EXPECT_THROW(chosen_cases({"chanels"}), InputError);
}

/// A case that fails leaves what the others measured, and says why it did.
TEST(SpeedCases, AFailureIsTheCasesOwn) {
  const Case good{"good", "", 1, 1, [](Bench& bench) { bench.add(small_record()); }};
  const Case bad{"bad", "", 1, 1, [](Bench& bench) {
                   bench.add(small_record());
                   throw DeviceError("it broke");
                 }};
  std::vector<std::string> begun;
  std::vector<std::size_t> kept;
  const RunOutcome run = run_cases(
      {bad, good}, {}, {}, [&](const std::string& name) { begun.push_back(name); },
      [&](const RunOutcome& so_far) {
        EXPECT_TRUE(so_far.interrupted);
        kept.push_back(so_far.cases.size());
      });
  EXPECT_EQ(kept, (std::vector<std::size_t>{1, 2}));
  EXPECT_FALSE(run.interrupted);
  EXPECT_EQ(begun, (std::vector<std::string>{"bad", "good"}));
  ASSERT_EQ(run.cases.size(), 2u);
  EXPECT_EQ(run.cases[0].failure, "it broke");
  EXPECT_EQ(run.cases[0].records.size(), 1u);
  EXPECT_FALSE(run.cases[0].complete);
  EXPECT_TRUE(run.cases[1].complete);
  EXPECT_TRUE(run.failed());
}

}  // namespace
}  // namespace kiloband::speed
