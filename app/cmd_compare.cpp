// kiloband compare A B: are two cubes images of the same thing? Cubes of ours or of other renderers.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "app/commands.hpp"
#include "app/compare/compare_input.hpp"
#include "app/compare/compare_report.hpp"
#include "app/console/messages.hpp"
#include "app/console/open_files.hpp"
#include "app/console/output_files.hpp"
#include "app/console/standard_output.hpp"
#include "app/options/render_options.hpp"
#include "base/error.hpp"
#include "cube/cube_layout.hpp"
#include "files/atomic_file.hpp"

namespace kiloband {
namespace {

constexpr uint32_t kRowsPerStrip = 32;  // EXR tiles; a multiple of stats::kTileEdge

struct CompareOptions {
  SideOptions a{"A"}, b{"B"};
  bool paired = false, independent_pixels = false, no_variances = false, image_only = false;
  double alpha = 1e-3, rounding = 1e-5;
  std::optional<std::string> json;
};

void check_values(const CompareOptions& o) {
  if (!(o.alpha > 0 && o.alpha < 1))
    throw InputError(fmt::format("--alpha {}: must be above 0 and below 1", o.alpha));
  if (!(o.rounding >= 0 && o.rounding < 1))
    throw InputError(fmt::format("--rounding {}: must be at least 0 and below 1", o.rounding));
  for (const SideOptions* side : {&o.a, &o.b}) {
    if (side->dof && !(*side->dof >= 1))
      throw InputError(
          fmt::format("--dof-{} {}: must be at least 1", side->name == "A" ? "a" : "b", *side->dof));
  }
}

void check_sides(const CompareOptions& o, const CompareSide& a, const CompareSide& b) {
  check_same_shape("A", a.info(), "B", b.info());
  const auto count = [](const CompareSide& side) {
    return side.has_replicates() ? std::to_string(side.replicates()) : std::string("none");
  };
  if (o.paired && (!a.has_replicates() || a.replicates() != b.replicates()))
    throw InputError(
        fmt::format("--paired needs as many replicates (or renders) of A as of B: A has {}, B has {}",
                    count(a), count(b)));
  const bool replicates = a.has_replicates() && (b.has_replicates() || b.source() == ErrorSource::kExact);
  if (o.independent_pixels && replicates)
    throw InputError("--independent-pixels is for cubes with variances alone: these have replicates");
  if (o.image_only && !replicates)
    throw InputError("--image-only needs replicates (--keep-replicates) or several renders of both sides");
}

/// With one seed both sides have the same noise: differences are far smaller than the errors say.
void warn_of_equal_seeds(const CompareOptions& o, const CompareSide& a, const CompareSide& b,
                         const DiagnosticSink& sink) {
  const std::string seed = metadata_of(a.info(), "seed");
  if (o.paired || seed.empty() || seed != metadata_of(b.info(), "seed")) return;
  warn(
      sink, {},
      fmt::format("A and B have the same seed {}: their noise is common and hides nothing but the tests; use "
                  "--paired or another seed",
                  seed));
}

uint32_t replicates_with_samples(const stats::ReplicateImage& image, std::size_t pixel) {
  uint32_t count = 0;
  for (uint32_t r = 0; r < image.replicates; ++r) count += image.samples_at(r, pixel) > 0;
  return count;
}

/// Counts what an interrupted render lacks in pixels that it has reached.
void count_missing_replicates(const stats::ReplicateImage& image, CompareReport& report) {
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    const uint32_t sampled = replicates_with_samples(image, p);
    if (sampled > 0) report.missing_replicates += image.replicates - sampled;
  }
}

/// Pixels without values on one side alone are left as NaN, which is a difference.
void settle_missing(stats::ReplicateImage& a, stats::ReplicateImage& b, CompareReport& report) {
  const auto revive = [](stats::ReplicateImage& image, std::size_t p) {
    for (uint32_t r = 0; r < image.replicates; ++r) image.samples[r * image.pixels() + p] = 1;
  };
  for (std::size_t p = 0; p < a.pixels(); ++p) {
    const bool in_a = replicates_with_samples(a, p) > 0, in_b = replicates_with_samples(b, p) > 0;
    report.missing_pixels += !in_a && !in_b;
    if (in_a && !in_b) revive(b, p);
    if (!in_a && in_b) revive(a, p);
  }
}

stats::Comparison compare_replicates(stats::Kind kind, const CompareSide& a, const CompareSide& b,
                                     const stats::ComparisonOptions& options, CompareReport& report) {
  const CubeInfo& info = a.info();
  stats::StripComparison comparison(kind, info.width, info.height, info.bands.size(), a.replicates(),
                                    b.replicates(), options);
  for (uint32_t y = 0; y < info.height; y += kRowsPerStrip) {
    const uint32_t rows = std::min(kRowsPerStrip, info.height - y);
    stats::ReplicateImage strip = a.read_replicates(y, rows, info.quantity);
    stats::ReplicateImage other = b.read_replicates(y, rows, info.quantity);
    for (const stats::ReplicateImage* side : {&strip, &other}) count_missing_replicates(*side, report);
    settle_missing(strip, other, report);
    if (kind == stats::Kind::kTruth)
      comparison.add(strip, stats::Truth{{other.means.begin(), other.means.end()}, {}, true});
    else
      comparison.add(strip, other);
  }
  return comparison.finish();
}

stats::MomentImage read_moments(const CompareSide& side, uint32_t y, uint32_t rows, Quantity quantity,
                                CompareReport& report) {
  if (!side.has_replicates()) return side.read_moments(y, rows, quantity);
  const stats::ReplicateImage image = side.read_replicates(y, rows, quantity);
  count_missing_replicates(image, report);
  return moments_of(image);
}

std::size_t count_missing_pixels(const stats::MomentImage& a, const stats::MomentImage& b) {
  std::size_t missing = 0;
  for (std::size_t first = 0; first < a.mean.size(); first += a.channels) {
    bool none = true;
    for (std::size_t i = first; i < first + a.channels; ++i)
      none = none && std::isnan(a.mean[i]) && std::isnan(b.mean[i]);
    missing += none;
  }
  return missing;
}

stats::Comparison compare_moments(const CompareOptions& o, const CompareSide& a, const CompareSide& b,
                                  const stats::ComparisonOptions& options, CompareReport& report) {
  const CubeInfo& info = a.info();
  stats::MomentComparison comparison(info.width, info.height, info.bands.size(), o.independent_pixels,
                                     options);
  for (uint32_t y = 0; y < info.height; y += kRowsPerStrip) {
    const uint32_t rows = std::min(kRowsPerStrip, info.height - y);
    const stats::MomentImage strip = read_moments(a, y, rows, info.quantity, report);
    const stats::MomentImage other = read_moments(b, y, rows, info.quantity, report);
    report.missing_pixels += count_missing_pixels(strip, other);
    comparison.add(strip, other);
  }
  return comparison.finish();
}

/// The replicates of independent sides, and their variances where both say that they have
/// equally many samples.
stats::Comparison compare_independent(const CompareSide& a, const CompareSide& b,
                                      stats::ComparisonOptions options, CompareReport& report) {
  std::string unknown;
  if (options.variances && options.fine_scales) {
    if (!a.states_samples()) unknown = "A";
    if (!b.states_samples()) unknown += unknown.empty() ? "B" : " and B";
  }
  if (!unknown.empty()) options.variances = false;
  stats::Comparison result = compare_replicates(stats::Kind::kIndependent, a, b, options, report);
  if (!unknown.empty())
    result.notes.push_back(fmt::format(
        "variances were not compared: nothing says how many samples the replicates of {} have", unknown));
  return result;
}

/// Either side may be several files: FILE,FILE,...
OutputFiles output_files(const CompareOptions& o) {
  OutputFiles files;
  for (const SideOptions* side : {&o.a, &o.b}) {
    for (const std::string& file : split_files(side->files)) add_cube_input(files, side->name, file);
    if (side->variance) add_cube_input(files, side->name + "'s variances", *side->variance);
  }
  if (o.json) files.others.push_back({"--json", *o.json});
  return files;
}

int compare(const CompareOptions& o) {
  allow_many_open_files();
  const DiagnosticSink sink = print_diagnostics(false);
  check_values(o);
  check_output_files(output_files(o));
  const CompareSide a(o.a, sink), b(o.b, sink);
  check_sides(o, a, b);
  warn_of_equal_seeds(o, a, b, sink);
  stats::ComparisonOptions options;
  options.alpha = o.alpha;
  options.rounding = o.rounding;
  options.variances = !o.no_variances;
  options.fine_scales = !o.image_only;
  CompareReport report{a.describe(), b.describe(), a.info().quantity, a.info().bands};
  const bool exact = b.source() == ErrorSource::kExact;
  if (!a.has_replicates() || !(b.has_replicates() || exact))
    report.result = compare_moments(o, a, b, options, report);
  else if (exact || o.paired)
    report.result =
        compare_replicates(exact ? stats::Kind::kTruth : stats::Kind::kPaired, a, b, options, report);
  else
    report.result = compare_independent(a, b, options, report);
  if (o.json) write_file_atomically(*o.json, compare_json(report));
  answer_text(compare_text(report));
  return report.result.passed ? kDone : kFailed;
}

}  // namespace

