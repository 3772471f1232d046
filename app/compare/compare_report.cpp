#include "app/compare/compare_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/json_dump.hpp"
#include "stats/comparison/comparison_json.hpp"

namespace kiloband {
namespace {

constexpr auto number = stats::number_json;
using stats::TestVerdict;
using stats::WorstUnit;

const char* kind_text(stats::Kind kind) {
  switch (kind) {
    case stats::Kind::kIndependent:
      return "independent";
    case stats::Kind::kPaired:
      return "paired";
    case stats::Kind::kTruth:
      return "truth";
  }
  return "";
}

std::string place_text(const WorstUnit& worst) {
  const stats::UnitPlace& p = worst.place;
  if (p.pooled) return fmt::format("thin values of {}x{} pixels at {},{}", p.width, p.height, p.x, p.y);
  if (p.width * p.height == 1) return fmt::format("pixel {},{}", p.x, p.y);
  return fmt::format("{}x{} pixels at {},{}", p.width, p.height, p.x, p.y);
}

std::string percent(double share) {
  return std::isfinite(share) ? fmt::format("{:.2g} %", 100 * share) : std::string("-");
}

/// Relative bias for means, relative change for the variances of the image.
double detectable_of(const TestVerdict& test) {
  return test.name == "mean/image" ? test.detectable.largest : test.detectable.typical;
}

std::string test_line(const TestVerdict& test, const std::vector<std::string>& names) {
  std::string line = fmt::format("{:<15} {:<9.3g} {:<9.3g} {:<4}  {:<11}", test.name, test.p, test.level,
                                 test.passed ? "same" : "DIFF", percent(detectable_of(test)));
  if (!test.worst) return line;
  const WorstUnit& w = *test.worst;
  return line + fmt::format(" {}, {}: {:.6g} and {:.6g}, t = {:.3g}", place_text(w), names[w.channel], w.a,
                            w.b, w.t);
}

/// What the means of a scale would have shown.
struct ScaleBias {
  const char *test, *scale, *typical;
};
constexpr ScaleBias kScales[] = {{"mean/image", "image", "in the median channel"},
                                 {"mean/tile", "tile", "of the median value"},
                                 {"mean/pixel", "pixel", "of the median value"}};

const TestVerdict* find_test(const stats::Comparison& r, const char* name) {
  const auto test = std::ranges::find(r.tests, name, &TestVerdict::name);
  return test != r.tests.end() && std::isfinite(test->detectable.typical) ? &*test : nullptr;
}

/// Constants are compared, but state no bias.
std::string no_bias_text(const stats::Comparison& r) {
  const bool means =
      std::ranges::any_of(r.tests, [](const TestVerdict& t) { return t.name.starts_with("mean/"); });
  return means
             ? "detectable bias: none to state, the means that were compared vary on neither side, or are 0 in A\n"
             : "detectable bias: none, no test of means had anything to test\n";
}

/// A pass says as much as what would have failed.
std::string detectable_text(const stats::Comparison& r, const std::vector<std::string>& names) {
  std::string text;
  for (const ScaleBias& scale : kScales) {
    const TestVerdict* test = find_test(r, scale.test);
    if (!test) continue;
    text += fmt::format("  {:<5}  {} {}, {} in the worst ({})\n", scale.scale,
                        percent(test->detectable.typical), scale.typical, percent(test->detectable.largest),
                        names[test->detectable.largest_channel]);
  }
  if (text.empty()) return no_bias_text(r);
  return fmt::format(
             "detectable bias: from these differences on, relative to the mean of A there, a difference is found "
             "with a probability of {:g} % or more, at a rate of false alarms of {:g} for all tests together\n",
             100 * stats::kPower, r.alpha) +
         text;
}

nlohmann::ordered_json detectable_json(const stats::Comparison& r, const std::vector<std::string>& names) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const ScaleBias& scale : kScales) {
    json[scale.scale] = nullptr;
    if (const TestVerdict* test = find_test(r, scale.test))
      json[scale.scale] = {{"median", number(test->detectable.typical)},
                           {"worst", number(test->detectable.largest)},
                           {"worst_channel", test->detectable.largest_channel},
                           {"worst_channel_name", names[test->detectable.largest_channel]}};
  }
  return json;
}

nlohmann::ordered_json worst_json(const WorstUnit& worst, const std::vector<std::string>& names) {
  nlohmann::ordered_json json = stats::to_json(worst);
  json["channel_name"] = names[worst.channel];
  return json;
}

