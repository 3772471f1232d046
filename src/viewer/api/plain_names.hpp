// Names that pages give: of files and responses.
#pragma once

#include <string>

#include "base/error.hpp"
#include "base/text.hpp"

namespace kiloband::viewer {

/// A name that leads to no other folder and that every file system takes.
/// throws InputError  other characters than letters, digits, blanks, '_', '-' and '.', a name that begins with one of the
///                    last two or a blank, more than 64; the message begins with `what`
inline void check_plain_name(const std::string& name, const std::string& what) {
  const std::string letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
  const bool plain = !name.empty() && name.size() <= 64 && letters.find(name.front()) != std::string::npos &&
                     name.find_first_not_of(letters + "-. ") == std::string::npos && name.back() != ' ';
  if (!plain)
    throw InputError(
        what + " " + quote_text(name) +
        ": must be 1 to 64 letters, digits, blanks, '_', '-' or '.', a letter, a digit or '_' first");
}

}  // namespace kiloband::viewer
