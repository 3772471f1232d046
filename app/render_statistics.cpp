#include "app/render_statistics.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "base/json_dump.hpp"
#include "cube/cube_layout.hpp"
#include "stats/comparison/comparison_json.hpp"

namespace kiloband {

const char* to_string(WavelengthMode mode) {
  return mode == WavelengthMode::kShared ? "shared" : "per-path";
}
const char* to_string(StopReason reason) {
  switch (reason) {
    case StopReason::kSamples:
      return "--spp";
    case StopReason::kTime:
      return "--time";
    case StopReason::kError:
      return "--target-error";
    case StopReason::kDark:
      return "darkness: no channel has light";
    case StopReason::kInterrupt:
      break;
  }
  return "an interruption";
}
const char* to_string(SamplerType sampler) {
  return sampler == SamplerType::kSobol ? "sobol" : "independent";
}

/// Not getrusage(): its ru_maxrss goes on from the program that started this one (Linux, execve), however large that was.
uint64_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    const std::string label = "VmHWM:";
    if (line.starts_with(label)) return std::stoull(line.substr(label.size())) * 1024;
  }
  rusage usage{};  // without /proc
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

std::string describe_errors(const RenderReport& report) {
  const BandErrors& errors = report.errors;
  if (!errors.worst)
    return errors.dark_bands > 0 ? "no relative error: no channel has light"
                                 : "no relative error: no pixel has samples in two replicates";
  std::string text = fmt::format(
      "relative error (RMS of the pixels over the image's mean): {:.3g} % in the worst channel ({}), {:.3g} % in "
      "the median one",
      100 * *errors.worst, band_text(report.bands[errors.worst_band]), 100 * errors.median);
  if (errors.dark_bands > 0) text += fmt::format("; channels without light, left out: {}", errors.dark_bands);
  return text;
}

namespace {

/// The errors; null: there are none. JSON has no infinity.
void add_errors(nlohmann::ordered_json& json, const RenderReport& report) {
  constexpr auto number = stats::number_json;
  const BandErrors& errors = report.errors;
  json["mean_relative_error"] = nullptr;  // the same as worst_relative_error, under its name of version 0.1
  json["worst_relative_error"] = nullptr;
  json["worst_channel"] = nullptr;
  json["median_relative_error"] = nullptr;
  if (errors.worst) {
    const Band& band = report.bands[errors.worst_band];
    json["mean_relative_error"] = json["worst_relative_error"] = number(*errors.worst);
    json["worst_channel"] = {{"index", errors.worst_band},
                             {"name", band_text(band)},
                             {"min_nm", band.channel.min_nm},
                             {"max_nm", band.channel.max_nm}};
    json["median_relative_error"] = number(errors.median);
  }
  json["dark_channels"] = errors.dark_bands;
}

const char* json_text(StopReason reason) {
  switch (reason) {
    case StopReason::kSamples:
      return "spp";
    case StopReason::kTime:
      return "time";
    case StopReason::kError:
      return "target-error";
    case StopReason::kDark:
      return "darkness";
    case StopReason::kInterrupt:
      break;
  }
  return "interruption";
}

nlohmann::ordered_json share_json(const DeviceShare& share) {
  nlohmann::ordered_json json{{"backend", share.backend},
                              {"device", share.device},
                              {"paths", share.paths},
                              {"busy_seconds", share.busy_seconds},
                              {"failure", nullptr}};
  if (!share.failure.empty()) json["failure"] = share.failure;
  return json;
}

}  // namespace

std::string statistics_json(const RenderContext& context, const RenderReport& report,
                            const Backend& backend) {
  const BackendInfo info = backend.info();
  const BackendStatistics done = backend.statistics();
  nlohmann::ordered_json json;
  json["backend"] = info.name;
  json["device"] = info.device;
  json["isa"] = info.isa;
  json["method"] = info.method;
  json["wavelengths"] = to_string(context.sampling.wavelengths);
  json["sampler"] = to_string(context.sampling.sampler);
  json["seed"] = context.sampling.seed;
  json["replicates"] = report.replicates;
  json["width"] = context.width;
  json["height"] = context.height;
  json["channels"] = context.channels;
  json["spp"] = report.samples_per_pixel;
  json["seconds"] = report.sampling_seconds;
  json["setup_seconds"] = context.setup_seconds;
  json["output_seconds"] = report.output_seconds;
  json["paths"] = done.paths;
  json["paths_per_second"] =
      report.sampling_seconds > 0 ? static_cast<double>(done.paths) / report.sampling_seconds : 0.0;
  json["vertices"] = done.vertices;
  json["rays"] = done.rays;
  json["peak_memory_bytes"] = peak_memory_bytes();
  json["device_memory_bytes"] = done.device_memory_bytes;
  json["pool_slots"] = done.pool_slots;
  json["longest_launch_seconds"] = done.longest_launch_seconds;
  json["kernel_seconds"] = done.kernel_seconds;
  json["kernel_launches"] = done.kernel_launches;
  json["device_losses"] = done.device_losses;
  if (!done.devices.empty()) json["devices"] = nlohmann::json::array();
  for (const DeviceShare& share : done.devices) json["devices"].push_back(share_json(share));
  json["invalid_samples"] = done.invalid_samples;
  json["resumed_samples"] = report.resumed_samples;
  add_errors(json, report);
  json["underflowed_values"] = report.underflowed_values;
  json["underflowed_variances"] = report.underflowed_variances;
  json["overflowed_values"] = report.overflowed_values;
  json["overflowed_variances"] = report.overflowed_variances;
  json["streamed"] = report.streamed;
  json["interrupted"] = report.interrupted;
  json["ended_by"] = json_text(report.ended_by);
  json["features"] = context.features;
  return dump_json(json, 2) + "\n";
}

}  // namespace kiloband
