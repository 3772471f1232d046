#include "app/signature_masks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "cube/cube_text.hpp"
#include "post/convert.hpp"
#include "scene/image/image.hpp"
#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

/// An auxiliary plane of the cube, [y][x]; throws InputError if it has none of that name.
std::vector<float> aux_plane(CubeReader& cube, const std::string& name, const std::string& needed_by) {
  const CubeInfo& info = cube.info();
  const auto found = std::find(info.aux.begin(), info.aux.end(), name);
  if (found == info.aux.end())
    throw InputError(fmt::format("{}: the cube has no auxiliary image '{}': render it with --aov {}",
                                 needed_by, name, name));
  const auto plane = static_cast<std::size_t>(found - info.aux.begin());
  std::vector<float> values, row(info.width * info.aux.size());
  for (uint32_t y = 0; y < info.height; ++y) {
    cube.read_aux(y, 1, row);
    for (uint32_t x = 0; x < info.width; ++x) values.push_back(row[x * info.aux.size() + plane]);
  }
  return values;
}

/// Names and numbers of objects, as the render writes them: "0 body, 2 nozzle".
std::vector<std::pair<std::string, uint32_t>> named_objects(const CubeInfo& info) {
  std::vector<std::pair<std::string, uint32_t>> objects;
  const auto found = info.metadata.find("objects");
  if (found == info.metadata.end()) return objects;
  for (const std::string_view part : split(found->second, ',')) {
    const std::string_view entry = trimmed(part);
    const auto blank = entry.find(' ');
    const auto number = parse_unsigned(entry.substr(0, blank));
    if (number && blank != std::string_view::npos)
      objects.emplace_back(decode_text(entry.substr(blank + 1)), static_cast<uint32_t>(*number));
  }
  return objects;
}

/// "nozzle,3": the numbers of these objects. Several shapes may have been given one name by includes.
std::set<uint32_t> object_ids(const CubeInfo& info, const std::string& text) {
  const auto names = named_objects(info);
  std::vector<std::string_view> known;
  for (const auto& [name, id] : names) known.push_back(name);
  std::set<uint32_t> ids;
  for (const std::string_view word : split(text, ',')) {
    bool found = false;
    for (const auto& [name, id] : names)
      if (name == trimmed(word)) ids.insert(id), found = true;
    if (found) continue;
    const auto number = parse_unsigned(trimmed(word));
    if (!number || *number > UINT32_MAX)
      throw InputError(fmt::format("--object {}: no object '{}'{}", text, trimmed(word),
                                   suggestion(std::string(trimmed(word)), known)));
    ids.insert(static_cast<uint32_t>(*number));
  }
  return ids;
}

PixelMask image_mask(const CubeInfo& info, const std::string& file) {
  const Image image = read_image(file, true);
  if (image.width != info.width || image.height != info.height)
    throw InputError(fmt::format("--mask {}: {}x{} pixels, the cube has {}x{}", file, image.width,
                                 image.height, info.width, info.height));
  PixelMask mask(info.width, info.height);
  for (uint32_t y = 0; y < info.height; ++y)
    for (uint32_t x = 0; x < info.width; ++x) {
      const float* pixel = &image.pixels[(std::size_t{y} * info.width + x) * image.channels];
      if (std::any_of(pixel, pixel + image.channels, [](float v) { return v > 0.5f; })) mask.insert(x, y);
    }
  return mask;
}

struct NamedMask {
  std::string label;
  PixelMask pixels;
};

/// Of several objects in one option, those that are not seen: hidden ones, and numbers that the scene has not.
void warn_of_unseen(const CubeInfo& info, const std::vector<float>& plane, const std::string& text,
                    const DiagnosticSink& sink) {
  for (const std::string_view word : split(text, ','))
    if (PixelMask::of_ids(info.width, info.height, plane, object_ids(info, std::string(word))).empty())
      warn(sink, {}, fmt::format("--object {}: '{}' is in no pixel", text, trimmed(word)));
}

