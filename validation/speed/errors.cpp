#include "validation/speed/errors.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "stats/distributions.hpp"

namespace kiloband::speed {
namespace {

/// Beyond this part of a squared error that is the reference's, the difference of the two is no longer well known.
constexpr double kResolved = 0.5;
/// Rate of false alarms of "the means differ".
constexpr double kMeansLevel = 1e-4;

/// Units by channels of one image: pixels, tiles or the whole.
struct Units {
  std::size_t count = 0;
  std::vector<double> values;  // [unit][channel]
};

/// edge: of a unit in pixels; 0: the image. at(pixel, channel): the image
template <class At>
Units units_of(uint32_t width, uint32_t height, std::size_t channels, uint32_t edge, const At& at) {
  const uint32_t columns = edge == 0 ? 1 : (width + edge - 1) / edge;
  const uint32_t rows = edge == 0 ? 1 : (height + edge - 1) / edge;
  Units units{std::size_t{columns} * rows, {}};
  units.values.assign(units.count * channels, 0.0);
  std::vector<double> sizes(units.count, 0.0);
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      const std::size_t unit = edge == 0 ? 0 : std::size_t{y / edge} * columns + x / edge;
      sizes[unit] += 1;
      for (std::size_t c = 0; c < channels; ++c)
        units.values[unit * channels + c] += at(std::size_t{y} * width + x, c);
    }
  }
  for (std::size_t u = 0; u < units.count; ++u)
    for (std::size_t c = 0; c < channels; ++c) units.values[u * channels + c] /= sizes[u];
  return units;
}

std::vector<Units> replicates_of(const stats::ReplicateImage& image, uint32_t edge) {
  std::vector<Units> all;
  for (uint32_t r = 0; r < image.replicates; ++r)
    all.push_back(units_of(image.width, image.height, image.channels, edge,
                           [&](std::size_t p, std::size_t c) { return double{image.at(r, p, c)}; }));
  return all;
}

/// The reference at one scale: its values, and per channel the mean over units of its variance.
struct ReferenceUnits {
  Units mean;
  std::vector<Estimate> variance;  // per channel, relative to the channel's mean
};

/// s^2 / R of a unit from R replicates has the relative standard error sqrt(2 / (R - 1)); units of a channel share µ and
/// light, so nothing is gained from their number.
ReferenceUnits reference_units(const stats::ReplicateImage& image, uint32_t edge,
                               const std::vector<double>& level) {
  const std::vector<Units> replicates = replicates_of(image, edge);
  const auto n = static_cast<double>(replicates.size());
  ReferenceUnits result{replicates.front(), {}};
  const std::size_t channels = image.channels;
  std::vector<double> variance(channels, 0.0);
  for (std::size_t i = 0; i < result.mean.values.size(); ++i) {
    double sum = 0, squares = 0;
    for (const Units& r : replicates) sum += r.values[i];
    for (const Units& r : replicates) squares += (r.values[i] - sum / n) * (r.values[i] - sum / n);
    result.mean.values[i] = sum / n;
    variance[i % channels] += squares / (n - 1) / n / static_cast<double>(result.mean.count);
  }
  for (std::size_t c = 0; c < channels; ++c) {
    const double relative = variance[c] / (level[c] * level[c]);
    result.variance.push_back({relative, relative * std::sqrt(2 / (n - 1))});
  }
  return result;
}

std::vector<double> channel_levels(const stats::ReplicateImage& image) {
  std::vector<double> levels(image.channels, 0.0);
  for (std::size_t i = 0; i < image.means.size(); ++i) levels[i % image.channels] += image.means[i];
  for (double& level : levels) level /= static_cast<double>(image.pixels()) * image.replicates;
  return levels;
}

/// [channel]: mean over units of ((x - r) / m)^2 of one repetition.
std::vector<double> squares_of(const std::vector<float>& image, const Repetitions& all, uint32_t edge,
                               const ReferenceUnits& reference, const std::vector<double>& level) {
  const std::size_t channels = all.channels;
  const Units units = units_of(all.width, all.height, channels, edge,
                               [&](std::size_t p, std::size_t c) { return double{image[p * channels + c]}; });
  std::vector<double> squares(channels, 0.0);
  for (std::size_t i = 0; i < units.values.size(); ++i) {
    const double d = (units.values[i] - reference.mean.values[i]) / level[i % channels];
    squares[i % channels] += d * d / static_cast<double>(units.count);
  }
  return squares;
}

