// The address under which pages of a server are found.
#pragma once

#include <optional>
#include <string>

namespace kiloband::viewer {

/// http://HOST:PORT/, with the token if there is one. bound: what the server is bound to, a numeric address or a name; for all
/// addresses of the machine (0.0.0.0, ::), which browsers elsewhere cannot connect to, HOST is the machine's name.
std::string page_address(const std::string& bound, int port, const std::optional<std::string>& token);

}  // namespace kiloband::viewer
