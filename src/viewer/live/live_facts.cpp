// What a live render states of itself, and what pages may choose: the rest of LiveState.
#include <fmt/format.h>

#include <cmath>

#include "render/scene_metadata.hpp"
#include "spectral/materials/materials.hpp"
#include "viewer/api/json_text.hpp"
#include "viewer/live/camera_view.hpp"
#include "viewer/live/live_state.hpp"

namespace kiloband::viewer {
namespace {

using nlohmann::json;

const char* sampler_name(SamplerType sampler) {
  return sampler == SamplerType::kSobol ? "sobol" : "independent";
}
const char* wavelengths_name(WavelengthMode mode) {
  return mode == WavelengthMode::kShared ? "shared" : "per-path";
}

json choices_json(const std::vector<BackendChoice>& backends) {
  json choices{{"backends", json::array()},
               {"materials", {{"metals", json::array()}, {"glasses", json::array()}}}};
  for (const BackendChoice& backend : backends) {
    choices["backends"].push_back({{"name", backend.name},
                                   {"device", backend.device},
                                   {"index", backend.index ? json(*backend.index) : json(nullptr)},
                                   {"methods", backend.methods}});
  }
  for (const BuiltInMaterial& metal : built_in_metals()) choices["materials"]["metals"].push_back(metal.name);
  for (const BuiltInMaterial& glass : built_in_dielectrics())
    choices["materials"]["glasses"].push_back(glass.name);
  return choices;
}

/// One of two names.
template <class Value>
void choose(const json& wanted, const char* member, std::pair<const char*, Value> a,
            std::pair<const char*, Value> b, Value& value) {
  const auto text = get_text(wanted, member);
  if (!text) return;
  if (*text != a.first && *text != b.first)
    throw InputError(fmt::format("{}: must be {} or {}", member, a.first, b.first));
  value = *text == a.first ? a.second : b.second;
}

void choose_backend(const json& wanted, const std::vector<BackendChoice>& choices, LiveSettings& settings) {
  if (const auto backend = get_text(wanted, "backend")) {
    if (*backend != settings.backend) settings.device.reset(), settings.method.clear();
    settings.backend = *backend;
  }
  if (wanted.contains("device")) {
    const json& device = wanted["device"];
    settings.device = device.is_number_unsigned() ? std::to_string(device.get<uint64_t>())
                                                  : get_text(wanted, "device").value_or("");
    if (settings.backend == "cpu") settings.device.reset();
  }
  if (const auto method = get_text(wanted, "method")) settings.method = *method;
  for (const BackendChoice& choice : choices) {
    if (choice.name != settings.backend) continue;
    if (settings.method.empty()) settings.method = choice.methods.front();
    for (const std::string& method : choice.methods)
      if (method == settings.method) return;
    throw InputError(fmt::format("method: the backend {} has no '{}'", choice.name, settings.method));
  }
  throw InputError("backend: there is no such backend on this machine");
}

}  // namespace

json LiveState::scene_json() const {
  const auto [width, height] = full_size();
  json scene{{"kind", "scene"},
             {"name", options_.scene_name},
             {"revision", status_.newest.revision},
             {"width", width},
             {"height", height},
             {"channels", channels_json(bands())},
             {"errors", variance_},
             {"camera", camera_json(sensor_, distance_, scene_size_)},
             {"choices", choices_json(options_.backends.choices)},
             {"spectra", edits_.list(options_.scene, hull(channels_))}};
  const BackendInfo info = is_ready() ? backend_->info() : BackendInfo{};
  scene["settings"] = {{"backend", settings_.backend},
                       {"device", info.device},
                       {"method", settings_.method},
                       {"bands", settings_.bands},
                       {"sampler", sampler_name(settings_.sampling.sampler)},
                       {"wavelengths", wavelengths_name(settings_.sampling.wavelengths)},
                       {"max_depth", settings_.max_depth}};
  return scene;
}

std::map<std::string, std::string> LiveState::metadata() const {
  std::map<std::string, std::string> metadata{
      {"software", "kiloband " KILOBAND_VERSION},
      {"scene", options_.scene_name},
      {"backend", settings_.backend},
      {"method", settings_.method},
      {"max_depth", std::to_string(settings_.max_depth)},
      {"seed", std::to_string(settings_.sampling.seed)},
      {"sampler", sampler_name(settings_.sampling.sampler)},
      {"wavelengths", wavelengths_name(settings_.sampling.wavelengths)}};
  if (std::string edited = edits_.summary(options_.scene); !edited.empty())
    metadata["edited"] = std::move(edited);
  if (scene_ && film_ == full_.get()) metadata[kCameraKey] = camera_geometry(*scene_).to_text();
  return metadata;
}

std::string LiveState::camera_xml() const {
  return sensor_xml(sensor_);
}

void LiveState::set_settings(const json& wanted) {
  check_members(wanted, {"backend", "device", "method", "bands", "sampler", "wavelengths", "max_depth"});
  LiveSettings settings = settings_;
  ChannelList channels = channels_;
  DerivedChannels derived = derived_;
  choose_backend(wanted, options_.backends.choices, settings);
  choose<SamplerType>(wanted, "sampler", {"sobol", SamplerType::kSobol},
                      {"independent", SamplerType::kIndependent}, settings.sampling.sampler);
  choose<WavelengthMode>(wanted, "wavelengths", {"shared", WavelengthMode::kShared},
                         {"per-path", WavelengthMode::kPerPath}, settings.sampling.wavelengths);
  if (const auto depth = get_number(wanted, "max_depth")) {
    if (*depth != std::floor(*depth) || *depth < -1 || *depth > 1e6)
      throw InputError("max_depth: must be a whole number from -1 to 1000000");
    settings.max_depth = static_cast<int>(*depth);
  }
  if (const auto bands = get_text(wanted, "bands"); bands && *bands != settings.bands) {
    channels = parse_channels(*bands);
    check_film(channels.size());
    edits_.check_all(options_.scene, hull(channels));
    derived = {};  // as with --bands
    settings.bands = *bands;
  }
  settings_ = settings;
  channels_ = std::move(channels);
  derived_ = std::move(derived);
  failed_ = false;
  status_.message.clear();
  scene_.reset();
  pass_seconds_ = 0;
  begin_revision();
}

void LiveState::set_spectrum(const json& wanted) {
  edits_.set(options_.scene, hull(channels_), wanted);
  failed_ = false;
  status_.message.clear();
  scene_.reset();
  begin_revision();
}

}  // namespace kiloband::viewer
