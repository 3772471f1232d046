#include "viewer/server/page_address.hpp"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <climits>

namespace kiloband::viewer {
namespace {

bool is_every_address(const std::string& bound) {
  in_addr v4{};
  in6_addr v6{};
  if (inet_pton(AF_INET, bound.c_str(), &v4) == 1) return v4.s_addr == htonl(INADDR_ANY);
  return inet_pton(AF_INET6, bound.c_str(), &v6) == 1 && IN6_IS_ADDR_UNSPECIFIED(&v6);
}

/// Empty where it has none.
std::string machine_name() {
  std::array<char, HOST_NAME_MAX + 1> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

}  // namespace

std::string page_address(const std::string& bound, int port, const std::optional<std::string>& token) {
  std::string host = is_every_address(bound) ? machine_name() : bound;
  if (host.empty()) host = bound;
  if (host.find(':') != std::string::npos) host = "[" + host + "]";
  return fmt::format("http://{}:{}/{}", host, port, token ? "?token=" + *token : "");
}

}  // namespace kiloband::viewer
