#include "viewer/live/scene_spectra.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/temporary_folder.hpp"
#include "base/text.hpp"
#include "scene/read/object/limits.hpp"
#include "spectral/files/spectrum_files.hpp"
#include "spectral/materials/materials.hpp"
#include "viewer/api/json_text.hpp"

namespace kiloband::viewer {
namespace {

using nlohmann::json;
using Type = SpectrumSlot::Type;

constexpr int kPoints = 200;  // of a spectrum that is drawn
const Channel kEverything{1, 1e9, ""};

std::string id_of(std::size_t index) {
  return fmt::format("s{}", index);
}

ValueKind kind_of(const SpectrumSlot& slot) {
  if (slot.type != Type::kEmission) return ValueKind::kPlain;
  if (slot.role == "intensity") return ValueKind::kIntensity;
  return slot.role == "irradiance" ? ValueKind::kIrradiance : ValueKind::kRadiance;
}

/// A file of the user's machine, of which the page sends the text.
Spectrum read_text(const std::string& text, ValueKind kind) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.write("spectrum.txt", text);
  try {
    return read_spectrum_file(file, kind);
  } catch (const InputError& error) {
    std::string message = error.what();
    replace_all(message, folder.path().string() + "/", "");
    throw InputError(message);
  }
}

json editable(Type type) {
  switch (type) {
    case Type::kReflectance:
      return {"constant", "file"};
    case Type::kEmission:
      return {"constant", "file", "temperature", "scale"};
    case Type::kMetal:
      return {"metal"};
    case Type::kGlass:
      return {"constant", "file", "glass"};
    case Type::kTemperature:
      return {"temperature"};
    case Type::kScale:
      return {"scale"};
  }
  throw std::logic_error("editable: unknown type");
}

/// What a slot holds, drawn over the range.
void add_values(const SpectrumSlot& slot, const Channel& range, json& entry) {
  if (!slot.spectrum) {
    entry["value"] = *slot.number;
    return;
  }
  std::vector<float> wavelengths, values, second;
  for (int i = 0; i < kPoints; ++i) {
    const double lambda = range.min_nm + range.width_nm() * i / (kPoints - 1);
    wavelengths.push_back(static_cast<float>(lambda));
    values.push_back(static_cast<float>((*slot.spectrum)(lambda)));
    if (slot.second) second.push_back(static_cast<float>((*slot.second)(lambda)));
  }
  entry["wavelength_nm"] = numbers_json(wavelengths);
  entry["values"] = numbers_json(values);
  if (slot.second) entry["values_k"] = numbers_json(second);
}

}  // namespace

SpectrumEdits::Edit SpectrumEdits::parse_material(const SpectrumSlot& slot, const std::string& kind,
                                                  const std::string& name) {
  if (kind == "glass" && slot.type == Type::kGlass) {
    if (auto n = find_dielectric(name)) return {*n, name};
  } else if (kind == "metal" && slot.type == Type::kMetal) {
    if (auto constants = find_metal(name))
      return {Pair{constants->n, constants->k.value_or(Spectrum())}, name};
  } else {
    throw InputError(fmt::format("{} of {} cannot be a {}", slot.role, slot.owner, kind));
  }
  throw InputError(fmt::format("there is no {} {}", kind, quote_text(name)));
}

SpectrumEdits::Edit SpectrumEdits::parse(const SpectrumSlot& slot, const json& wanted) {
  check_members(wanted, {"constant", "file_text", "metal", "glass", "temperature_k", "scale"});
  if (wanted.size() != 1) throw InputError("set: must have one member");
  const bool is_spectrum =
      slot.type == Type::kReflectance || slot.type == Type::kEmission || slot.type == Type::kGlass;
  if (const auto name = get_text(wanted, "metal")) return parse_material(slot, "metal", *name);
  if (const auto name = get_text(wanted, "glass")) return parse_material(slot, "glass", *name);
  if (const auto value = get_number(wanted, "constant"); value && is_spectrum)
    return {Spectrum::constant(*value), ""};
  if (const auto text = get_text(wanted, "file_text"); text && is_spectrum)
    return {read_text(*text, kind_of(slot)), ""};
  const auto kelvin = get_number(wanted, "temperature_k");
  if (kelvin && (slot.type == Type::kTemperature || slot.type == Type::kEmission)) {
    if (!(*kelvin > 0 && *kelvin <= kMaxTemperatureK))
      throw InputError(
          fmt::format("temperature_k: {}: must be above 0 and at most {:g} K", *kelvin, kMaxTemperatureK));
    return {Temperature{*kelvin}, ""};
  }
  const auto factor = get_number(wanted, "scale");
  if (factor && (slot.type == Type::kScale || slot.type == Type::kEmission)) {
    if (!(*factor >= 0 && *factor <= 1e12)) throw InputError("scale: must be from 0 to 1e12");
    return {Scale{*factor}, ""};
  }
  throw InputError(fmt::format("{} of {} cannot be set to that", slot.role, slot.owner));
}

void SpectrumEdits::apply_to(SpectrumSlot& slot, const Edit& edit) {
  if (const auto* spectrum = std::get_if<Spectrum>(&edit.value)) {
    *slot.spectrum = *spectrum;
  } else if (const auto* pair = std::get_if<Pair>(&edit.value)) {
    *slot.spectrum = pair->n;
    *slot.second = pair->k;
  } else if (const auto* temperature = std::get_if<Temperature>(&edit.value)) {
    if (slot.number)
      *slot.number = temperature->kelvin;
    else
      *slot.spectrum = Spectrum::planck(temperature->kelvin, 1);
  } else {
    const double factor = std::get<Scale>(edit.value).factor;
    if (slot.number)
      *slot.number = factor;
    else
      *slot.spectrum = slot.spectrum->scaled(factor);
  }
}

