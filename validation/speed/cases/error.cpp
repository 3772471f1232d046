// Error against time, for every backend, method, wavelength mode and sampler, against one reference per scene.
#include <fmt/format.h>

#include "validation/speed/errors.hpp"

namespace kiloband::speed {
namespace {

/// One curve.
struct Way {
  BackendName name;
  const char *wavelengths, *sampler;
  uint32_t replicates;
};

/// The replicates that error bars come from (16 unless `kiloband render` is told otherwise) beside one, which all others have.
std::vector<Way> ways_of(const Bench& bench) {
  std::vector<Way> ways;
  for (const uint32_t replicates : {4u, 8u, 16u}) {
    if (bench.quick() && replicates < 16) continue;
    ways.push_back({bench_backends(bench.settings()).front(), "shared", "sobol", replicates});
  }
  for (const BackendName& name : bench_backends(bench.settings())) {
    ways.push_back({name, "shared", "sobol", 1});
    if (bench.quick() && name.backend != "cpu") continue;
    ways.push_back({name, "shared", "independent", 1});
    ways.push_back({name, "per-path", "sobol", 1});
    ways.push_back({name, "per-path", "independent", 1});
  }
  return ways;
}

Setup setup_of_way(const Bench& bench, const SceneFile& scene, const Way& way) {
  Setup setup;
  setup.scene = scene.name, setup.backend = way.name.backend, setup.method = way.name.method;
  setup.wavelengths = way.wavelengths, setup.sampler = way.sampler;
  setup.channels = bench.pick(8u, 32u);
  setup.width = setup.height = 64;
  setup.replicates = way.replicates;
  return setup;
}

void measure_way(Bench& bench, const SceneFile& scene, const Way& way, const Reference& reference) {
  Setup setup = setup_of_way(bench, scene, way);
  const uint32_t repetitions = bench.pick(4u, 5u);
  Subject subject = make_subject(bench.settings(), setup, load(scene, setup), repetitions * setup.replicates,
                                 bench.settings().seed);
  time_samples(subject, 1, bench.watch());  // compiles kernels
  const std::vector<uint64_t> few{8, 32}, many{16, 64, 256, 1024};
  const bool cpu =
      setup.backend == "cpu";  // the others make the same images: that they are slower shows before 1024
  for (const uint64_t samples : bench.quick() ? few : many) {
    if (!cpu && samples > 256) break;
    setup.samples = samples;
    if (samples < 2 * setup.replicates) continue;  // render would take fewer
    measure_errors(bench, "error", scene, subject, setup, repetitions, reference);
    if (bench.stopped()) return;
  }
}

void add_reference(Bench& bench, const Setup& setup, const Reference& reference) {
  Repetitions none{reference.image.width, reference.image.height, reference.image.channels, {}, {}};
  for (const ScaleErrors& errors : errors_of(none, reference)) {
    Record record;
    record.group = "error";
    record.setup = setup;
    record.setup.backend = "cpu", record.setup.wavelengths = "shared", record.setup.sampler = "sobol";
    record.setup.method.clear();
    record.setup.replicates = reference.image.replicates;
    record.setup.samples = reference.samples;
    record.series = errors.scale;
    record.quantity = "reference_error";
    record.value = root_of({errors.reference, 0}).value;
    record.note = reference.reused ? "found in the folder of results" : "rendered in this run";
    record.command = reference.command;
    bench.add(record);
  }
}

}  // namespace

void run_error(Bench& bench) {
  std::vector<SceneFile> scenes = bench_scenes(bench.settings());
  if (bench.quick()) scenes.resize(1);
  const std::vector<Way> ways = ways_of(bench);
  double done = 0;
  for (const SceneFile& scene : scenes) {
    const Setup setup = setup_of_way(bench, scene, ways.front());
    const Reference reference = reference_of(bench, scene, setup, bench.pick(1024u, 16384u));
    if (bench.stopped()) return;
    add_reference(bench, setup, reference);
    for (const Way& way : ways) {
      measure_way(bench, scene, way, reference);
      if (bench.stopped()) return;
      bench.progress(++done / static_cast<double>(scenes.size() * ways.size()));
    }
  }
}

}  // namespace kiloband::speed
