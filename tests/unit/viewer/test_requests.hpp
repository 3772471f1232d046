// Requests as a page of the server's own sends them.
#pragma once

#include <string>
#include <utility>

#include "viewer/api/access.hpp"

namespace kiloband::test {

inline viewer::Request get_request(const std::string& path, std::map<std::string, std::string> query = {}) {
  return {"GET", path, std::move(query), {{"host", "localhost:8747"}}, ""};
}

inline viewer::Request post_request(const std::string& path, const std::string& body) {
  return {"POST",
          path,
          {},
          {{"host", "localhost:8747"},
           {"origin", "http://localhost:8747"},
           {"x-kiloband", "1"},
           {"content-type", "application/json"}},
          body};
}

}  // namespace kiloband::test
