#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/json_dump.hpp"
#include "base/text.hpp"
#include "cube/cube_io.hpp"
#include "files/atomic_file.hpp"
#include "film/statistics.hpp"
#include "validation/suite/results.hpp"

namespace kiloband::validation {
namespace fs = std::filesystem;
namespace {

std::string escaped(std::string text) {
  replace_all(text, "&", "&amp;");
  replace_all(text, "<", "&lt;");
  replace_all(text, ">", "&gt;");
  replace_all(text, "\"", "&quot;");
  return text;
}

/// One <testcase>; failure: empty if it passed.
std::string test_case(const std::string& group, const std::string& name, double seconds,
                      const std::string& failure) {
  const std::string head = fmt::format("  <testcase classname=\"{}\" name=\"{}\" time=\"{:.3f}\"",
                                       escaped(group), escaped(name), seconds);
  if (failure.empty()) return head + "/>\n";
  return head + fmt::format(">\n    <failure message=\"{}\"/>\n  </testcase>\n", escaped(failure));
}

std::string failure_of(const PairingResult& r) {
  if (r.passed) return {};
  if (r.invalid_samples > 0) return fmt::format("{} invalid samples", r.invalid_samples);
  if (r.comparison.passed) return r.comparison.notes.empty() ? "failed" : r.comparison.notes.back();
  const stats::TestVerdict& v = r.comparison.decisive();
  std::string text = fmt::format("{}: p {:.3g}, level {:.3g}", v.name, v.p, v.level);
  if (v.worst) {
    const stats::WorstUnit& w = *v.worst;
    text += fmt::format("; {}x{} pixels at {},{}, channel {}: {:.6g} and {:.6g}, t {:.2f}", w.place.width,
                        w.place.height, w.place.x, w.place.y, w.channel, w.a, w.b, w.t);
  }
  return text;
}

std::string failure_of(const HardCaseResult& h) {
  if (!h.error.empty()) return h.error;
  std::string text;
  for (const HardFigure& f : h.figures) {
    if (!f.pass)
      text += fmt::format("{}: {:.6g} instead of {:.6g}, error {:.3g}, limit {:.3g}; ", f.name, f.value,
                          f.reference, f.error, f.limit);
  }
  return text;
}

std::string pairing_name(const PairingResult& r) {
  return r.pairing.kind == Pairing::Kind::kClosedForm
             ? r.pairing.a.label() + " against the closed form"
             : r.pairing.a.label() + " against " + r.pairing.b.label() +
                   (r.pairing.kind == Pairing::Kind::kPaired ? ", equal seeds" : "");
}

std::string file_name_of(std::string text) {
  for (char& c : text) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '/') c = '_';
  }
  return text;
}

/// Mean and variance of every pixel, as the film has them.
void write_cube(const fs::path& file, const stats::ReplicateImage& image, const ChannelList& channels) {
  CubeInfo info;
  info.width = image.width;
  info.height = image.height;
  for (const Channel& channel : channels) info.bands.push_back({channel, false});
  info.variance = true;
  info.replicates = image.replicates;
  ReplicateMoments moments(image.pixels(), image.channels, true);
  for (uint32_t r = 0; r < image.replicates; ++r) {
    for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
      const float* values = image.means.data() + (r * image.pixels() + pixel) * image.channels;
      moments.add(pixel, image.samples_at(r, pixel), {values, image.channels});
    }
  }
  std::vector<float> mean, variance(image.pixels() * image.channels);
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    mean.insert(mean.end(), moments.mean(pixel).begin(), moments.mean(pixel).end());
    moments.variance_of_mean(pixel, {variance.data() + pixel * image.channels, image.channels});
  }
  const auto writer = create_cube_writer(file, info, image.height);
  writer->write_rows({0, image.height, mean, variance, {}});
  writer->finish();
}

}  // namespace

std::string cube_name(const CaseResult& c, const SideImage& side) {
  return "cubes/" + file_name_of(c.what.name) + "/" + file_name_of(side.label);
}

std::string to_junit(const SuiteResult& result) {
  std::string body;
  std::size_t tests = 0, failures = 0;
  const auto add = [&](const std::string& group, const std::string& name, double seconds,
                       const std::string& failure) {
    body += test_case(group, name, seconds, failure);
    ++tests;
    failures += !failure.empty();
  };
  for (const CaseResult& c : result.cases) {
    if (!c.error.empty()) add(c.what.name, "scene", 0, c.error);
    for (const PairingResult& r : c.pairings)
      add(c.what.name, pairing_name(r), r.seconds_a + r.seconds_b, failure_of(r));
  }
  for (const HardCaseResult& h : result.hard_cases) add("hard/" + h.name, h.backend, 0, failure_of(h));
  for (const ConvergenceResult& c : result.convergence) add(c.name, "slopes", 0, c.passed ? "" : c.note);
  for (const MitsubaScene& s : result.mitsuba.scenes) {
    const double seconds = s.figure("/seconds_ours");
    add("mitsuba/" + s.name, s.backend, std::isfinite(seconds) ? seconds : 0, s.failure);
  }
  if (result.interrupted) {
    body +=
        "  <testcase classname=\"run\" name=\"complete\"><error message=\"the run was "
        "interrupted\"/></testcase>\n";
    ++tests;
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"kiloband validate\" tests=\"{}\" "
      "failures=\"{}\" errors=\"{}\" time=\"{:.1f}\">\n{}</testsuite>\n",
      tests, failures, result.interrupted ? 1 : 0, result.seconds, body);
}

void prepare_results(const fs::path& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) throw DeviceError(directory.string() + ": " + error.message());
  check_writable(directory / "results.json");
  for (const char* name : {"results.json", "junit.xml", "mitsuba.json", "report.html"}) {
    error = remove_output(directory / name);
    if (error) throw DeviceError((directory / name).string() + ": " + error.message());
  }
}

void write_verdicts(const fs::path& directory, const SuiteResult& result, const RunRecord& record) {
  write_file_atomically(directory / "results.json", dump_json(to_json(result, record), 1) + "\n");
  // Names of files have any bytes; a file that says it is UTF-8 has no others.
  write_file_atomically(directory / "junit.xml", json_text<nlohmann::json>(to_junit(result)));
}

void write_results(const fs::path& directory, const SuiteResult& result, const RunRecord& record) {
  std::error_code error;
  for (const CaseResult& c : result.cases) {
    for (const SideImage& side : c.images) {
      const fs::path file = directory / (cube_name(c, side) + ".hdr");
      fs::create_directories(file.parent_path(), error);
      if (error) throw DeviceError(file.parent_path().string() + ": " + error.message());
      write_cube(file, side.image, c.channels);
    }
  }
  write_verdicts(directory, result, record);
}

}  // namespace kiloband::validation
