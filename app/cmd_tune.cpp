// kiloband tune [SCENE.xml]: finds the sizes that an OpenCL device renders fastest with, and keeps them for its renders.
#include <fmt/core.h>

#include "app/commands.hpp"
#include "app/console/messages.hpp"
#include "app/console/standard_output.hpp"
#include "app/console/stop_signals.hpp"
#include "app/options/backend_options.hpp"
#include "app/options/render_options.hpp"
#include "app/options/sampling_options.hpp"
#include "app/source_folder.hpp"
#include "src_gpu/tuning/render_timer.hpp"
#include "src_gpu/tuning/tuning_store.hpp"

namespace kiloband {
namespace {

/// Enough paths for the largest rounds, and no more than a processor renders in a second.
constexpr const char* kGpuSize = "1024x1024";
constexpr const char* kCpuSize = "256x256";
constexpr double kLeastSeconds = 0.01, kMostSeconds = 60;

struct TuneCommand {
  SceneOptions scene;
  SamplingOptions sampling;
  std::optional<std::string> device, device_memory, method;
  double seconds = 0.5;
  bool forget = false, quiet = false;
};

opencl::Options device_options(const TuneCommand& command, const DiagnosticSink& sink) {
  opencl::Options options;
  options.device = command.device;
  if (command.device_memory) options.device_memory = parse_bytes("--device-memory", *command.device_memory);
  if (command.method) options.method = opencl::find_method(*command.method);
  options.sink = sink;
  return options;
}

int forget(const TuneCommand& command) {
  const opencl::DeviceInfo device = opencl::select_device(command.device);
  const bool had = opencl::TuningStore::of_user().forget(device);
  answer("{}: {}\n", device.name, had ? "has its usual sizes again" : "nothing was kept");
  return kDone;
}

/// The Cornell box where no scene is named, and a size that suits the device where none is.
std::shared_ptr<const FlatScene> compiled_scene(SceneOptions scene, opencl::DeviceType type,
                                                const DiagnosticSink& sink) {
  if (!scene.size) scene.size = type == opencl::DeviceType::kCpu ? kCpuSize : kGpuSize;
  check_scene_file(scene.scene);
  const LoadedScene loaded = load_scene(scene, sink);
  return compile_scene(loaded.description, {loaded.channels, loaded.guide, sink});
}

std::string speed_text(double speed) {
  return speed > 0 ? fmt::format("{:.2f} times as fast", speed) : "does not work";
}

void check_seconds(double seconds) {
  if (!(seconds >= kLeastSeconds && seconds <= kMostSeconds))  // NaN, too
    throw InputError(fmt::format("--seconds {}: must be in [{}, {}]", seconds, kLeastSeconds, kMostSeconds));
}

/// Minutes of measuring must not end with sizes that cannot be kept.
void check_keeping(const opencl::DeviceInfo& device) {
  if (const std::string refusal = opencl::TuningStore::of_user().refusal(device); !refusal.empty())
    throw DeviceError("sizes cannot be kept: " + refusal);
}

int tune(TuneCommand command) {
  check_seconds(command.seconds);
  if (command.forget) return forget(command);
  const opencl::DeviceInfo device = opencl::select_device(command.device);
  check_keeping(device);
  if (command.scene.scene.empty())
    command.scene.scene = source_folder() + "/scenes/cornell_box/cornell_box.xml";
  const DiagnosticSink sink = print_diagnostics(true);
  const auto scene = compiled_scene(command.scene, device.type, sink);
  opencl::RenderTimer timer(scene, command.sampling.settings(1), device_options(command, sink));
  catch_stop_signals();
  timer.calibrate(command.seconds, stop_requested);
  const opencl::TuningBounds bounds = timer.bounds();
  opencl::TunedMethod measured;
  measured.method = to_string(bounds.method);
  measured.channels = static_cast<uint32_t>(scene->channels.size());
  measured.items_of_path = bounds.items_of_path;
  measured.scene = command.scene.scene;
  answer("{}, {}, {} channels, {}: {} samples of {} paths a render\n", timer.device().name, measured.method,
         measured.channels, measured.scene, timer.samples(), timer.paths() / timer.samples());
  opencl::TuneSettings settings;
  settings.stop = [] { return stop_requested.load(); };
  if (!command.quiet)
    settings.told = [](const opencl::Tuning& tried, double speed) {
      tell("{}: {}\n", describe(tried), speed_text(speed));
    };
  const auto time = [&](const opencl::Tuning& tried) { return timer.time(tried, stop_requested); };
  const opencl::TuneOutcome outcome = find_tuning(bounds, time, settings);
  if (stop_requested) {
    tell("kiloband: interrupted; nothing is kept\n");
    return kInterrupted;
  }
  measured.tuning = outcome.tuning;
  measured.speed_up = outcome.speed_up;
  answer("{}: {:.2f} times the usual speed\n", describe(outcome.tuning), outcome.speed_up);
  const opencl::TuningStore store = opencl::TuningStore::of_user();
  if (const std::string refusal = store.save(timer.device(), measured); !refusal.empty())
    throw DeviceError("the sizes are not kept: " + refusal);
  answer("kept in {}\n", store.file(timer.device()).string());
  return kDone;
}

}  // namespace

Command add_tune(CLI::App& program) {
  auto o = std::make_shared<TuneCommand>();
  CLI::App& command = *program.add_subcommand(
      "tune", "Find the sizes that an OpenCL device renders fastest with; its renders use them then");
  o->scene.add_to(command);
  command.get_option("SCENE")->required(false)->description(
      "Mitsuba 3 scene file (XML) that is timed (default: the Cornell box)");
  o->sampling.add_to(command);
  command.add_option("--device", o->device, "index or part of the name, as `kiloband devices` lists them");
  command.add_option("--device-memory", o->device_memory, "memory to use at most, such as 4GiB");
  command.add_option("--method", o->method, "how paths are evaluated (default dpept-batch)")
      ->check(CLI::IsMember({"dpept-batch", "dpept-path", "pt"}));
  command.add_option("--seconds", o->seconds, "of a timed render, at least: 0.01 to 60")
      ->capture_default_str();
  command.add_flag("--forget", o->forget, "let the device have its usual sizes again");
  command.add_flag("--quiet", o->quiet, "no line for every size that is tried");
  return [o] { return tune(*o); };
}

}  // namespace kiloband
