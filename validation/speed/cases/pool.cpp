// Sizes of the device's pool (figures 8 and 9 of the DPEPT paper): speed, the pool that there was room for, memory in use.
//
// pt keeps K throughputs and radiances for every path of the pool; where they do not fit into the budget (--device-memory; 4GiB is the
// paper's card) the pool is made smaller. A pool cannot be larger than the image has pixels (pt) or a round has paths.
#include <fmt/format.h>

#include "validation/speed/arithmetic.hpp"
#include "validation/speed/subject.hpp"

namespace kiloband::speed {
namespace {

void measure_pool(Bench& bench, const std::shared_ptr<const FlatScene>& compiled, const Setup& setup) {
  Subject subject = make_subject(bench.settings(), setup, compiled, 1, bench.settings().seed);
  time_samples(subject, 1, bench.watch());
  std::vector<double> rates;
  for (uint32_t round = 0; round < bench.pick(1u, 2u) && !bench.stopped(); ++round) {
    const double seconds = time_samples(subject, static_cast<uint32_t>(setup.samples), bench.watch());
    rates.push_back(double{1} * setup.width * setup.height * static_cast<double>(setup.samples) / seconds);
  }
  if (bench.stopped()) return;
  const BackendStatistics done = subject.backend->statistics();
  Record record;
  record.group = "pool";
  record.setup = setup;
  record.command = bench_command(bench.settings(), "pool");
  const auto add = [&](const char* quantity, const char* unit, const Estimate& e) {
    record.quantity = quantity, record.unit = unit, record.value = e.value, record.error = e.error;
    bench.add(record);
  };
  record.error_kind = "half range", record.repetitions = static_cast<uint32_t>(rates.size());
  add("paths_per_second", "1/s", median_of(rates));
  record.error_kind.clear(), record.repetitions = 0;
  if (done.pool_slots < setup.pool)
    record.note = fmt::format("{} of {} paths in flight", done.pool_slots, setup.pool);
  add("paths_in_flight", "", {static_cast<double>(done.pool_slots), kNone});
  add("device_memory", "B", {static_cast<double>(done.device_memory_bytes), kNone});
}

}  // namespace

void run_pool(Bench& bench) {
  const SceneFile scene = bench_scene(bench.settings(), "cornell_box");
  const std::vector<uint32_t> few{64}, many{16, 64, 256}, small{256, 512}, all{256, 512, 1024, 2048};
  const auto& counts = bench.quick() ? few : many;
  const auto& edges = bench.quick() ? small : all;
  double done = 0;
  for (const uint32_t channels : counts) {
    Setup setup;
    setup.scene = scene.name, setup.wavelengths = "shared", setup.sampler = "sobol";
    setup.channels = channels;
    setup.width = setup.height = bench.pick(256u, 1024u);
    setup.replicates = 1, setup.samples = 2;
    const auto compiled = load(scene, setup);
    for (const BackendName& name : bench_backends(bench.settings())) {
      if (name.backend != "opencl") continue;
      setup.backend = name.backend, setup.method = name.method;
      for (const uint32_t edge : edges) {
        setup.pool = edge * edge;
        measure_pool(bench, compiled, setup);
        if (bench.stopped()) return;
        bench.progress(++done / static_cast<double>(3 * edges.size() * counts.size()));
      }
    }
  }
}

}  // namespace kiloband::speed
