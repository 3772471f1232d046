// <texture type="bitmap"> and <texture type="checkerboard">.
#include <algorithm>
#include <span>

#include "scene/read/context.hpp"
#include "scene/read/object/limits.hpp"
#include "scene/xml/values.hpp"
#include "spectral/files/value_scale.hpp"

namespace kiloband {
namespace {

/// filter_type. Those of old files that look at the footprint of a ray blur less than a pixel's samples do.
bool read_nearest(ReadContext& context, const ObjectReader& object) {
  if (!object.node().legacy) return object.get_choice("filter_type", {"bilinear", "nearest"}) == 1;
  const std::size_t type = object.get_choice("filter_type", {"bilinear", "nearest", "trilinear", "ewa"});
  if (type > 1)
    note(context.sink, object.value_place("filter_type").position(),
         object.label() + ": read as filter_type bilinear: pixels are averaged from their samples");
  accept_obsolete(context, object, {"max_anisotropy", "cache"});
  return type == 1;
}

Texture read_bitmap(ReadContext& context, const ObjectReader& object) {
  auto bitmap = std::make_shared<BitmapTexture>();
  bitmap->id = object.node().id;
  bitmap->position = object.node().place.position();
  bitmap->file = context.file(object, "filename");
  bitmap->raw = object.get_bool("raw", false);
  bitmap->nearest = read_nearest(context, object);
  constexpr WrapMode kModes[] = {WrapMode::kRepeat, WrapMode::kMirror, WrapMode::kClamp};
  bitmap->wrap = kModes[object.get_choice("wrap_mode", {"repeat", "mirror", "clamp"})];
  bitmap->to_uv = object.get_uv_transform("to_uv", context.sink);
  object.get_choice("format", {"auto", "variant", "fp16"});  // how Mitsuba stores it: no meaning here
  object.get_bool("accel", true);
  object.finish();
  bitmap->image = context.image(bitmap->file, bitmap->raw, object.value_place("filename"));
  return std::shared_ptr<const BitmapTexture>(std::move(bitmap));
}

/// Numbers and rgb are in [0, 1], as in Mitsuba. A spectrum may be larger, on a lamp: check_reflectance_texture() has the rest.
Spectrum read_board_colour(ReadContext& context, const ObjectReader& object, std::string_view name,
                           const Spectrum& fallback) {
  Node* node = object.find(name);
  const bool spectrum = node && node->resolved().tag == "spectrum" && node->resolved().type != "srgb";
  return read_spectrum(context, object, name, spectrum ? SpectrumUse::kQuantity : SpectrumUse::kReflectance,
                       fallback);
}

Texture read_checkerboard(ReadContext& context, const ObjectReader& object) {
  auto board = std::make_shared<CheckerboardTexture>();
  board->id = object.node().id;
  board->position = object.node().place.position();
  board->color0 = read_board_colour(context, object, "color0", board->color0);
  board->color1 = read_board_colour(context, object, "color1", board->color1);
  board->to_uv = object.get_uv_transform("to_uv", context.sink);
  object.finish();
  return std::shared_ptr<const CheckerboardTexture>(std::move(board));
}

Texture read_mesh_attribute(const ObjectReader& object) {
  auto attribute = std::make_shared<MeshAttributeTexture>();
  attribute->id = object.node().id;
  attribute->position = object.node().place.position();
  attribute->name = object.require_string("name");
  if (!attribute->name.starts_with("vertex_") && !attribute->name.starts_with("face_"))
    object.fail_at("name", "name '" + attribute->name + "': must begin with vertex_ or face_");
  attribute->scale = object.get_float("scale", 1);
  object.check(attribute->scale >= 0, "scale", attribute->scale, "must be >= 0");
  check_at_most(object, "scale", attribute->scale, kMaxQuantity);
  object.finish();
  return std::shared_ptr<const MeshAttributeTexture>(std::move(attribute));
}

}  // namespace

Texture read_texture_object(ReadContext& context, Node& node) {
  const auto known = context.textures.find(&node);
  if (known != context.textures.end()) return known->second;
  const ObjectReader object(node);
  Texture texture = node.type == "bitmap"            ? read_bitmap(context, object)
                    : node.type == "spectral_bitmap" ? read_spectral_bitmap(context, object)
                    : node.type == "mesh_attribute"  ? read_mesh_attribute(object)
                                                     : read_checkerboard(context, object);
  context.textures.emplace(&node, texture);
  return texture;
}

std::shared_ptr<const BitmapTexture> number_board(const Texture& texture) {
  const auto* board = std::get_if<std::shared_ptr<const CheckerboardTexture>>(&texture);
  if (!board || !(*board)->color0.is_constant() || !(*board)->color1.is_constant()) return nullptr;
  const auto value0 = static_cast<float>((*board)->color0(550)),
             value1 = static_cast<float>((*board)->color1(550));
  auto bitmap = std::make_shared<BitmapTexture>();
  bitmap->id = (*board)->id;
  bitmap->position = (*board)->position;
  bitmap->file = "checkerboard";
  bitmap->image = std::make_shared<const Image>(Image{2, 2, 1, {value1, value0, value0, value1}});
  bitmap->nearest = bitmap->raw = true;
  bitmap->to_uv = (*board)->to_uv;
  return bitmap;
}

namespace {

/// "label 1e+20 at pixel (1, 2) of 'sky.exr': must be <= ...": the first value that is too large.
void check_pixels(std::span<const float> values, std::size_t values_per_pixel, uint32_t width, double scale,
                  const std::string& file, const std::string& label, const Place& place) {
  const auto found = std::ranges::find_if(values, [&](float v) { return v * scale > kMaxEmission; });
  if (found == values.end()) return;
  const std::size_t pixel = static_cast<std::size_t>(found - values.begin()) / values_per_pixel;
  fail(place, label + " " + format_number(*found * scale) + " at pixel (" + std::to_string(pixel % width) +
                  ", " + std::to_string(pixel / width) + ") of '" + file +
                  "': " + at_most(kMaxEmission, unit_of(ValueKind::kRadiance)));
}

}  // namespace

void check_emission_image(const Image& image, const std::filesystem::path& file, double scale,
                          const std::string& label, const Place& place) {
  check_pixels(image.pixels, image.channels, image.width, scale, file.filename().string(), label, place);
}

void check_emission_image(const SpectralImage& image, double scale, const std::string& label,
                          const Place& place) {
  check_pixels(*image.values, image.values_per_pixel, image.width, scale, image.file.filename().string(),
               label, place);
}

void check_emission_texture(const Texture& texture, const std::string& label, const Place& place) {
  if (const auto* bitmap = std::get_if<std::shared_ptr<const BitmapTexture>>(&texture))
    check_emission_image(*(*bitmap)->image, (*bitmap)->file, 1, label, place);
  if (const auto* board = std::get_if<std::shared_ptr<const CheckerboardTexture>>(&texture)) {
    check_spectrum((*board)->color0, label + ": color0", SpectrumUse::kEmission, place);
    check_spectrum((*board)->color1, label + ": color1", SpectrumUse::kEmission, place);
  }
  const auto* spectral = std::get_if<std::shared_ptr<const SpectralBitmapTexture>>(&texture);
  if (!spectral) return;
  double largest = 1;  // of the endmembers, if the values are weights
  for (const Spectrum& endmember : (*spectral)->endmembers)
    largest = std::max(largest, endmember.max_over(1, 1e9));
  check_emission_image(*(*spectral)->image, largest, label, place);
}

void check_reflectance_texture(const Texture& texture, const std::string& label, const Place& place) {
  if (const auto* board = std::get_if<std::shared_ptr<const CheckerboardTexture>>(&texture)) {
    for (const auto& [name, color] :
         {std::pair{": color0", &(*board)->color0}, {": color1", &(*board)->color1}}) {
      if (color->planck_parameters())
        fail(place, label + name + " describes emission: not allowed in a reflectance");
      check_spectrum(*color, label + name, SpectrumUse::kReflectance, place);
    }
  }
  if (const auto* spectral = std::get_if<std::shared_ptr<const SpectralBitmapTexture>>(&texture))
    check_spectral_reflectance(**spectral, label, place);
  const auto* bitmap = std::get_if<std::shared_ptr<const BitmapTexture>>(&texture);
  if (!bitmap) return;
  const Image& image = *(*bitmap)->image;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (image.pixels[i] <= 1) continue;
    const std::size_t pixel = i / image.channels;
    fail(place, label + " " + format_number(static_cast<double>(image.pixels[i])) + " at pixel (" +
                    std::to_string(pixel % image.width) + ", " + std::to_string(pixel / image.width) +
                    ") of '" + (*bitmap)->file.filename().string() + "': must be in [0, 1]");
  }
}

}  // namespace kiloband
