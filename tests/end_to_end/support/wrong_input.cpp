#include "tests/end_to_end/support/wrong_input.hpp"

#include <gtest/gtest.h>

namespace kiloband::test {

void expect_refused(const TemporaryFolder& folder, const std::vector<WrongCommand>& cases) {
  const std::vector<std::string> before = folder.list();
  for (const WrongCommand& wrong : cases) {
    const Outcome outcome = run_program(folder, wrong.arguments);
    EXPECT_EQ(outcome.code, 2) << wrong.name;
    EXPECT_EQ(outcome.err, "kiloband: " + wrong.message + "\n") << wrong.name;
    EXPECT_EQ(outcome.out, "") << wrong.name;
    ASSERT_EQ(folder.list(), before) << wrong.name << " left a file behind";
  }
}

void expect_refused(const TemporaryFolder& folder, const std::vector<WrongScene>& cases) {
  folder.write("broken.xml", "");
  int count = 0;
  for (const WrongScene& wrong : cases) {
    folder.write("broken.xml", wrong.text);
    const bool info = ++count % 3 == 0;
    const auto arguments = info ? std::vector<std::string>{"info", "broken.xml"}
                                : quiet_render("broken.xml", {"--spp", "1", "-o", "out.hdr", "-o", "out.exr",
                                                              "--stats", "s.json"});
    expect_refused(folder, {{wrong.name, arguments, wrong.message}});
  }
}

}  // namespace kiloband::test
