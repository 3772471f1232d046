// Figures 8 and 9 of the DPEPT paper: speed against the number of channels, and what deferring evaluation gains.
//
// All backends of a scene and K take turns within a round, so that what disturbs the machine disturbs all. Seconds
// are of rendering: kernels are compiled, the scene is compiled, nothing is written.
#include <fmt/format.h>

#include <map>

#include "validation/speed/arithmetic.hpp"
#include "validation/speed/subject.hpp"

namespace kiloband::speed {
namespace {

struct Contender {
  Setup setup;
  Subject subject;
  uint32_t frames = 1;
  std::vector<double> path_rates, frame_rates;
};

Setup setup_of(const Bench& bench, const SceneFile& scene, const BackendName& name, uint32_t channels) {
  Setup setup;
  setup.scene = scene.name, setup.backend = name.backend, setup.method = name.method;
  setup.wavelengths = "shared", setup.sampler = "sobol";
  setup.channels = channels;
  setup.width = setup.height = image_side(bench, channels);
  setup.replicates = 1;
  return setup;
}

std::vector<Contender> make_contenders(Bench& bench, const SceneFile& scene, uint32_t channels) {
  std::vector<Contender> contenders;
  for (const BackendName& name : bench_backends(bench.settings())) {
    if (bench.stopped()) break;
    Setup setup = setup_of(bench, scene, name, channels);
    Subject subject = make_subject(bench.settings(), setup, load(scene, setup), 1, bench.settings().seed);
    setup.samples = samples_for(subject, bench.pick(0.05, 0.2), 256, bench.watch());
    const auto frames = static_cast<uint32_t>(std::min<uint64_t>(setup.samples, bench.pick(4u, 8u)));
    contenders.push_back({setup, std::move(subject), frames, {}, {}});
  }
  return contenders;
}

void measure_round(Bench& bench, std::vector<Contender>& contenders) {
  for (Contender& c : contenders) {
    const double pixels = double{1} * c.setup.width * c.setup.height;
    const auto samples = static_cast<uint32_t>(c.setup.samples);
    const double seconds = time_samples(c.subject, samples, bench.watch());
    const double frame_seconds = time_frames(c.subject, c.frames, bench.watch());
    if (bench.stopped()) return;
    c.path_rates.push_back(pixels * samples / seconds);
    c.frame_rates.push_back(c.frames / frame_seconds);
  }
}

Record record_of(const Contender& c, const char* quantity, const char* unit,
                 const std::vector<double>& values, const std::string& command) {
  Record record;
  record.group = "channels";
  record.setup = c.setup;
  record.quantity = quantity, record.unit = unit;
  const Estimate median = median_of(values);
  record.value = median.value, record.error = median.error;
  record.error_kind = "half range";
  record.repetitions = static_cast<uint32_t>(values.size());
  record.command = command;
  return record;
}

void add_speed_up(Bench& bench, const Contender& pt, const Contender& dpept, const std::string& command) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < pt.path_rates.size(); ++i)
    ratios.push_back(dpept.path_rates[i] / pt.path_rates[i]);
  bench.add(record_of(dpept, "speed_up_over_pt", "", ratios, command));
}

void add_records(Bench& bench, const SceneFile& scene, const std::vector<Contender>& contenders) {
  const std::string again = bench_command(bench.settings(), "channels");
  const Contender* pt = nullptr;
  for (const Contender& c : contenders) {
    const std::string command = render_command(bench.settings(), scene, c.setup, bench.settings().seed);
    bench.add(record_of(c, "paths_per_second", "1/s", c.path_rates, command));
    bench.add(record_of(c, "frames_per_second", "1/s", c.frame_rates, again));
    if (c.setup.method == "pt") pt = &c;
  }
  for (const Contender& c : contenders)
    if (pt && c.setup.method.starts_with("dpept")) add_speed_up(bench, *pt, c, again);
}

}  // namespace

void run_channels(Bench& bench) {
  const std::vector<uint32_t> few{8, 64, 256};
  const std::vector<uint32_t> all{1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 4096};
  const auto& counts = bench.quick() ? few : all;
  std::vector<SceneFile> scenes = bench_scenes(bench.settings());
  if (bench.quick()) scenes.resize(1);
  double done = 0;
  for (const SceneFile& scene : scenes) {
    for (const uint32_t channels : counts) {
      std::vector<Contender> contenders = make_contenders(bench, scene, channels);
      for (uint32_t round = 0; round < bench.pick(2u, 3u) && !bench.stopped(); ++round)
        measure_round(bench, contenders);
      if (bench.stopped()) return;
      add_records(bench, scene, contenders);
      bench.progress(++done / static_cast<double>(scenes.size() * counts.size()));
    }
  }
}

}  // namespace kiloband::speed