/// The rules of scene files: all of the data counts. An index is needed where it is rendered.
void SpectrumEdits::check(const SpectrumSlot& slot, const Channel& rendered) {
  if (!slot.spectrum) return;
  const bool is_index = slot.type == Type::kGlass || slot.type == Type::kMetal;
  const Channel range = is_index ? rendered : kEverything;
  const double least = slot.spectrum->min_over(range.min_nm, range.max_nm);
  const double most = slot.spectrum->max_over(range.min_nm, range.max_nm);
  const std::string what = slot.role + " of " + slot.owner;
  if (slot.type == Type::kReflectance && !(least >= 0 && most <= 1))
    throw InputError(fmt::format("{}: {:g} to {:g}: must be from 0 to 1", what, least, most));
  if (slot.type == Type::kEmission && !(least >= 0 && most <= kMaxEmission))
    throw InputError(
        fmt::format("{}: {:g} to {:g}: must be from 0 to {:g}", what, least, most, kMaxEmission));
  if (is_index && !(least > 0 && most < 100))
    throw InputError(
        fmt::format("{}: {:g} to {:g} over the channels: must be above 0 and below 100 (outside its data an "
                    "index is 0)",
                    what, least, most));
}

void SpectrumEdits::set(const SceneDescription& original, const Channel& range, const json& wanted) {
  check_members(wanted, {"id", "set"});
  const std::string id = get_text(wanted, "id").value_or("");
  if (!wanted.contains("set") || !wanted["set"].is_object()) throw InputError("set: must be an object");
  const json& value = wanted["set"];
  if (get_flag(value, "reset").value_or(false)) {
    if (edits_.erase(id) == 0) throw InputError("nothing was set in place of " + quote_text(id));
    return;
  }
  SceneDescription copy = original;
  std::optional<Edit> edit;
  std::size_t index = 0;
  visit_spectra(copy, [&](SpectrumSlot& slot) {
    if (id_of(index++) != id) return;
    edit = parse(slot, value);
    apply_to(slot, *edit);
    check(slot, range);
  });
  if (!edit) throw InputError("the scene has no spectrum " + quote_text(id));
  edits_[id] = *edit;
}

void SpectrumEdits::check_all(const SceneDescription& original, const Channel& range) const {
  SceneDescription copy = original;
  std::size_t index = 0;
  visit_spectra(copy, [&](SpectrumSlot& slot) {
    const auto edit = edits_.find(id_of(index++));
    if (edit == edits_.end()) return;
    apply_to(slot, edit->second);
    check(slot, range);
  });
}

std::string SpectrumEdits::summary(const SceneDescription& original) const {
  std::string summary;
  SceneDescription copy = original;
  std::size_t index = 0;
  visit_spectra(copy, [&](SpectrumSlot& slot) {
    const auto found = edits_.find(id_of(index++));
    if (found == edits_.end()) return;
    const Edit& edit = found->second;
    summary += fmt::format("{}{} of {}", summary.empty() ? "" : "; ", slot.role, slot.owner);
    if (const auto* temperature = std::get_if<Temperature>(&edit.value))
      summary += slot.number ? fmt::format(" = {:g} K", temperature->kelvin)
                             : fmt::format(": Planck's law of {:g} K", temperature->kelvin);
    else if (const auto* scale = std::get_if<Scale>(&edit.value))
      summary += fmt::format("{}{:g}", slot.number ? " = " : " x ", scale->factor);
    else if (!edit.name.empty())
      summary += ": " + edit.name;
    else if (const auto& spectrum = std::get<Spectrum>(edit.value); spectrum.is_constant())
      summary += fmt::format(" = {:g}", spectrum(500));
    else
      summary += ": a table";
  });
  return summary;
}

SceneDescription SpectrumEdits::apply(const SceneDescription& original) const {
  SceneDescription changed = original;
  std::size_t index = 0;
  visit_spectra(changed, [&](SpectrumSlot& slot) {
    const auto edit = edits_.find(id_of(index++));
    if (edit != edits_.end()) apply_to(slot, edit->second);
  });
  return changed;
}

json SpectrumEdits::list(const SceneDescription& original, const Channel& range) const {
  static constexpr const char* kKinds[] = {"spectrum", "spectrum", "metal", "glass", "temperature", "scale"};
  json list = json::array();
  SceneDescription copy = original;
  visit_spectra(copy, [&](SpectrumSlot& slot) {
    const std::string id = id_of(list.size());
    const auto edit = edits_.find(id);
    if (edit != edits_.end()) apply_to(slot, edit->second);
    json entry{{"id", id},
               {"owner", slot.owner},
               {"role", slot.role},
               {"unit", slot.unit},
               {"kind", kKinds[static_cast<std::size_t>(slot.type)]},
               {"editable", editable(slot.type)},
               {"edited", edit != edits_.end()},
               {"value", nullptr},
               {"name", nullptr}};
    const std::string& name = edit != edits_.end() ? edit->second.name : slot.name;
    if (!name.empty()) entry["name"] = name;
    add_values(slot, range, entry);
    list.push_back(std::move(entry));
  });
  return list;
}

}  // namespace kiloband::viewer
