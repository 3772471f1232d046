#include <fmt/core.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <functional>
#include <map>
#include <new>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "app/commands.hpp"
#include "app/console/messages.hpp"
#include "app/console/standard_output.hpp"
#include "app/console/stop_signals.hpp"
#include "base/error.hpp"
#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

int fail(int code, const std::string& message, const char* hint = "") {
  tell("kiloband: {}{}\n", message, hint);
  return code;
}

/// CLI11 would call an unknown command a missing one.
void check_command(const std::map<std::string, Command>& commands, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-' || commands.contains(argv[1])) return;
  throw InputError(fmt::format(
      "unknown command '{}': must be render, info, convert, sensor, compare, sky, devices, tune, trace, "
      "validate, bench or view (see kiloband --help)",
      argv[1]));
}

/// "; did you mean '--spp'?" for the first option among what the command could not use that has a neighbour.
std::string suggest_option(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  const std::vector<std::string_view> known(names.begin(), names.end());
  for (const std::string& argument : command.remaining(true)) {
    const auto first = argument.find_first_not_of('-');
    if (first == 0 || first == std::string::npos) continue;
    const std::string hint = suggestion("--" + argument.substr(first, argument.find('=') - first), known);
    if (!hint.empty()) return hint;
  }
  return {};
}

int run(int argc, char** argv) {
  CLI::App program{"kiloband: hyperspectral path tracer", "kiloband"};
  program.set_version_flag("--version", "kiloband " KILOBAND_VERSION);
  program.require_subcommand(1);
  std::map<std::string, Command> commands;
  commands["render"] = add_render(program);
  commands["info"] = add_info(program);
  commands["convert"] = add_convert(program);
  commands["sensor"] = add_sensor(program);
  commands["compare"] = add_compare(program);
  commands["bench"] = add_bench(program);
  commands["devices"] = add_devices(program);
  commands["tune"] = add_tune(program);
  commands["view"] = add_view(program);
  commands["sky"] = add_sky(program);
  commands["trace"] = add_trace(program);
  commands["validate"] = add_validate(program);
  check_command(commands, argc, argv);
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& e) {
    std::ostringstream text;  // --help, --version
    const int code = program.exit(e, text, text);
    answer_text(text.str());
    return code;
  } catch (const CLI::ParseError& e) {
    const auto chosen = program.get_subcommands();
    const std::string command = chosen.empty() ? "" : " " + chosen.front()->get_name();
    const std::string hint = chosen.empty() ? suggest_option(program) : suggest_option(*chosen.front());
    throw InputError(fmt::format("{}{} (see kiloband{} --help)", e.what(), hint, command));
  }
  return commands.at(program.get_subcommands().front()->get_name())();
}

/// The exit code of an action; what it throws becomes a message.
int attempt(const std::function<int()>& action) {
  try {
    return action();
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

}  // namespace
}  // namespace kiloband

int main(int argc, char** argv) {
  using namespace kiloband;
  occupy_standard_streams();
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit is to be an error message (EFBIG), not the end
  catch_ending_signals();
  const int code = attempt([&] { return run(argc, argv); });
  const int end = attempt([] {
    finish_standard_output();
    return kDone;
  });
  const bool answered = code == kDone || code == kFailed;  // an answer that nobody can read is none
  return answered ? std::max(code, end) : code;
}
