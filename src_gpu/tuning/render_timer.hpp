// Times renders of a scene on a device with given sizes of the pipeline.
#pragma once

#include <memory>
#include <optional>

#include "src_gpu/opencl_backend.hpp"
#include "src_gpu/tuning/tuner.hpp"

namespace kiloband::opencl {

class RenderTimer {
 public:
  /// options  device, method, memory; its sizes are not looked at
  /// throws as make_backend()
  RenderTimer(std::shared_ptr<const FlatScene> scene, const SamplingSettings& sampling,
              const Options& options);

  /// Samples per pixel, so many that a render takes `seconds` (at least kFewestSamples; stop ends the search). Kernels are compiled then.
  void calibrate(double seconds, const std::atomic<bool>& stop);

  /// Seconds of a render of all pixels, after one of a quarter of the samples that is not timed; nothing: the device failed, or
  /// the render was stopped.
  std::optional<double> time(const Tuning& tuning, const std::atomic<bool>& stop) const;

  /// Of the renders that are timed.
  uint64_t paths() const;
  uint32_t samples() const { return samples_; }
  const DeviceInfo& device() const { return device_; }
  TuningBounds bounds() const;

 private:
  std::unique_ptr<Backend> make(const Tuning& tuning) const;
  double render(Backend& backend, uint32_t samples, const std::atomic<bool>& stop) const;

  std::shared_ptr<const FlatScene> scene_;
  SamplingSettings sampling_;
  Options options_;
  DeviceInfo device_;
  BackendMaker maker_;
  uint32_t samples_ = 1;
};

}  // namespace kiloband::opencl