nlohmann::ordered_json test_json(const TestVerdict& test, const std::vector<std::string>& names) {
  nlohmann::ordered_json json{{"name", test.name},
                              {"p", test.p},
                              {"level", test.level},
                              {"passed", test.passed},
                              {"detectable_typical", number(test.detectable.typical)},
                              {"detectable_largest", number(test.detectable.largest)}};
  json["worst"] = nullptr;
  if (test.worst) json["worst"] = worst_json(*test.worst, names);
  return json;
}

nlohmann::ordered_json tail_json(const std::vector<stats::TailWeight>& tails) {
  return stats::heaviest_json(tails, {"replicate_means", "top_share_of_variance", "top_share_of_sum"});
}

nlohmann::ordered_json channels_json(const CompareReport& report, const std::vector<std::string>& names) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  const stats::Comparison& r = report.result;
  for (std::size_t c = 0; c < names.size(); ++c) {
    nlohmann::ordered_json channel{{"name", names[c]},
                                   {"min_nm", report.bands[c].channel.min_nm},
                                   {"max_nm", report.bands[c].channel.max_nm}};
    if (!r.image_a.empty()) {
      channel["mean_a"] = number(r.image_a[c]);
      channel["mean_b"] = number(r.image_b[c]);
      channel["error_of_difference"] = number(r.image_error[c]);
    }
    list.push_back(channel);
  }
  return list;
}

std::string tail_text(const char* side, const std::vector<stats::TailWeight>& tails,
                      const std::vector<std::string>& names) {
  if (tails.empty()) return {};
  const std::size_t c = stats::heaviest_channel(tails);
  const stats::TailWeight& t = tails[c];
  return fmt::format("tails of {}: {:.3g} of {} replicate means carry the variance, one {} of it ({})\n",
                     side, t.effective, t.count, percent(t.top_variance), names[c]);
}

}  // namespace

std::string compare_text(const CompareReport& report) {
  const stats::Comparison& r = report.result;
  const std::vector<std::string> names = unique_band_names(report.bands);
  std::string text = fmt::format("A: {}\nB: {}\n{}x{} pixels, {} channels, {}, alpha {:g}\n\n", report.a,
                                 report.b, r.width, r.height, r.channels, kind_text(r.kind), r.alpha);
  text += "test            p         level           detectable  most different\n";
  for (const TestVerdict& test : r.tests) text += test_line(test, names) + "\n";
  text += "\n";
  if (r.pooled_variance && r.pooled_variance->entries > 0)
    text += fmt::format("variance of A / variance of B: {:.4g} (ln: +- {:.2g})\n",
                        r.pooled_variance->ratio_all, r.pooled_variance->log_error_all);
  text += tail_text("A", r.tails_a, names) + tail_text("B", r.tails_b, names);
  if (report.missing_pixels > 0)
    text += fmt::format("note: {} pixels have no values on either side\n", report.missing_pixels);
  if (report.missing_replicates > 0)
    text += fmt::format(
        "note: {} replicate means of pixels have no samples (an interrupted render) and were left out\n",
        report.missing_replicates);
  for (const std::string& note : r.notes) text += "note: " + note + "\n";
  text += detectable_text(r, names);
  if (r.passed) return text + "no difference found\n";
  return text + fmt::format("DIFFERENT: {} (p = {:.3g}, level {:.3g})\n", r.decisive().name, r.decisive().p,
                            r.decisive().level);
}

std::string compare_json(const CompareReport& report) {
  const stats::Comparison& r = report.result;
  const std::vector<std::string> names = unique_band_names(report.bands);
  nlohmann::ordered_json json;
  json["a"] = report.a;
  json["b"] = report.b;
  json["kind"] = kind_text(r.kind);
  json["alpha"] = r.alpha;
  json["passed"] = r.passed;
  json["power"] = stats::kPower;
  json["detectable_bias"] = detectable_json(r, names);
  json["width"] = r.width;
  json["height"] = r.height;
  json["quantity"] = report.quantity == Quantity::kIntegral ? "integral" : "density";
  json["missing_pixels"] = report.missing_pixels;
  json["missing_replicate_means"] = report.missing_replicates;
  json["tests"] = nlohmann::ordered_json::array();
  for (const TestVerdict& test : r.tests) json["tests"].push_back(test_json(test, names));
  json["variance_ratio"] = nullptr;
  if (r.pooled_variance && r.pooled_variance->entries > 0)
    json["variance_ratio"] = {{"ratio", r.pooled_variance->ratio_all},
                              {"log_standard_error", r.pooled_variance->log_error_all}};
  json["tails_a"] = tail_json(r.tails_a);
  json["tails_b"] = tail_json(r.tails_b);
  json["channels"] = channels_json(report, names);
  json["notes"] = r.notes;
  return dump_json(json, 2) + "\n";
}

}  // namespace kiloband
