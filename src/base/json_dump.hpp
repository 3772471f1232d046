// JSON as text, whatever bytes its strings have.
#pragma once

#include <string>

namespace kiloband {

/// Paths, band names of files, messages of drivers need not be UTF-8: bytes that are not are replaced (U+FFFD), where a plain dump()
/// throws and what was computed is lost. json: nlohmann's, of any kind; indent: blanks, -1: one line
template <class Json>
std::string dump_json(const Json& json, int indent = -1, bool ascii = false) {
  return json.dump(indent, ' ', ascii, Json::error_handler_t::replace);
}

/// The text as it comes back from dump_json(): UTF-8. Json: nlohmann's
template <class Json>
std::string json_text(const std::string& text) {
  return Json::parse(dump_json(Json(text))).template get<std::string>();
}

}  // namespace kiloband
