// The DPEPT paper's first open question: should a path carry all channels? K channels are rendered in m ranges of K/m neighbours,
// each with 1/m of the samples by paths of its own: as many paths in all. Less correlation between channels and decisions made for
// fewer of them, against m times fewer samples of each channel.
#include <fmt/format.h>

#include <algorithm>

#include "validation/speed/errors.hpp"

namespace kiloband::speed {
namespace {

constexpr uint32_t kNarrowest = 4;

/// The ranges' images side by side, their seconds added.
void append(Repetitions& all, const Repetitions& part, uint32_t first) {
  if (all.images.empty()) {
    all.images.assign(part.images.size(),
                      std::vector<float>(std::size_t{all.width} * all.height * all.channels));
    all.seconds.assign(part.seconds.size(), 0.0);
  }
  for (std::size_t i = 0; i < part.images.size(); ++i) {
    all.seconds[i] += part.seconds[i];
    for (std::size_t p = 0; p < std::size_t{all.width} * all.height; ++p)
      std::copy_n(&part.images[i][p * part.channels], part.channels,
                  &all.images[i][p * all.channels + first]);
  }
}

Repetitions render_split(const Bench& bench, const SceneFile& scene, const Setup& setup,
                         uint32_t repetitions) {
  const uint32_t ranges = setup.channels / setup.part;
  Setup one = setup;
  one.channels = setup.part;
  one.samples = setup.samples / ranges;
  Repetitions all{setup.width, setup.height, setup.channels, {}, {}};
  for (uint32_t i = 0; i < ranges && !bench.stopped(); ++i) {
    const std::string bands = bands_text(scene, setup.channels, i * setup.part, setup.part);
    Subject subject =
        make_subject(bench.settings(), one, load(scene, one, bands), repetitions, bench.settings().seed + i);
    time_samples(subject, 1, bench.watch());  // fresh threads and caches are not the split's
    const Repetitions part = repeat(subject, one, repetitions, bench.watch());
    if (!bench.stopped()) append(all, part, i * setup.part);
  }
  return all;
}

struct RatedSplit {
  uint32_t part;
  Estimate efficiency;
};

void add_best(Bench& bench, Record record, const std::vector<RatedSplit>& rated) {
  const auto best = std::ranges::max_element(
      rated, {}, [](const RatedSplit& r) { return r.efficiency.value > 0 ? r.efficiency.value : 0; });
  const Estimate gain = ratio_of(best->efficiency, rated.front().efficiency);
  record.setup.part = best->part;
  record.quantity = "gain_of_best_split";
  record.value = gain.value, record.error = best->part == rated.front().part ? kNone : gain.error;
  record.error_kind = "standard error";
  record.note = best->part == record.setup.channels
                    ? "no split: every path carries all channels"
                    : fmt::format("best: {} of {} channels a path", best->part, record.setup.channels);
  bench.add(record);
}

void measure_splits(Bench& bench, const SceneFile& scene, uint32_t channels) {
  Record record;
  record.group = "split";
  record.command = bench_command(bench.settings(), "split");
  Setup& setup = record.setup;
  setup.scene = scene.name, setup.backend = "cpu", setup.wavelengths = "shared", setup.sampler = "sobol";
  setup.channels = channels;
  setup.width = setup.height = 64;
  setup.replicates = 1;
  setup.samples = std::max(64u, channels / 2);
  const Reference reference = reference_of(bench, scene, setup, bench.pick(1024u, 8192u));
  const uint32_t repetitions = bench.pick(3u, 4u);
  std::vector<RatedSplit> rated;
  for (uint32_t part = channels; part >= kNarrowest; part /= bench.pick(4u, 2u)) {
    setup.part = part;
    const Repetitions images = render_split(bench, scene, setup, repetitions);
    if (bench.stopped()) return;
    add_errors(bench, record, images, reference, false);
    rated.push_back(
        {part, efficiency_of(errors_of(images, reference).front().square, mean_of(images.seconds))});
  }
  add_best(bench, record, rated);
}

}  // namespace

void run_split(Bench& bench) {
  std::vector<SceneFile> scenes = bench_scenes(bench.settings());
  scenes.resize(bench.pick(std::size_t{1}, std::size_t{3}));
  const std::vector<uint32_t> few{16}, many{16, 64, 512};
  const auto& counts = bench.quick() ? few : many;
  double done = 0;
  for (const SceneFile& scene : scenes) {
    for (const uint32_t channels : counts) {
      measure_splits(bench, scene, channels);
      if (bench.stopped()) return;
      bench.progress(++done / static_cast<double>(scenes.size() * counts.size()));
    }
  }
}

}  // namespace kiloband::speed