std::vector<NamedMask> chosen_masks(const PlaceOptions& options, CubeReader& cube,
                                    const DiagnosticSink& sink) {
  const CubeInfo& info = cube.info();
  std::vector<NamedMask> masks;
  for (const std::string& text : options.objects) {
    const auto plane = aux_plane(cube, "object", "--object");
    masks.push_back({text, PixelMask::of_ids(info.width, info.height, plane, object_ids(info, text))});
    if (masks.back().pixels.empty()) throw InputError(fmt::format("--object {}: is in no pixel", text));
    warn_of_unseen(info, plane, text, sink);
  }
  for (const std::string& text : options.regions) {
    const PixelRect rect = parse_rect("--region", text);
    check_region(info, rect);
    masks.push_back({text, PixelMask::of_rectangle(info.width, info.height, rect)});
  }
  for (const std::string& file : options.masks) {
    masks.push_back({std::filesystem::path(file).stem().string(), image_mask(info, file)});
    if (masks.back().pixels.empty()) throw InputError(fmt::format("--mask {}: no pixel is above 0.5", file));
  }
  if (masks.empty()) throw InputError("--signature needs --object, --region or --mask");
  return masks;
}

/// The distance given, or the mean of the depths inside the mask.
double distance_of(const PlaceOptions& options, CubeReader& cube, const NamedMask& mask) {
  if (options.distance_m) return *options.distance_m;
  const CubeInfo& info = cube.info();
  if (std::find(info.aux.begin(), info.aux.end(), "depth") == info.aux.end())
    throw InputError(
        "intensities need the distance of the object: give --distance, or render with --aov depth");
  const auto depth = aux_plane(cube, "depth", "--signature");
  double sum = 0;
  std::size_t count = 0;
  for (uint32_t y = 0; y < info.height; ++y)
    for (uint32_t x = 0; x < info.width; ++x)
      if (const float d = depth[std::size_t{y} * info.width + x]; mask.pixels.at(x, y) && d > 0)
        sum += d, ++count;
  if (count == 0) throw InputError(fmt::format("{}: nothing is hit there: give --distance", mask.label));
  return sum / static_cast<double>(count);
}

/// The pixels whose mean is the background of a mask, none of which belongs to any mask.
std::optional<PixelMask> surroundings_of(const PlaceOptions& options, const CubeInfo& info,
                                         const PixelMask& mask, const PixelMask& all) {
  std::optional<PixelMask> around;
  if (options.background_ring) around = mask.grown(*options.background_ring).without(all);
  if (options.background_region) {
    const PixelRect rect = parse_rect("--background-region", *options.background_region);
    check_region(info, rect);
    around = PixelMask::of_rectangle(info.width, info.height, rect).without(all);
  }
  if (around && around->empty()) throw InputError("background: no pixel is left outside the masks");
  return around;
}

}  // namespace

std::vector<SignatureMask> signature_masks(const PlaceOptions& options, CubeReader& cube,
                                           const CameraGeometry& camera, const DiagnosticSink& sink) {
  if (camera.orthographic && options.distance_m)
    throw InputError("--distance: the camera is orthographic: intensities do not depend on it");
  if (options.distance_m && !(*options.distance_m > 0 && std::isfinite(*options.distance_m)))
    throw InputError(fmt::format("--distance {}: must be > 0 and finite", *options.distance_m));
  if (options.distance_m && *options.distance_m > 1e15)
    throw InputError(fmt::format("--distance {}: must be <= 1e+15 m", *options.distance_m));
  std::vector<NamedMask> masks = chosen_masks(options, cube, sink);
  std::vector<double> distances;
  for (NamedMask& mask : masks) {
    distances.push_back(camera.orthographic ? 1 : distance_of(options, cube, mask));
    mask.pixels = mask.pixels.grown(options.grow);
  }
  const CubeInfo& info = cube.info();
  PixelMask all(info.width, info.height);
  for (const NamedMask& mask : masks)
    for (uint32_t y = 0; y < info.height; ++y)
      for (uint32_t x = 0; x < info.width; ++x)
        if (mask.pixels.at(x, y)) all.insert(x, y);
  std::vector<SignatureMask> result;
  for (std::size_t m = 0; m < masks.size(); ++m)
    result.push_back({masks[m].label, masks[m].pixels, surroundings_of(options, info, masks[m].pixels, all),
                      distances[m]});
  return result;
}

}  // namespace kiloband
