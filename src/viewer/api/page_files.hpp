// The page: files that are embedded in the program.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace kiloband::viewer {

/// By their path in the server: "/viewer.css". Written at build time (cmake/embed_page.cmake) from src/viewer/page.
const std::map<std::string_view, std::string_view>& page_files();

/// "text/css; charset=utf-8" of "/viewer.css".
std::string media_type(std::string_view path);

}  // namespace kiloband::viewer
