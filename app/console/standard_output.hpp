// What a command answers goes to standard output.
#pragma once

#include <fmt/core.h>

#include <string>
#include <utility>

namespace kiloband {

/// answer() of a text as it is.
void answer_text(const std::string& text);

/// Formats and prints to standard output. Unlike fmt::print it never throws, so that files that come after it
/// are written; finish_standard_output() says what went wrong.
template <typename... Args>
void answer(fmt::format_string<Args...> format, Args&&... args) {
  answer_text(fmt::format(format, std::forward<Args>(args)...));
}

/// For the start of the program: gives standard input, output and error that are closed (`>&-`) to /dev/null,
/// opened so that writing to it fails. Otherwise the first files that are opened would take their numbers,
/// and messages would be written into them.
void occupy_standard_streams();

/// For the end of the program: everything printed reaches its place.
/// throws DeviceError  "cannot write to standard output: <the system's message>"
void finish_standard_output();

}  // namespace kiloband
