#include "viewer/api/page_files.hpp"

#include <algorithm>

namespace kiloband::viewer {

std::string media_type(std::string_view path) {
  static const std::map<std::string_view, std::string_view> kTypes{{".html", "text/html; charset=utf-8"},
                                                                   {".css", "text/css; charset=utf-8"},
                                                                   {".js", "text/javascript; charset=utf-8"},
                                                                   {".mjs", "text/javascript; charset=utf-8"},
                                                                   {".svg", "image/svg+xml"},
                                                                   {".json", "application/json"}};
  const auto type = kTypes.find(path.substr(std::min(path.rfind('.'), path.size())));
  return std::string(type == kTypes.end() ? "text/plain; charset=utf-8" : type->second);
}

}  // namespace kiloband::viewer
