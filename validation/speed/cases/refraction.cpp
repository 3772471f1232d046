// Figure 3 of the DPEPT paper: refraction at 64 wavelengths where a path goes on with one channel (degradation), against
// samples per pixel, beside spectral MIS, which keeps all of them at rough boundaries.
#include "validation/speed/errors.hpp"

namespace kiloband::speed {

void run_refraction(Bench& bench) {
  const SceneFile scene = bench_scene(bench.settings(), "flint_ball");
  Setup setup;
  setup.scene = scene.name, setup.backend = "cpu", setup.wavelengths = "shared", setup.sampler = "sobol";
  setup.channels = 64;
  setup.width = setup.height = 64;
  setup.replicates = 1;
  const Reference reference = reference_of(bench, scene, setup, bench.pick(512u, 16384u));
  const std::vector<uint64_t> few{4, 16}, many{1, 4, 16, 64, 256, 1024};
  const auto& counts = bench.quick() ? few : many;
  const uint32_t repetitions = bench.pick(3u, 6u);
  double done = 0;
  for (const char* dispersion : {"mis", "degrade"}) {
    setup.dispersion = dispersion;
    Subject subject =
        make_subject(bench.settings(), setup, load(scene, setup), repetitions, bench.settings().seed);
    for (const uint64_t samples : counts) {
      if (bench.stopped()) return;
      setup.samples = samples;
      measure_errors(bench, "refraction", scene, subject, setup, repetitions, reference);
      if (bench.stopped()) return;
      bench.progress(++done / (2.0 * static_cast<double>(counts.size())));
    }
  }
}

}  // namespace kiloband::speed
