// What a live render is made with.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/backend.hpp"
#include "scene/description/derived_channels.hpp"
#include "scene/description/description.hpp"

namespace kiloband::viewer {

/// What a page can choose besides the scene. Texts as the command line's options take them.
struct LiveSettings {
  std::string backend;                // "cpu", "opencl"
  std::optional<std::string> device;  // opencl: index or part of the name
  std::string method;                 // one of the backend's
  std::string bands;                  // as --bands; empty: `channels` of the start
  SamplingSettings sampling;
  int max_depth = -1;
};

/// A backend that a page can choose.
struct BackendChoice {
  std::string name, device;
  std::optional<uint32_t> index;  // of devices of one backend
  std::vector<std::string> methods;
};

/// What the program gives: it knows the backends.
struct BackendProvider {
  std::vector<BackendChoice> choices;
  /// throws InputError, DeviceError
  std::function<std::unique_ptr<Backend>(const LiveSettings&, std::shared_ptr<const FlatScene>,
                                         const DerivedChannels&)>
      make;
};

struct LiveOptions {
  SceneDescription scene;
  ChannelList channels, guide;  // guide: empty where it is that of the channels
  DerivedChannels derived;      // responses of a specfilm, while a page has not chosen other channels
  std::string scene_name;
  LiveSettings settings;
  BackendProvider backends;
  std::optional<uint64_t> samples;                  // per pixel, at which the render is done
  std::size_t memory_bytes = std::size_t{4} << 30;  // for the film
  unsigned threads = 1;                             // for what is shown
  DiagnosticSink sink;
};

}  // namespace kiloband::viewer
