#include "validation/suite/mitsuba_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "cube/cube_io.hpp"
#include "stats/comparison/comparison.hpp"

namespace kiloband::validation {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

const stats::TestVerdict* test_named(const stats::Comparison& comparison, const std::string& name) {
  const auto at = std::ranges::find(comparison.tests, name, &stats::TestVerdict::name);
  return at == comparison.tests.end() ? nullptr : &*at;
}

/// The failed test with the smallest p besides that of the image's mean.
const stats::TestVerdict* failed_elsewhere(const stats::Comparison& comparison) {
  const stats::TestVerdict* worst = nullptr;
  for (const stats::TestVerdict& test : comparison.tests)
    if (!test.passed && test.name != "mean/image" && (!worst || test.p < worst->p)) worst = &test;
  return worst;
}

/// JSON has no NaN and no infinities.
json finite_or_null(double x) {
  return std::isfinite(x) ? json(x) : json();
}
json finite_or_nulls(const std::vector<double>& values) {
  json list = json::array();
  for (const double x : values) list.push_back(finite_or_null(x));
  return list;
}

/// Relative difference of largest size and its channel.
void add_differences(json& entry, const std::vector<double>& ours, const std::vector<double>& theirs) {
  double sum_ours = 0, sum_theirs = 0, largest = 0;
  std::size_t worst = 0;
  for (std::size_t k = 0; k < ours.size(); ++k) {
    sum_ours += ours[k];
    sum_theirs += theirs[k];
    const double relative = ours[k] / theirs[k] - 1;
    if (!(std::abs(relative) > std::abs(largest))) continue;
    largest = relative;
    worst = k;
  }
  entry["largest_difference"] = finite_or_null(largest);
  entry["largest_difference_channel"] = worst;
  entry["difference_all"] = finite_or_null(sum_ours / sum_theirs - 1);
}

void add_verdict(MitsubaScene& scene, const stats::Comparison& comparison) {
  json& entry = scene.entry;
  entry["ours"] = finite_or_nulls(comparison.image_a);
  entry["theirs"] = finite_or_nulls(comparison.image_b);
  entry["error"] = finite_or_nulls(comparison.image_error);
  add_differences(entry, comparison.image_a, comparison.image_b);
  entry["pixels"] = nullptr;
  if (const stats::TestVerdict* image = test_named(comparison, "mean/image")) {
    entry["p"] = image->p;
    entry["level"] = image->level;
    entry["detectable"] = {{"typical", finite_or_null(image->detectable.typical)},
                           {"largest", finite_or_null(image->detectable.largest)}};
  }
  if (const stats::TestVerdict* other = failed_elsewhere(comparison))
    entry["pixels"] = {{"name", other->name}, {"p", other->p}};
}

std::string failure_of(const MitsubaScene& scene) {
  std::string text =
      fmt::format("channel means: p {:.3g}, level {:.3g}, largest difference {:+.3g} %", scene.figure("/p"),
                  scene.figure("/level"), 100 * scene.figure("/largest_difference"));
  if (const json& pixels = scene.entry["pixels"]; pixels.is_object())
    text += fmt::format("; {}: p {:.3g}", pixels["name"].get<std::string>(), scene.figure("/pixels/p"));
  return text;
}

void check_cube(const fs::path& file, const CubeInfo& info, const ChannelList& channels) {
  if (info.width != kMitsubaSize || info.height != kMitsubaSize || info.bands.size() != channels.size() ||
      info.quantity != Quantity::kIntegral)
    throw InputError(fmt::format("{}: not {} x {} pixels of {} integrals over channels", file.string(),
                                 kMitsubaSize, kMitsubaSize, channels.size()));
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const Band& band = info.bands[c];
    const double allowed = 1e-3 * (channels[c].max_nm - channels[c].min_nm);
    if (band.derived || std::abs(band.channel.min_nm - channels[c].min_nm) > allowed ||
        std::abs(band.channel.max_nm - channels[c].max_nm) > allowed)
      throw InputError(fmt::format("{}: channel {} is not {:.10g}-{:.10g} nm", file.string(), c,
                                   channels[c].min_nm, channels[c].max_nm));
  }
}

}  // namespace

