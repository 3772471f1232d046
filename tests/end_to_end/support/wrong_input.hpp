// Tables of wrong input: each case must end with exit code 2, exactly its message,
// and no file more than before.
#pragma once

#include <string>
#include <vector>

#include "tests/end_to_end/support/program.hpp"

namespace kiloband::test {

struct WrongCommand {
  std::string name;
  std::vector<std::string> arguments;
  std::string message;  // without "kiloband: " and the line's end
};

struct WrongScene {
  std::string name;
  std::string text;  // of broken.xml
  std::string message;
};

/// Runs each case in the folder.
void expect_refused(const TemporaryFolder& folder, const std::vector<WrongCommand>& cases);
/// Each scene as broken.xml through `render`; every third through `info`, which must say the same.
void expect_refused(const TemporaryFolder& folder, const std::vector<WrongScene>& cases);

}  // namespace kiloband::test
