#include "viewer/api/access.hpp"

#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "viewer/api/json_text.hpp"

namespace kiloband::viewer {
namespace {

constexpr std::string_view kCookie = "kiloband_token";

std::string find_or_empty(const std::map<std::string, std::string>& map, const std::string& name) {
  const auto found = map.find(name);
  return found == map.end() ? std::string() : found->second;
}

/// "localhost" of "localhost:8080", "[::1]" of "[::1]:8080".
std::string host_name(std::string_view host) {
  const std::size_t bracket = host.starts_with('[') ? host.find(']') : 0;
  if (bracket == std::string_view::npos) return std::string(host);
  return lowered(host.substr(0, host.find(':', bracket)));
}

bool is_loopback(const std::string& host) {
  const std::string name = host_name(host);
  return name == "localhost" || name == "127.0.0.1" || name == "[::1]";
}

/// "kiloband_token_8747=" of "localhost:8747": browsers send a host's cookies to all of its ports, so that a second viewer
/// would take the first one's.
std::string cookie_name(std::string_view host) {
  const std::size_t bracket = host.starts_with('[') ? host.find(']') : 0;
  const std::size_t colon = bracket == std::string_view::npos ? bracket : host.find(':', bracket);
  std::string name(kCookie);
  if (colon != std::string_view::npos) {
    name += '_';
    for (const char c : host.substr(colon + 1))
      if (c >= '0' && c <= '9') name += c;
  }
  return name + "=";
}

/// The value of the cookie `name` among "a=b; c=d".
std::string cookie_token(std::string_view cookies, const std::string& name) {
  while (!cookies.empty()) {
    const std::size_t end = cookies.find(';');
    const std::string_view cookie = trimmed(cookies.substr(0, end));
    if (cookie.starts_with(name)) return std::string(cookie.substr(name.size()));
    cookies = end == std::string_view::npos ? std::string_view() : cookies.substr(end + 1);
  }
  return {};
}

std::optional<Response> check_token(const Request& request, const std::string& token) {
  const std::string cookie = cookie_name(request.header("host"));
  const bool at_door = request.method == "GET" && request.path == "/" && request.query.contains("token");
  if (at_door && equal_secrets(request.parameter("token"), token)) {
    Response leads{303, "text/plain", "", {}};
    leads.headers = {{"Location", "/"},
                     {"Set-Cookie", cookie + token + "; HttpOnly; SameSite=Strict; Path=/"}};
    return leads;
  }
  if (equal_secrets(cookie_token(request.header("cookie"), cookie), token)) return std::nullopt;
  return refusal(401, "this viewer needs its token: open the address that kiloband view has printed");
}

}  // namespace

std::string Request::header(const std::string& name) const {
  return find_or_empty(headers, name);
}
std::string Request::parameter(const std::string& name) const {
  return find_or_empty(query, name);
}

Response refusal(int status, const std::string& message) {
  return {status, "application/json", to_text({{"error", message}}), {}};
}

bool equal_secrets(std::string_view a, std::string_view b) {
  unsigned difference = a.size() != b.size();
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |=
        static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b.empty() ? 0 : b[i % b.size()]);
  return difference == 0;
}

std::optional<Response> check_access(const Request& request, const AccessRules& rules) {
  const std::string host = request.header("host");
  if (host.empty() || (rules.loopback && !is_loopback(host)))
    return refusal(403, "Host " + quote_text(host) + ": must be localhost or 127.0.0.1");
  const std::string origin = request.header("origin");
  if (!origin.empty() && origin != "http://" + host)
    return refusal(403, "Origin " + quote_text(origin) + ": another page cannot drive the viewer");
  if (request.method != "GET" && request.method != "POST") return refusal(405, "must be GET or POST");
  if (rules.token)
    if (auto refused = check_token(request, *rules.token)) return refused;
  if (request.method == "POST" && request.header("x-kiloband") != "1")
    return refusal(403, "the header 'X-Kiloband: 1' is missing");
  if (request.path.starts_with("/api/") && request.header("sec-fetch-site") == "cross-site")
    return refusal(403, "another site asks: the viewer answers its own page alone");
  return std::nullopt;
}

}  // namespace kiloband::viewer
