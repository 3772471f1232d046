// kiloband bench as a user runs it.
#include <gtest/gtest.h>
#include <signal.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "tests/end_to_end/support/program.hpp"

namespace kiloband::test {
namespace {

Outcome bench(const TemporaryFolder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"bench", "--quick", "--quiet", "--no-report", "--backends", "cpu"});
  return run_program(folder, arguments);
}

/// Every number is one: finite, with a command that names the program.
void expect_numbers(const nlohmann::json& records) {
  for (const auto& record : records) {
    EXPECT_EQ(record["command"].get<std::string>().substr(0, 9), "kiloband ") << record.dump();
    if (record.contains("note")) continue;
    EXPECT_TRUE(record["value"].is_number()) << record.dump();
  }
}

TEST(Bench, NamesItsCases) {
  const TemporaryFolder folder;
  const Outcome outcome = bench(folder, {"--list"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  for (const char* name :
       {"channels ", "pool ", "memory ", "refraction ", "error ", "stages ", "peers ", "split "})
    EXPECT_NE(outcome.out.find(name), std::string::npos) << name;
  EXPECT_FALSE(std::filesystem::exists(folder / "bench_results"));
}

TEST(Bench, SpeedAgainstChannels) {
  const TemporaryFolder folder;
  const Outcome outcome = bench(folder, {"channels", "-o", "out"});
  ASSERT_EQ(outcome.code, 0) << outcome.err << outcome.out;
  const auto results = read_json(folder, "out/bench.json");
  EXPECT_EQ(results["interrupted"], false);
  EXPECT_TRUE(results["machine"]["processor"].is_string());
  const std::string command = results["cases"][0]["command"];
  EXPECT_TRUE(command.starts_with("kiloband bench channels --quick --seed 1 ")) << command;
  EXPECT_TRUE(command.ends_with(" --backends cpu -o DIR")) << command;
  std::set<std::string> quantities;
  std::set<int> channels;
  for (const auto& record : results["records"]) {
    quantities.insert(record["quantity"]);
    channels.insert(record["channels"].get<int>());
    EXPECT_GT(record["value"].get<double>(), 0);
  }
  EXPECT_EQ(quantities, (std::set<std::string>{"frames_per_second", "paths_per_second"}));
  EXPECT_EQ(channels, (std::set<int>{8, 64, 256}));
  expect_numbers(results["records"]);
  const std::string csv = folder.read("out/bench.csv");
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(csv, '\n')), results["records"].size() + 1);
}

/// A second run finds the reference and makes the same images: the same errors, bit by bit.
TEST(Bench, ErrorsRepeat) {
  const TemporaryFolder folder;
  nlohmann::json runs[2];
  for (auto& run : runs) {
    const Outcome outcome = bench(folder, {"error", "-o", "out"});
    ASSERT_EQ(outcome.code, 0) << outcome.err << outcome.out;
    run = read_json(folder, "out/bench.json")["records"];
    expect_numbers(run);
  }
  ASSERT_EQ(runs[0].size(), runs[1].size());
  std::size_t errors = 0;
  for (std::size_t i = 0; i < runs[0].size(); ++i) {
    if (runs[0][i]["quantity"] == "reference_error") {
      EXPECT_EQ(runs[0][i]["note"], "rendered in this run");
      EXPECT_EQ(runs[1][i]["note"], "found in the folder of results");
    }
    if (runs[0][i]["quantity"] != "relative_error") continue;
    EXPECT_EQ(runs[0][i]["value"], runs[1][i]["value"]);
    ++errors;
  }
  EXPECT_GE(errors, 20u);
}

TEST(Bench, AnInterruptedRunWritesWhatItHas) {
  const TemporaryFolder folder;
  const Outcome outcome = run_program(
      folder, {"bench", "channels", "error", "--quick", "--backends", "cpu", "--no-report", "-o", "out"},
      {.signal = SIGINT, .after_text = "error", .after_seconds = 0.3});
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  const auto results = read_json(folder, "out/bench.json");
  EXPECT_EQ(results["interrupted"], true);
  ASSERT_EQ(results["cases"].size(), 2u);
  EXPECT_EQ(results["cases"][0]["complete"], true);
  EXPECT_EQ(results["cases"][1]["complete"], false);
  EXPECT_FALSE(results["records"].empty());
}

TEST(Bench, WrongInput) {
  const TemporaryFolder folder;
  folder.write("file", "old");
  Outcome outcome = bench(folder, {"chanels"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err.substr(0, 49), "kiloband: no case 'chanels': there are channels, ") << outcome.err;
  outcome = bench(folder, {"channels", "--device-memory", "4GiB", "-o", "out"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(
      outcome.err,
      "kiloband: --device-memory: is read by the case pool on an OpenCL device, which does not take part\n");
  outcome = bench(folder, {"channels", "-o", "file"});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_EQ(outcome.err.substr(0, 16), "kiloband: file: ") << outcome.err;
  outcome = bench(folder, {"channels", "--root", ".", "-o", "out"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err,
            "kiloband: .: no folder validation/report there (--root must name kiloband's source folder)\n");
}

}  // namespace
}  // namespace kiloband::test