Command add_compare(CLI::App& program) {
  auto o = std::make_shared<CompareOptions>();
  CLI::App* command = program.add_subcommand(
      "compare", "Compare two cubes statistically; exit code 1 if they differ by more than chance");
  command->add_option("A", o->a.files, "cube, or independent renders of one image: FILE,FILE,...")
      ->required();
  command->add_option("B", o->b.files, "likewise")->required();
  command->add_option("--variance-a", o->a.variance, "cube of the variances of A's mean, in A's bands");
  command->add_option("--variance-b", o->b.variance, "likewise of B");
  command->add_option("--dof-a", o->a.dof,
                      "degrees of freedom of A's variances (default: its replicates - 1)");
  command->add_option("--dof-b", o->b.dof, "likewise of B");
  command->add_flag("--b-exact", o->b.exact, "B has no errors: it is the truth");
  command->add_flag("--paired", o->paired, "equal seeds: replicate (or render) i of A belongs to that of B");
  command->add_flag(
      "--independent-pixels", o->independent_pixels,
      "pixels share no random numbers and no filter: tiles and the image are tested from variances");
  command->add_flag("--no-variances", o->no_variances,
                    "compare means alone: A and B are different estimators");
  command->add_flag("--image-only", o->image_only,
                    "compare the means of the image alone: different estimators, noise of few bright paths");
  command->add_option("--alpha", o->alpha, "rate of false alarms of the whole comparison")
      ->capture_default_str();
  command->add_option("--rounding", o->rounding, "relative difference that arithmetic may make")
      ->capture_default_str();
  command->add_option("--json", o->json, "write the results to FILE");
  return [o] { return compare(*o); };
}

}  // namespace kiloband
