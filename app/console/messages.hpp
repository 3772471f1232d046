// What the program says to its user goes to standard error.
#pragma once

#include <fmt/core.h>

#include <cstdio>
#include <string>
#include <utility>

namespace kiloband {

/// Formats and prints to standard error. Unlike fmt::print it never throws: a reader of our messages that
/// goes away must not end a render.
template <typename... Args>
void tell(fmt::format_string<Args...> format, Args&&... args) {
  const std::string text = fmt::format(format, std::forward<Args>(args)...);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace kiloband
