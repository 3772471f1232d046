// kiloband view SCENE.xml | CUBE: serves a page that shows the image while it refines.
#include <fmt/core.h>
#include <sys/random.h>

#include <csignal>
#include <filesystem>
#include <memory>
#include <thread>

#include "app/commands.hpp"
#include "app/console/messages.hpp"
#include "app/console/standard_output.hpp"
#include "app/console/stop_signals.hpp"
#include "app/options/render_options.hpp"
#include "base/text.hpp"
#include "viewer/http_server.hpp"
#include "viewer/stored_image.hpp"

namespace kiloband {
namespace {

constexpr int kPort = 8747;
constexpr std::size_t kMemoryBytes = std::size_t{4} << 30;

struct ViewOptions {
  std::string file;
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
    if (!std::filesystem::is_directory(*options.output_dir))
      throw InputError("--output-dir " + *options.output_dir + ": is no folder");
    settings.output_dir = std::filesystem::canonical(*options.output_dir);
  }
  return settings;
}

bool is_cube(const std::filesystem::path& file) {
  const std::string extension = lowered_extension(file);
  return extension == ".exr" || extension == ".hdr" || extension == ".img";
}

std::string address_of(const ViewOptions& options, const viewer::ApiSettings& settings, int port) {
  const std::string host = options.listen.value_or("127.0.0.1");
  const std::string named = host.find(':') == std::string::npos ? host : "[" + host + "]";
  return fmt::format("http://{}:{}/{}", named, port,
                     settings.access.token ? "?token=" + *settings.access.token : "");
}

/// By the desktop's own program; where there is none the address has been printed.
void open_browser(const std::string& address) {
  const pid_t child = fork();
  if (child != 0) return;
  execlp("xdg-open", "xdg-open", address.c_str(), nullptr);
  _exit(127);
}

void serve(viewer::ViewedImage& image, const ViewOptions& options) {
  const viewer::ApiSettings settings = api_settings(options);
  viewer::Api api(image, settings);
  const viewer::HttpServer server(api, options.listen.value_or("127.0.0.1"), options.port);
  const std::string address = address_of(options, settings, server.port());
  answer("{}\n", address);
  finish_standard_output();
  if (options.open) open_browser(address);
  while (!stop_requested) std::this_thread::sleep_for(std::chrono::milliseconds(100));
}

int view(const ViewOptions& options) {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGCHLD, SIG_IGN);  // the browser's starter is not waited for
  const DiagnosticSink sink = print_diagnostics(false);
  api_settings(options);  // before hours of reading
  if (!is_cube(options.file)) throw InputError(options.file + ": must be a cube, .exr or .hdr");
  const unsigned threads = std::max(1u, std::thread::hardware_concurrency());
  const auto image = viewer::open_stored_image(options.file, kMemoryBytes, threads, sink);
  catch_stop_signals();
  serve(*image, options);
  return kDone;
}

}  // namespace

Command add_view(CLI::App& program) {
  auto o = std::make_shared<ViewOptions>();
  CLI::App* command = program.add_subcommand("view", "Look at a spectral image in a browser");
  command->add_option("FILE", o->file, "spectral cube, .exr or .hdr (ENVI)")->required();
  command->add_option("--port", o->port, "of the address that is printed (0: any that is free)")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command->add_flag("--open", o->open, "open the page in the desktop's browser");
  command->add_option("--output-dir", o->output_dir,
                      "folder in which the page may save files (default: none)");
  command->add_option(
      "--listen", o->listen,
      "address of this machine that others may connect to (default: this machine alone); needs --token");
  command->add_option("--token", o->token, "secret that pages must know: random, or at least 16 characters");
  return [o] { return view(*o); };
}

}  // namespace kiloband
