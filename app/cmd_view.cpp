// kiloband view SCENE.xml | CUBE: serves a page that shows the image while it refines.
#include <fmt/core.h>
#include <sys/random.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <memory>
#include <thread>

#include "app/commands.hpp"
#include "app/console/messages.hpp"
#include "app/console/standard_output.hpp"
#include "app/console/stop_signals.hpp"
#include "app/options/backend_options.hpp"
#include "app/options/render_options.hpp"
#include "app/options/sampling_options.hpp"
#include "app/options/whole_numbers.hpp"
#include "base/text.hpp"
#include "src_cpu/cpu_backend.hpp"
#include "src_gpu/device/device.hpp"
#include "viewer/api/stored_image.hpp"
#include "viewer/live/live_render.hpp"
#include "viewer/server/http_server.hpp"
#include "viewer/server/page_address.hpp"

namespace kiloband {
namespace {

constexpr int kPort = 8747;
constexpr std::size_t kMemoryBytes = std::size_t{4} << 30;

struct ViewOptions {
  SceneOptions scene;  // or a cube
  BackendOptions backend;
  SamplingOptions sampling;
  std::optional<uint64_t> spp;
  int port = kPort;
  std::optional<std::string> listen, token, output_dir;
  bool open = false;
};

/// 128 bits of the system's random numbers, as text.
std::string random_token() {
  unsigned char bytes[16];
  if (getrandom(bytes, sizeof bytes, 0) != sizeof bytes) throw DeviceError("no random numbers for a token");
  std::string text;
  for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

void check_token(const std::string& token) {
  constexpr std::size_t kLeast = 16;
  const bool plain =
      token.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_") ==
      std::string::npos;
  if (!plain || token.size() < kLeast || token.size() > 200)
    throw InputError("--token: must be random, or 16 to 200 letters, digits, '-' and '_'");
}

viewer::ApiSettings api_settings(const ViewOptions& options) {
  viewer::ApiSettings settings;
  if (options.listen && !options.token)
    throw InputError(fmt::format("--listen {} lets other machines in: needs --token", *options.listen));
  if (options.token) {
    settings.access.token = *options.token == "random" ? random_token() : *options.token;
    check_token(*settings.access.token);
  }
  settings.access.loopback = !options.listen;
  if (options.output_dir) {
    std::error_code unknown;
    if (!std::filesystem::is_directory(*options.output_dir, unknown))
      throw InputError("--output-dir " + *options.output_dir + ": is no folder");
    settings.output_dir = std::filesystem::canonical(*options.output_dir);
  }
  return settings;
}

bool is_cube(const std::filesystem::path& file) {
  const std::string extension = lowered_extension(file);
  return extension == ".exr" || extension == ".hdr" || extension == ".img";
}

/// What a cube has no use for: the options of scenes and renders.
/// throws InputError  one was given
void check_options_of_cube(const CLI::App& command, const std::string& cube) {
  constexpr std::array kOfCubes{"SCENE", "--help", "--port", "--open", "--output-dir", "--listen", "--token"};
  for (const CLI::Option* option : command.get_options())
    if (option->count() > 0 && std::ranges::find(kOfCubes, option->get_name()) == kOfCubes.end())
      throw InputError(option->get_name() + ": of scenes, not of the cube " + cube);
}

/// By the desktop's own program; where there is none the address has been printed. A child's child, which nobody waits for:
/// SIGCHLD cannot be ignored, since PoCL waits for the linker that it runs.
void open_browser(const std::string& address) {
  const pid_t child = fork();
  if (child < 0) return;
  if (child > 0) {
    waitpid(child, nullptr, 0);
    return;
  }
  if (fork() == 0) execlp("xdg-open", "xdg-open", address.c_str(), nullptr);
  _exit(0);
}

void serve(viewer::ViewedImage& image, const ViewOptions& options) {
  const viewer::ApiSettings settings = api_settings(options);
  viewer::Api api(image, settings);
  const std::string bound = options.listen.value_or("127.0.0.1");
  const viewer::HttpServer server(api, bound, options.port);
  const std::string address = viewer::page_address(bound, server.port(), settings.access.token);
  answer("{}\n", address);
  finish_standard_output();
  if (options.open) open_browser(address);
  while (!stop_requested) std::this_thread::sleep_for(std::chrono::milliseconds(100));
}

/// Backends that a page can choose; without an OpenCL loader the CPU alone.
std::vector<viewer::BackendChoice> backend_choices() {
  std::vector<viewer::BackendChoice> choices{{"cpu", cpu::processor_name(), {}, {"dpept-batch"}}};
  try {
    for (const opencl::DeviceInfo& device : opencl::list_devices())
      choices.push_back({"opencl", device.name, device.index, {"dpept-batch", "dpept-path", "pt"}});
  } catch (const DeviceError&) {  // there is none, then
  }
  if (choices.size() > 1)
    choices.push_back({"cpu+opencl", "both together", {}, {"dpept-batch", "dpept-path", "pt"}});
  return choices;
}

/// The backend of the command line's options, changed by what a page has chosen.
std::unique_ptr<Backend> make_chosen(const BackendOptions& given, const viewer::LiveSettings& chosen,
                                     std::shared_ptr<const FlatScene> scene, const DerivedChannels& derived,
                                     const DiagnosticSink& sink) {
  BackendOptions options = given;
  options.backend = chosen.backend;
  if (chosen.backend == "cpu") {
    options.device.reset(), options.device_memory.reset(), options.method.reset();
  } else {
    if (chosen.backend == "opencl") options.isa.reset(), options.threads.reset();
    options.device = chosen.device;
    options.method = chosen.method;
  }
  return make_backend(options, std::move(scene), derived, chosen.sampling, sink);
}

std::unique_ptr<viewer::ViewedImage> open_scene(const ViewOptions& options, unsigned threads,
                                                const DiagnosticSink& sink) {
  viewer::LiveOptions live;
  live.settings.backend = options.backend.resolve();
  live.settings.device = options.backend.device;
  live.settings.method = options.backend.method.value_or("dpept-batch");
  live.settings.sampling = options.sampling.settings(1);
  LoadedScene loaded = load_scene(options.scene, sink);
  live.settings.max_depth = loaded.description.integrator.max_depth;
  live.derived = load_responses({}, loaded, sink);
  live.settings.bands = options.scene.bands.value_or("");
  live.scene = std::move(loaded.description);
  live.channels = std::move(loaded.channels);
  if (options.scene.guide_bands) live.guide = std::move(loaded.guide);
  live.scene_name = std::filesystem::path(options.scene.scene).filename().string();
  live.backends.choices = backend_choices();
  live.backends.make = [given = options.backend, sink](const viewer::LiveSettings& chosen,
                                                       std::shared_ptr<const FlatScene> scene,
                                                       const DerivedChannels& derived) {
    return make_chosen(given, chosen, std::move(scene), derived, sink);
  };
  live.samples = options.spp;
  live.memory_bytes = kMemoryBytes;
  live.threads = threads;
  live.sink = sink;
  return viewer::start_live_render(std::move(live));
}

int view(const ViewOptions& options, const CLI::App& command) {
  const bool cube = is_cube(options.scene.scene);
  if (cube) check_options_of_cube(command, options.scene.scene);
  std::signal(SIGPIPE, SIG_IGN);
  const DiagnosticSink sink = print_diagnostics(false);
  api_settings(options);  // before hours of reading
  const unsigned threads = std::max(1u, std::thread::hardware_concurrency());
  const auto image = cube ? viewer::open_stored_image(options.scene.scene, kMemoryBytes, threads, sink)
                          : open_scene(options, threads, sink);
  catch_stop_signals();
  serve(*image, options);
  return kDone;
}

}  // namespace

Command add_view(CLI::App& program) {
  auto o = std::make_shared<ViewOptions>();
  CLI::App* command = program.add_subcommand("view", "Look at a spectral image in a browser");
  o->scene.add_to(*command);
  command->get_option("SCENE")->description(
      "Mitsuba 3 scene file (XML), or a spectral cube: .exr, .hdr (ENVI)");
  o->backend.add_to(*command);
  o->sampling.add_to(*command);
  command
      ->add_option("--spp", o->spp,
                   "samples per pixel after which the render rests (default: 15120, the most)")
      ->transform(whole_numbers<uint64_t>(1, viewer::kMostLiveSamples));
  command->add_option("--port", o->port, "of the address that is printed (0: any that is free)")
      ->transform(whole_numbers(0, 65535))
      ->capture_default_str();
  command->add_flag("--open", o->open, "open the page in the desktop's browser");
  command->add_option("--output-dir", o->output_dir,
                      "folder in which the page may save files (default: none)");
  command->add_option(
      "--listen", o->listen,
      "address of this machine that others may connect to (default: this machine alone); needs --token");
  command->add_option("--token", o->token, "secret that pages must know: random, or at least 16 characters");
  return [o, command] { return view(*o, *command); };
}

}  // namespace kiloband
