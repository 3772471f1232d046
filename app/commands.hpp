// The subcommands: each adds its options to the program and returns the exit code when run.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace kiloband {

/// Exit codes; base/error.hpp says whose errors 2, 3 and 70 are.
enum ExitCode {
  kDone = 0,
  kFailed = 1,
  kInputWrong = 2,
  kMachineFailed = 3,
  kInternalError = 70,
  kInterrupted = 130
};

using Command = std::function<int()>;

Command add_render(CLI::App& program);
Command add_info(CLI::App& program);
Command add_convert(CLI::App& program);
Command add_compare(CLI::App& program);
Command add_sky(CLI::App& program);
Command add_sensor(CLI::App& program);
Command add_trace(CLI::App& program);
Command add_devices(CLI::App& program);
Command add_tune(CLI::App& program);
Command add_bench(CLI::App& program);
Command add_validate(CLI::App& program);
Command add_view(CLI::App& program);

}  // namespace kiloband
