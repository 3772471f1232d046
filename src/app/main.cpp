#include <csignal>
#include <exception>
#include <fmt/core.h>
#include <map>
#include <new>
#include <system_error>

#include "app/commands.hpp"
#include "base/error.hpp"

namespace kiloband {

std::atomic<bool> stop_requested{false};

namespace {

void on_signal(int) { stop_requested = true; }

/// A second Ctrl-C ends the program at once: SA_RESETHAND restores the default action after the first.
void install_signal_handlers() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

int fail(int code, const char* message, const char* hint = "") {
  fmt::print(stderr, "kiloband: {}{}\n", message, hint);
  return code;
}

int run(int argc, char** argv) {
  CLI::App program{"kiloband: hyperspectral path tracer", "kiloband"};
  program.set_version_flag("--version", KILOBAND_VERSION);
  program.require_subcommand(1);
  std::map<std::string, Command> commands;
  commands["render"] = add_render(program);
  commands["info"] = add_info(program);
  commands["convert"] = add_convert(program);
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return program.exit(e);  // --help, --version
  } catch (const CLI::ParseError& e) {
    program.exit(e);
    return kInputWrong;
  }
  return commands.at(program.get_subcommands().front()->get_name())();
}

}  // namespace
}  // namespace kiloband

int main(int argc, char** argv) {
  using namespace kiloband;
  install_signal_handlers();
  try {
    return run(argc, argv);
  } catch (const InputError& e) {
    return fail(kInputWrong, e.what());
  } catch (const DeviceError& e) {
    return fail(kMachineFailed, e.what());
  } catch (const std::bad_alloc&) {
    return fail(kMachineFailed, "out of memory");
  } catch (const std::system_error& e) {
    return fail(kMachineFailed, e.what());
  } catch (const std::exception& e) {
    return fail(kInternalError, e.what(), " (this is a bug of kiloband: please report it)");
  }
}