ScaleErrors errors_at(const char* scale, uint32_t edge, const Repetitions& all, const Reference& reference,
                      const std::vector<double>& level) {
  const ReferenceUnits of_reference = reference_units(reference.image, edge, level);
  ScaleErrors errors{scale, {}, {}, 0};
  std::vector<std::vector<double>> by_channel(all.channels);
  std::vector<double> together;
  for (const std::vector<float>& image : all.images) {
    const std::vector<double> squares = squares_of(image, all, edge, of_reference, level);
    double sum = 0, lit = 0;
    for (std::size_t c = 0; c < all.channels; ++c) {
      by_channel[c].push_back(squares[c]);
      if (level[c] > 0) sum += squares[c], ++lit;
    }
    together.push_back(sum / lit);
  }
  Estimate own{0, 0};
  double lit = 0;
  for (std::size_t c = 0; c < all.channels; ++c) {
    errors.channels.push_back(level[c] > 0 ? without_reference(by_channel[c], of_reference.variance[c])
                                           : Estimate{kNone, kNone});
    if (!(level[c] > 0)) continue;
    own.value += of_reference.variance[c].value, own.error += of_reference.variance[c].error, ++lit;
  }
  own = {own.value / lit, own.error / lit};
  errors.square = without_reference(together, own);
  errors.reference = own.value;
  return errors;
}

std::string note_of(const ScaleErrors& errors) {
  const double share = errors.reference / (errors.reference + errors.square.value);
  if (!(errors.square.value > 0)) return "below the reference's own error: not resolved";
  if (share > kResolved)
    return fmt::format("{:.0f} % of the squared difference are the reference's own", 100 * share);
  return {};
}

}  // namespace

std::vector<ScaleErrors> errors_of(const Repetitions& repetitions, const Reference& reference) {
  if (repetitions.width != reference.image.width || repetitions.height != reference.image.height ||
      repetitions.channels != reference.image.channels)
    throw std::logic_error("an image and its reference differ in shape");
  const std::vector<double> level = channel_levels(reference.image);
  return {errors_at("pixel", 1, repetitions, reference, level),
          errors_at("tile", stats::kTileEdge, repetitions, reference, level),
          errors_at("image", 0, repetitions, reference, level)};
}

MeanDifference compare_means(const Repetitions& repetitions, const Reference& reference) {
  const std::vector<double> level = channel_levels(reference.image);
  const ReferenceUnits own = reference_units(reference.image, 0, level);
  std::vector<std::vector<double>> of_channel(repetitions.channels);
  std::vector<double> together;
  for (const std::vector<float>& image : repetitions.images) {
    const Units mean =
        units_of(repetitions.width, repetitions.height, repetitions.channels, 0,
                 [&](std::size_t p, std::size_t c) { return double{image[p * repetitions.channels + c]}; });
    double sum = 0, lit = 0;
    for (std::size_t c = 0; c < repetitions.channels; ++c) {
      if (!(level[c] > 0)) continue;
      of_channel[c].push_back(mean.values[c] / level[c] - 1);
      sum += of_channel[c].back(), ++lit;
    }
    together.push_back(sum / lit);
  }
  MeanDifference difference;
  double variance = 0, lit = 0;
  // The degrees of freedom of the repetitions alone: fewer than the difference has.
  const double critical = stats::student_upper(kMeansLevel / 2 / static_cast<double>(repetitions.channels),
                                               static_cast<double>(repetitions.images.size()) - 1);
  for (std::size_t c = 0; c < repetitions.channels; ++c) {
    if (!(level[c] > 0)) continue;
    const Estimate d = mean_of(of_channel[c]);
    difference.differ |= std::abs(d.value) > critical * std::sqrt(d.error * d.error + own.variance[c].value);
    variance += own.variance[c].value, ++lit;
  }
  const Estimate all = mean_of(together);
  difference.relative = all.value;
  difference.error = std::sqrt(all.error * all.error + variance / lit);  // channels share the paths
  return difference;
}

void add_errors(Bench& bench, const Record& common, const Repetitions& repetitions,
                const Reference& reference, bool channels) {
  if (repetitions.images.empty()) return;
  Record record = common;
  record.error_kind = "standard error";
  record.repetitions = static_cast<uint32_t>(repetitions.images.size());
  const Estimate seconds = mean_of(repetitions.seconds);
  const auto add = [&](const char* quantity, const char* unit, const Estimate& e) {
    record.quantity = quantity, record.unit = unit, record.value = e.value, record.error = e.error;
    bench.add(record);
  };
  add("seconds", "s", seconds);
  for (const ScaleErrors& errors : errors_of(repetitions, reference)) {
    record.series = errors.scale;
    record.note = note_of(errors);
    add("relative_error", "", root_of(errors.square));
    add("efficiency", "1/s", efficiency_of(errors.square, seconds));
    if (errors.scale == "image" || !channels) continue;
    for (std::size_t c = 0; c < errors.channels.size(); ++c) {
      record.channel_nm = reference.centres_nm[c];
      add("channel_error", "", root_of(errors.channels[c]));
    }
    record.channel_nm = kNone;
  }
}

void measure_errors(Bench& bench, const char* group, const SceneFile& scene, Subject& subject,
                    const Setup& setup, uint32_t repetitions, const Reference& reference) {
  const Repetitions images = repeat(subject, setup, repetitions, bench.watch());
  if (bench.stopped()) return;
  Record record;
  record.group = group;
  record.setup = setup;
  record.command = render_command(bench.settings(), scene, setup, bench.settings().seed);
  add_errors(bench, record, images, reference, true);
}

}  // namespace kiloband::speed