std::vector<MitsubaCase> mitsuba_cases(const fs::path& root) {
  const auto own = [&](const char* name, uint32_t theirs, const char* what) {
    return MitsubaCase{name, fs::absolute(root / "validation/mitsuba/scenes" / (std::string(name) + ".xml")),
                       192, theirs, what};
  };
  return {{"cornell_box", fs::absolute(root / "scenes/cornell_box/cornell_box.xml"), 384, 3072,
           "measured spectra, depth 6"},
          own("metals_and_sky", 768, "conductors under a grey environment map"),
          own("glass", 768, "smooth, rough and coloured dielectrics, caustics"),
          own("plastics", 768, "smooth and rough plastics"),
          own("panes_and_blends", 768, "thin dielectrics, blends of every kind"),
          own("lamps", 1536, "seven kinds of lamp, mask, two sides, orthographic camera"),
          own("pictures", 768, "spots with textures, projectors"),
          own("varied", 768, "roughness from images, attributes of meshes"),
          own("principled", 768, "principled materials, thick and thin"),
          own("bumps", 768, "bump and normal maps on all shapes, from behind"),
          own("instances", 768, "groups that are turned, stretched and mirrored"),
          own("lens_and_textures", 768, "thin lens, textures, black body")};
}

double MitsubaScene::figure(const char* pointer) const {
  const json::json_pointer at(pointer);
  return entry.contains(at) && entry[at].is_number() ? entry[at].get<double>()
                                                     : std::numeric_limits<double>::quiet_NaN();
}

stats::ReplicateImage read_mitsuba_cubes(const fs::path& stem, uint32_t samples) {
  const ChannelList channels = parse_channels(kMitsubaBands);
  stats::ReplicateImage image{kMitsubaSize, kMitsubaSize, channels.size(), kMitsubaReplicates, {}, {}};
  const std::size_t values = image.pixels() * image.channels;
  image.means.resize(kMitsubaReplicates * values);
  image.samples.assign(kMitsubaReplicates * image.pixels(), samples);
  for (uint32_t r = 0; r < kMitsubaReplicates; ++r) {
    const fs::path file = fmt::format("{}.r{:02d}.hdr", stem.string(), r);
    const auto cube = open_cube(file);
    check_cube(file, cube->info(), channels);
    cube->read_rows(0, kMitsubaSize, std::span(image.means).subspan(r * values, values), {});
  }
  return image;
}

MitsubaScene compare_with_mitsuba(const MitsubaCase& c, const std::string& backend, const Rendering& ours,
                                  const stats::ReplicateImage& theirs, double level) {
  stats::ComparisonOptions options;
  options.alpha = level;
  options.variances = false;
  const stats::Comparison comparison = stats::compare_independent(ours.image, theirs, options);
  MitsubaScene scene{c.name, backend, comparison.passed && ours.invalid_samples == 0, {}, {}};
  json channels = json::array();
  for (const Channel& channel : parse_channels(kMitsubaBands))
    channels.push_back({channel.min_nm, channel.max_nm});
  scene.entry = {{"what", c.what},
                 {"channels_nm", channels},
                 {"replicates", ours.image.replicates},
                 {"samples_ours", ours.image.samples.empty() ? 0 : ours.image.samples.front()},
                 {"samples_theirs", theirs.samples.empty() ? 0 : theirs.samples.front()},
                 {"width", ours.image.width},
                 {"height", ours.image.height},
                 {"seconds_ours", ours.seconds}};
  add_verdict(scene, comparison);
  if (!scene.passed) scene.failure = failure_of(scene);
  if (ours.invalid_samples > 0) scene.failure += fmt::format("; {} invalid samples", ours.invalid_samples);
  return scene;
}

}  // namespace kiloband::validation
