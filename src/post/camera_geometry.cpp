#include "post/camera_geometry.hpp"

#include <cmath>
#include <vector>

#include "cube/cube_text.hpp"

namespace kiloband {
namespace {

constexpr std::string_view kPerspective = "perspective", kOrthographic = "orthographic";

/// "word number number ..." after the projection's name: the numbers that follow `word`.
class Words {
 public:
  explicit Words(std::string_view text) : words_(split(text, ' ')) {}

  std::string_view first() const { return words_.front(); }
  std::optional<double> number(std::string_view word, std::size_t offset = 1) const {
    for (std::size_t i = 1; i + offset < words_.size(); ++i)
      if (words_[i] == word) return parse_number(words_[i + offset]);
    return std::nullopt;
  }
  std::optional<uint32_t> whole(std::string_view word, std::size_t offset = 1) const {
    const auto value = number(word, offset);
    if (!value || *value < 0 || *value > 65535 || *value != std::floor(*value)) return std::nullopt;
    return static_cast<uint32_t>(*value);
  }

 private:
  std::vector<std::string_view> words_;
};

std::optional<CameraGeometry> parse_orthographic(const Words& words) {
  const auto area = words.number("pixel_area");
  if (!area || !(*area > 0) || !std::isfinite(*area)) return std::nullopt;
  CameraGeometry camera;
  camera.orthographic = true;
  camera.pixel_area_m2 = *area;
  return camera;
}

std::optional<CameraGeometry> parse_perspective(const Words& words) {
  const auto width = words.whole("film", 1), height = words.whole("film", 2);
  const auto crop_x = words.whole("crop", 1), crop_y = words.whole("crop", 2);
  const auto tangent = words.number("tan_half_fov_x");
  const auto px = words.number("principal", 1), py = words.number("principal", 2);
  if (!width || !height || !crop_x || !crop_y || !tangent || !px || !py) return std::nullopt;
  if (*width < 1 || *height < 1 || !(*tangent > 0) || !std::isfinite(*tangent + *px + *py))
    return std::nullopt;
  return CameraGeometry{false, 0, *width, *height, *crop_x, *crop_y, *tangent, *px, *py};
}

std::optional<CameraGeometry> parse_camera(std::string_view text) {
  const Words words(text);
  if (words.first() == kOrthographic) return parse_orthographic(words);
  return words.first() == kPerspective ? parse_perspective(words) : std::nullopt;
}

}  // namespace

double CameraGeometry::pixel_weight(uint32_t x, uint32_t y) const {
  if (orthographic) return pixel_area_m2;
  const double pixel = 2 * tan_half_fov_x / film_width;  // edge length on the plane at distance 1
  const double right = (crop_x + x + 0.5 + principal_x * film_width - 0.5 * film_width) * pixel;
  const double down = (crop_y + y + 0.5 + principal_y * film_height - 0.5 * film_height) * pixel;
  return pixel * pixel / std::pow(1 + right * right + down * down, 1.5);
}

std::string CameraGeometry::to_text() const {
  if (orthographic) return std::string(kOrthographic) + " pixel_area " + format_number(pixel_area_m2);
  const auto whole = [](uint32_t a, uint32_t b) { return std::to_string(a) + " " + std::to_string(b); };
  return std::string(kPerspective) + " film " + whole(film_width, film_height) + " crop " +
         whole(crop_x, crop_y) + " tan_half_fov_x " + format_number(tan_half_fov_x) + " principal " +
         format_number(principal_x) + " " + format_number(principal_y);
}

std::optional<CameraGeometry> camera_of_cube(const CubeInfo& info, const std::string& where) {
  const auto found = info.metadata.find(kCameraKey);
  if (found == info.metadata.end()) return std::nullopt;
  const auto camera = parse_camera(found->second);
  if (!camera) throw InputError(where + ": camera '" + printable(found->second) + "': not understood");
  return camera;
}

void crop_camera(CubeInfo& info, uint32_t x0, uint32_t y0) {
  const auto found = info.metadata.find(kCameraKey);
  auto camera = found == info.metadata.end() ? std::nullopt : parse_camera(found->second);
  if (!camera || camera->orthographic) return;
  camera->crop_x += x0;
  camera->crop_y += y0;
  info.metadata[kCameraKey] = camera->to_text();
}

}  // namespace kiloband
