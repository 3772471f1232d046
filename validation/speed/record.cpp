#include "validation/speed/record.hpp"

#include <fmt/format.h>

#include <cmath>

namespace kiloband::speed {
namespace {

using nlohmann::ordered_json;

/// All fields, in the order of columns. A field is a string or a number; null: it does not apply.
ordered_json fields_of(const Record& r) {
  const auto text = [](const std::string& s) { return s.empty() ? ordered_json() : ordered_json(s); };
  const auto count = [](auto n) { return n == 0 ? ordered_json() : ordered_json(n); };
  const auto number = [](double v) { return std::isfinite(v) ? ordered_json(v) : ordered_json(); };
  const Setup& s = r.setup;
  ordered_json j;
  j["case"] = text(r.group);
  j["scene"] = text(s.scene);
  j["backend"] = text(s.backend);
  j["method"] = text(s.method);
  j["wavelengths"] = text(s.wavelengths);
  j["sampler"] = text(s.sampler);
  j["dispersion"] = text(s.dispersion);
  j["channels"] = count(s.channels);
  j["part"] = count(s.part);
  j["width"] = count(s.width);
  j["height"] = count(s.height);
  j["pool"] = count(s.pool);
  j["depth"] = count(s.depth);
  j["replicates"] = count(s.replicates);
  j["samples"] = count(s.samples);
  j["series"] = text(r.series);
  j["channel_nm"] = number(r.channel_nm);
  j["quantity"] = text(r.quantity);
  j["value"] = number(r.value);
  j["error"] = number(r.error);
  j["unit"] = text(r.unit);
  j["error_kind"] = text(r.error_kind);
  j["repetitions"] = count(r.repetitions);
  j["note"] = text(r.note);
  j["command"] = text(r.command);
  return j;
}

std::string csv_field(const ordered_json& field) {
  if (field.is_null()) return {};
  if (field.is_number_float()) return fmt::format("{:.9g}", field.get<double>());
  if (!field.is_string()) return field.dump();
  const auto text = field.get<std::string>();
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace

std::string to_csv(const std::vector<Record>& records) {
  std::string csv;
  const ordered_json columns = fields_of({});
  for (const auto& [name, field] : columns.items()) csv += (csv.empty() ? "" : ",") + name;
  csv += '\n';
  for (const Record& record : records) {
    const ordered_json fields = fields_of(record);
    std::string line;
    for (auto field = fields.begin(); field != fields.end(); ++field)
      line += (field == fields.begin() ? "" : ",") + csv_field(*field);
    csv += line + '\n';
  }
  return csv;
}

ordered_json to_json(const Record& record) {
  const ordered_json fields = fields_of(record);
  ordered_json json;
  for (const auto& [name, field] : fields.items())
    if (!field.is_null() || name == "value" || name == "error") json[name] = field;
  return json;
}

}  // namespace kiloband::speed
