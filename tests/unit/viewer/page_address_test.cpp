#include "viewer/server/page_address.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <optional>
#include <string>

namespace kiloband::test::page_address_test {
namespace {

using viewer::page_address;

TEST(PageAddress, NamesWhatTheServerIsBoundTo) {
  EXPECT_EQ(page_address("127.0.0.1", 8747, std::nullopt), "http://127.0.0.1:8747/");
  EXPECT_EQ(page_address("workstation", 80, "secret"), "http://workstation:80/?token=secret");
  EXPECT_EQ(page_address("fe80::1", 8747, std::nullopt), "http://[fe80::1]:8747/");
}

/// Browsers elsewhere cannot connect to 0.0.0.0.
TEST(PageAddress, OfAllAddressesIsTheMachinesName) {
  std::array<char, 256> name{};
  ASSERT_EQ(gethostname(name.data(), name.size() - 1), 0);
  const std::string expected = "http://" + std::string(name.data()) + ":8747/?token=secret";
  for (const char* bound : {"0.0.0.0", "::", "0:0:0:0:0:0:0:0"})
    EXPECT_EQ(page_address(bound, 8747, "secret"), expected) << bound;
}

}  // namespace
}  // namespace kiloband::test::page_address_test
