// Tables of wrong input: each case must end with exit code 2, exactly its message,
// and no file more than before.
#pragma once

#include <string>
#include <vector>

#include "tests/end_to_end/support/program.hpp"

namespace kiloband::test {

struct WrongCommand {
  std::vector<std::string> arguments;
  std::string message;  // without "kiloband: " and the line's end
};

/// Runs each case in the folder. command: what all arguments begin with, such as {"render", "scene.xml"}
void expect_refused(const TemporaryFolder& folder, const std::vector<std::string>& command,
                    const std::vector<WrongCommand>& cases);

}  // namespace kiloband::test
