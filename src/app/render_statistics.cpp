#include "app/render_statistics.hpp"

#include <sys/resource.h>

#include <nlohmann/json.hpp>

namespace kiloband {

const char* to_string(WavelengthMode mode) {
  return mode == WavelengthMode::kShared ? "shared" : "per-path";
}
const char* to_string(SamplerType sampler) {
  return sampler == SamplerType::kSobol ? "sobol" : "independent";
}

uint64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

std::string statistics_json(const RenderContext& context, const RenderReport& report,
                            const Backend& backend) {
  const RenderCounters& counters = backend.counters();
  nlohmann::ordered_json json;
  json["backend"] = backend.name();
  json["device"] = backend.device();
  json["isa"] = backend.isa();
  json["method"] = backend.method();
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
  json["paths"] = counters.paths.load();
  json["paths_per_second"] = report.sampling_seconds > 0
                                 ? static_cast<double>(counters.paths.load()) / report.sampling_seconds
                                 : 0.0;
  json["vertices"] = counters.vertices.load();
  json["rays"] = counters.rays.load();
  json["peak_memory_bytes"] = peak_memory_bytes();
  json["device_memory_bytes"] = backend.device_memory_bytes();
  json["longest_launch_seconds"] = backend.longest_launch_seconds();
  json["kernel_seconds"] = backend.kernel_seconds();
  json["device_losses"] = backend.device_losses();
  json["invalid_samples"] = counters.invalid_samples.load();
  json["resumed_samples"] = report.resumed_samples;
  json["mean_relative_error"] = nullptr;
  if (report.mean_relative_error) json["mean_relative_error"] = *report.mean_relative_error;
  json["underflowed_values"] = report.underflowed_values;
  json["overflowed_values"] = report.overflowed_values;
  json["overflowed_variances"] = report.overflowed_variances;
  json["streamed"] = report.streamed;
  json["interrupted"] = report.interrupted;
  json["features"] = context.features;
  return json.dump(2) + "\n";
}

}  // namespace kiloband
