// Who may ask: requests of other origins, of other machines and of pages that do not know the token are refused.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kiloband::viewer {

struct Request {
  std::string method;  // "GET", "POST"
  std::string path;    // without the query, decoded
  std::map<std::string, std::string> query;
  std::map<std::string, std::string> headers;  // names in lower case
  std::string body;

  /// Empty where it is absent.
  std::string header(const std::string& name) const;
  std::string parameter(const std::string& name) const;
};

struct Response {
  int status = 200;
  std::string type = "application/json";
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;
};

/// {"error": message}
Response refusal(int status, const std::string& message);

struct AccessRules {
  /// Absent: the server is bound to a loopback address, and everybody on this machine may look.
  std::optional<std::string> token;
  /// The Host of requests must be a name of this machine for itself: localhost, 127.0.0.1 or [::1], with any port (of a
  /// tunnel's other end). Names that lead here by somebody's name server are refused (DNS rebinding).
  bool loopback = true;
};

/// The answer to a request that goes no further; nothing for one that may.
///   403  a Host or Origin that is not ours, POST without the header X-Kiloband (which other origins cannot send)
///   401  no cookie with the token
///   303  `/?token=T` with the right token: sets the cookie and leads to `/`
std::optional<Response> check_access(const Request& request, const AccessRules& rules);

/// Equal, in a time that does not tell where they differ.
bool equal_secrets(std::string_view a, std::string_view b);

}  // namespace kiloband::viewer
