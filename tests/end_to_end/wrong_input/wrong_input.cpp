#include "tests/end_to_end/wrong_input/wrong_input.hpp"

#include <gtest/gtest.h>

namespace kiloband::test {

void expect_refused(const TemporaryFolder& folder, const std::vector<std::string>& command,
                    const std::vector<WrongCommand>& cases) {
  const std::vector<std::string> before = folder.list();
  for (const WrongCommand& wrong : cases) {
    std::vector<std::string> arguments = command;
    arguments.insert(arguments.end(), wrong.arguments.begin(), wrong.arguments.end());
    SCOPED_TRACE(testing::PrintToString(arguments));
    const Outcome outcome = run_program(folder, arguments);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.err, "kiloband: " + wrong.message + "\n");
    EXPECT_EQ(outcome.out, "");
    ASSERT_EQ(folder.list(), before) << "a file was left behind";
  }
}

}  // namespace kiloband::test
