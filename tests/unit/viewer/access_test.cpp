#include "viewer/api/access.hpp"

#include <gtest/gtest.h>

#include "tests/unit/viewer/test_requests.hpp"

namespace kiloband::test {
namespace {

using namespace viewer;

int status_of(const Request& request, const AccessRules& rules = {}) {
  const auto refused = check_access(request, rules);
  return refused ? refused->status : 200;
}

Request with(Request request, const std::string& header, const std::string& value) {
  request.headers[header] = value;
  return request;
}

TEST(Access, HostIsThisMachineByAnyPort) {
  for (const char* host : {"localhost:8747", "127.0.0.1:1", "[::1]:8747", "LocalHost", "127.0.0.1"})
    EXPECT_EQ(status_of(with(get_request("/"), "host", host)), 200) << host;
  for (const char* host : {"", "evil.com", "evil.com:8747", "localhost.evil.com", "127.0.0.1.evil.com",
                           "10.0.0.1", "[::2]:80", "[::1", "localhost@evil.com"})
    EXPECT_EQ(status_of(with(get_request("/"), "host", host)), 403) << host;
}

TEST(Access, OriginIsOurOwn) {
  EXPECT_EQ(status_of(post_request("/api/camera", "")), 200);
  for (const char* origin :
       {"http://evil.com", "null", "https://localhost:8747", "http://localhost:3000", "http://localhost"})
    EXPECT_EQ(status_of(with(post_request("/api/camera", ""), "origin", origin)), 403) << origin;
  EXPECT_EQ(status_of(with(get_request("/api/frame"), "sec-fetch-site", "cross-site")), 403);
}

TEST(Access, PostNeedsTheHeaderThatOtherOriginsCannotSend) {
  Request request = post_request("/api/camera", "");
  request.headers.erase("origin");
  EXPECT_EQ(status_of(request), 200);
  request.headers.erase("x-kiloband");
  EXPECT_EQ(status_of(request), 403);
}

TEST(Access, OtherMethodsAreRefused) {
  for (const char* method : {"PUT", "DELETE", "HEAD", "OPTIONS", ""}) {
    Request request = get_request("/");
    request.method = method;
    EXPECT_EQ(status_of(request), 405) << method;
  }
}

TEST(Access, TheTokenIsAskedForEverywhere) {
  const AccessRules rules{"0123456789abcdef", false};
  EXPECT_EQ(status_of(get_request("/"), rules), 401);
  EXPECT_EQ(status_of(get_request("/viewer.css"), rules), 401);
  EXPECT_EQ(status_of(post_request("/api/camera", ""), rules), 401);
  EXPECT_EQ(status_of(get_request("/", {{"token", "0123456789abcdeX"}}), rules), 401);
  EXPECT_EQ(status_of(get_request("/api/scene", {{"token", "0123456789abcdef"}}), rules), 401);
  const auto leads = check_access(get_request("/", {{"token", "0123456789abcdef"}}), rules);
  ASSERT_TRUE(leads);
  EXPECT_EQ(leads->status, 303);
  EXPECT_EQ(leads->headers[1].second,
            "kiloband_token_8747=0123456789abcdef; HttpOnly; SameSite=Strict; Path=/");
  for (const char* cookie :
       {"kiloband_token_8747=0123456789abcdef", "a=b; kiloband_token_8747=0123456789abcdef ;c=d"})
    EXPECT_EQ(status_of(with(get_request("/api/scene"), "cookie", cookie), rules), 200) << cookie;
  for (const char* cookie : {"kiloband_token_8748=0123456789abcdef", "kiloband_token_8747=0123456789abcde",
                             "kiloband_token_8747=", "xkiloband_token_8747=0123456789abcdef", ";;="})
    EXPECT_EQ(status_of(with(get_request("/api/scene"), "cookie", cookie), rules), 401) << cookie;
}

TEST(Access, WithATokenAnyHostMayBeOurs) {
  const AccessRules rules{"0123456789abcdef", false};
  const Request request =
      with(with(get_request("/"), "host", "node7:8747"), "cookie", "kiloband_token_8747=0123456789abcdef");
  EXPECT_EQ(status_of(request, rules), 200);
  EXPECT_EQ(status_of(with(request, "origin", "http://evil.com"), rules), 403);
}

}  // namespace
}  // namespace kiloband::test
