// The answers to a page's requests. docs/viewer.md lists them.
#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>

#include "viewer/api/access.hpp"
#include "viewer/api/kept_curves.hpp"
#include "viewer/api/view_mode.hpp"
#include "viewer/api/viewed_image.hpp"

namespace kiloband::viewer {

struct ApiSettings {
  AccessRules access;
  /// The one folder that pages may have files written in; absent: none.
  std::optional<std::filesystem::path> output_dir;
};

/// Thread-safe, as the image is.
class Api {
 public:
  /// The image must outlive the object.
  Api(ViewedImage& image, ApiSettings settings) : image_(image), settings_(std::move(settings)) {}

  /// The answer to any request but /api/events, which is a stream.
  /// gone  whether the client has hung up: ends waiting
  Response answer(const Request& request, const std::function<bool()>& gone);

  /// What precedes every answer, /api/events too.
  std::optional<Response> refuse(const Request& request) const {
    return check_access(request, settings_.access);
  }

  ViewedImage& image() { return image_; }
  /// Grows whenever the answer of /api/scene changes.
  uint64_t scene_number() const { return image_.scene_number() + responses_.number(); }

 private:
  Response route(const Request& request, const std::function<bool()>& gone);
  Response get(const Request& request, const std::function<bool()>& gone);
  Response post(const Request& request);
  Response scene();
  Response frame(const Request& request, const std::function<bool()>& gone);
  Response values(const Request& request);
  Response spectra(const Request& request);
  std::vector<Curve> curves_of(const ImageView& seen, const std::vector<Selection>& places);
  Response export_csv(const Request& request);
  Response save(const nlohmann::json& wanted);
  Response control(const nlohmann::json& wanted);
  RenderControls& controls();

  ViewedImage& image_;
  ApiSettings settings_;
  Responses responses_;
  KeptCurves kept_curves_;
  std::mutex saving_;  // one file at a time: a name that is free stays so until it is taken
};

}  // namespace kiloband::viewer
