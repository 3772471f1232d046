// Figures 4 and 7 of the DPEPT paper: memory against the number of channels and the depth, per method, measured; beside what
// bytes_per_path() says that the paths of the pool take.
//
// Measured on devices: the most that was allocated there (statistics of the backend), with film, scene and spectra. On the CPU: the most that a
// process of its own had resident.
#include <fmt/format.h>

#include <fstream>

#include "base/error.hpp"
#include "src_gpu/path/path_memory.hpp"
#include "validation/speed/subject.hpp"
#include "validation/suite/child_process.hpp"

namespace kiloband::speed {
namespace fs = std::filesystem;
namespace {

void add_bytes(Bench& bench, const Setup& setup, const char* series, const char* quantity, double bytes,
               const std::string& command) {
  Record record;
  record.group = "memory";
  record.setup = setup;
  record.series = series;
  record.quantity = quantity, record.unit = "B";
  record.value = bytes;
  record.command = command;
  bench.add(record);
}

/// series: what varies, "channels" or "depth"
void measure_device(Bench& bench, const SceneFile& scene, Setup setup, const char* series) {
  const auto compiled = load(scene, setup);
  Subject subject = make_subject(bench.settings(), setup, compiled, 1, bench.settings().seed);
  time_samples(subject, static_cast<uint32_t>(setup.samples), bench.watch());
  if (bench.stopped()) return;
  const BackendStatistics done = subject.backend->statistics();
  const std::string command = bench_command(bench.settings(), "memory");
  const double paths = static_cast<double>(done.pool_slots);
  const uint64_t each = opencl::bytes_per_path(*opencl::find_method(setup.method), setup.channels,
                                               static_cast<uint64_t>(setup.depth), 1, compiled->features);
  setup.pool = done.pool_slots;
  add_bytes(bench, setup, series, "device_memory", static_cast<double>(done.device_memory_bytes), command);
  add_bytes(bench, setup, series, "formula_of_paths", paths * static_cast<double>(each), command);
}

/// A process of its own, so that nothing else of this one counts.
void measure_process(Bench& bench, const SceneFile& scene, const Setup& setup, const char* series) {
  const fs::path folder = bench.settings().output / "memory";
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw DeviceError(folder.string() + ": " + error.message());
  const fs::path stats = folder / "stats.json";
  std::vector<std::string> command{bench.settings().program.string(), "render", scene.file.string()};
  const std::vector<std::string> options{"--bands",
                                         bands_text(scene, setup.channels),
                                         "--size",
                                         fmt::format("{}x{}", setup.width, setup.height),
                                         "--backend",
                                         "cpu",
                                         "--max-depth",
                                         fmt::format("{}", setup.depth),
                                         "--replicates",
                                         "1",
                                         "--spp",
                                         fmt::format("{}", setup.samples),
                                         "--quiet",
                                         "--stats",
                                         stats.string(),
                                         "-o",
                                         (folder / "image.hdr").string()};
  command.insert(command.end(), options.begin(), options.end());
  const validation::ChildEnd end = validation::run_child(command, bench.watch(), {});
  if (end.stopped) return;
  if (end.code != 0) throw DeviceError("kiloband render: " + end.description());
  std::ifstream stream(stats);
  const auto json = nlohmann::json::parse(stream);
  add_bytes(bench, setup, series, "resident_memory", json.at("peak_memory_bytes").get<double>(),
            render_command(bench.settings(), scene, setup, 0, " --stats stats.json"));
  for (const char* name : {"stats.json", "image.hdr", "image.img"}) fs::remove(folder / name, error);
  fs::remove(folder, error);  // if nothing else is in it
}

void measure(Bench& bench, const SceneFile& scene, Setup setup, const char* series) {
  for (const BackendName& name : bench_backends(bench.settings())) {
    if (bench.stopped()) return;
    setup.backend = name.backend, setup.method = name.method;
    if (name.backend == "cpu") {
      measure_process(bench, scene, setup, series);
    } else {
      setup.pool = bench.pick(4096u, 16384u);
      measure_device(bench, scene, setup, series);
      setup.pool = 0;
    }
  }
}

}  // namespace

void run_memory(Bench& bench) {
  const SceneFile scene = bench_scene(bench.settings(), "cornell_box");
  const std::vector<uint32_t> few{8, 256}, many{1, 8, 32, 128, 512, 1024};
  const std::vector<int> shallow{6, 32}, deep{2, 4, 8, 16, 32, 64};
  const auto& counts = bench.quick() ? few : many;
  const auto& depths = bench.quick() ? shallow : deep;
  Setup setup;
  setup.scene = scene.name, setup.wavelengths = "shared", setup.sampler = "sobol";
  setup.width = setup.height = bench.pick(64u, 128u);
  setup.replicates = 1, setup.samples = 2;
  double done = 0;
  const auto step = [&] { bench.progress(++done / static_cast<double>(counts.size() + depths.size())); };
  for (const uint32_t channels : counts) {
    setup.channels = channels, setup.depth = 6;
    measure(bench, scene, setup, "channels");
    step();
  }
  for (const int depth : depths) {
    setup.channels = 64, setup.depth = depth;
    measure(bench, scene, setup, "depth");
    step();
  }
}

}  // namespace kiloband::speed
