// <emitter type=...>
#include <cmath>
#include <numbers>

#include "scene/read/context.hpp"
#include "scene/read/object/limits.hpp"
#include "scene/read/sunsky.hpp"
#include "scene/xml/values.hpp"
#include "spectral/colour/colour.hpp"

namespace kiloband {
namespace {

using EmitterModel = decltype(Emitter::model);

/// Mitsuba's default for an absent radiance or intensity of 1.
Spectrum default_emission() {
  return illuminant_d65();
}

Spectrum emission(ReadContext& context, const ObjectReader& object, std::string_view name, SpectrumUse use) {
  return read_spectrum(context, object, name, use, default_emission());
}

EmitterModel read_constant(ReadContext& context, const ObjectReader& object) {
  return ConstantEmitter{emission(context, object, "radiance", SpectrumUse::kEmission)};
}

void check_map_size(const ObjectReader& object, const std::filesystem::path& file, uint32_t width,
                    uint32_t height) {
  if (width >= 2 && height >= 2) return;
  object.fail_at("filename", "an environment map needs at least 2 x 2 pixels, '" + file.filename().string() +
                                 "' has " + std::to_string(width) + " x " + std::to_string(height));
}

EmitterModel read_envmap(ReadContext& context, const ObjectReader& object) {
  EnvmapEmitter envmap;
  envmap.file = context.file(object, "filename");
  envmap.scale = object.get_float("scale", 1);
  object.check(envmap.scale >= 0, "scale", envmap.scale, "must be >= 0");
  check_at_most(object, "scale", envmap.scale, kMaxQuantity);
  envmap.to_world = rotation_and_position(object);
  object.get_bool("mis_compensation", false);  // only concerns the noise of Mitsuba's sampling
  const Place place = object.value_place("filename");
  envmap.image = context.image(envmap.file, false, place);
  check_map_size(object, envmap.file, envmap.image->width, envmap.image->height);
  check_emission_image(*envmap.image, envmap.file, envmap.scale, object.label() + ": scale times", place);
  return envmap;
}

EmitterModel read_spectral_envmap(ReadContext& context, const ObjectReader& object) {
  SpectralEnvmapEmitter envmap;
  const std::filesystem::path file = context.file(object, "filename");
  envmap.scale = object.get_float("scale", 1);
  object.check(envmap.scale >= 0, "scale", envmap.scale, "must be >= 0");
  check_at_most(object, "scale", envmap.scale, kMaxQuantity);
  envmap.to_world = rotation_and_position(object);
  envmap.image = context.spectral_image(file, false, object.value_place("filename"));
  check_map_size(object, file, envmap.image->width, envmap.image->height);
  check_emission_image(*envmap.image, envmap.scale, object.label() + ": scale times",
                       object.value_place("filename"));
  return envmap;
}

EmitterModel read_point(ReadContext& context, const ObjectReader& object) {
  PointEmitter point;
  point.intensity = emission(context, object, "intensity", SpectrumUse::kIntensity);
  if (object.has("position") && object.has("to_world")) {
    object.fail_at("to_world", "'position' together with 'to_world'");
  }
  point.position = object.has("position") ? object.get_vector("position", {})
                                          : glm::dvec3(object.get_transform("to_world")[3]);
  return point;
}

/// The picture of a spot, which must be one, as in Mitsuba.
/// Values of a mesh, which lights that are no shapes do not have.
bool is_attribute(const Texture& texture) {
  return std::holds_alternative<std::shared_ptr<const MeshAttributeTexture>>(texture);
}

std::optional<Texture> read_spot_texture(ReadContext& context, const ObjectReader& object, double cutoff) {
  if (!object.has("texture")) return {};
  Node& node = object.find("texture")->resolved();
  const bool spectral = node.type == "spectral_bitmap";
  Texture texture = read_texture(context, object, "texture",
                                 spectral ? SpectrumUse::kIntensity : SpectrumUse::kReflectance, Spectrum());
  if (std::holds_alternative<Spectrum>(texture) || is_attribute(texture))
    object.fail_at("texture", "texture: must be a bitmap, checkerboard or spectral_bitmap");
  if (spectral && object.has("intensity"))
    object.fail_at("intensity", "'intensity' together with a spectral_bitmap, which is the intensity itself");
  object.check(cutoff < 90, "cutoff_angle", cutoff, "must be below 90 degrees with a texture");
  return texture;
}

EmitterModel read_spot(ReadContext& context, const ObjectReader& object) {
  SpotEmitter spot;
  spot.intensity = emission(context, object, "intensity", SpectrumUse::kIntensity);
  const double cutoff = object.get_float("cutoff_angle", 20);
  object.check(cutoff > 0 && cutoff < 180, "cutoff_angle", cutoff, "must be between 0 and 180 degrees");
  const double beam = object.get_float("beam_width", 0.75 * cutoff);
  object.check(beam >= 0 && beam <= cutoff, "beam_width", beam, "must be from 0 to cutoff_angle");
  spot.cutoff_angle = cutoff * std::numbers::pi / 180;
  spot.beam_width = beam * std::numbers::pi / 180;
  spot.texture = read_spot_texture(context, object, cutoff);
  spot.to_world = rotation_and_position(object);
  return spot;
}

/// Width over height of what is projected; 1 of what has no pixels.
double aspect_of(const Texture& texture) {
  if (const auto* bitmap = std::get_if<std::shared_ptr<const BitmapTexture>>(&texture))
    return static_cast<double>((*bitmap)->image->width) / (*bitmap)->image->height;
  if (const auto* spectral = std::get_if<std::shared_ptr<const SpectralBitmapTexture>>(&texture))
    return static_cast<double>((*spectral)->image->width) / (*spectral)->image->height;
  return 1;
}

EmitterModel read_projector(ReadContext& context, const ObjectReader& object) {
  ProjectorEmitter projector;
  if (!object.has("irradiance")) object.fail_here("parameter 'irradiance' is missing");
  projector.irradiance = read_texture(context, object, "irradiance", SpectrumUse::kIrradiance, Spectrum());
  if (is_attribute(projector.irradiance))
    object.fail_at("irradiance", "irradiance: must be a spectrum, bitmap, checkerboard or spectral_bitmap");
  projector.d65 = object.find("irradiance")->resolved().type == "d65";
  projector.scale = object.get_float("scale", 1);
  object.check(projector.scale >= 0, "scale", projector.scale, "must be >= 0");
  check_at_most(object, "scale", projector.scale, kMaxQuantity);
  const double aspect = aspect_of(projector.irradiance);
  projector.tan_half_x = std::tan(0.5 * read_fov(object, aspect));
  projector.tan_half_y = projector.tan_half_x / aspect;
  projector.to_world = rotation_and_position(object);
  return projector;
}

EmitterModel read_directional(ReadContext& context, const ObjectReader& object) {
  DirectionalEmitter directional;
  directional.irradiance = emission(context, object, "irradiance", SpectrumUse::kIrradiance);
  if (object.has("direction") && object.has("to_world")) {
    object.fail_at("to_world", "'direction' together with 'to_world'");
  }
  const glm::dvec3 direction = object.has("direction") ? object.get_vector("direction", {})
                                                       : glm::dvec3(object.get_transform("to_world")[2]);
  const glm::dvec3 unit = unit_vector(direction);
  if (unit == glm::dvec3(0)) object.fail_at("direction", "direction: its length must be > 0");
  directional.direction = unit;
  const double radius = object.get_float("angular_radius", 0);
  object.check(radius == 0 || (radius >= kMinSunRadius && radius <= kMaxSunRadius), "angular_radius", radius,
               "must be 0, or from 0.001 to 90 degrees");
  directional.angular_radius = radius * std::numbers::pi / 180;
  return directional;
}

struct EmitterType {
  std::string_view name;
  EmitterModel (*read)(ReadContext&, const ObjectReader&);
};

constexpr EmitterType kEmitterTypes[] = {{"constant", read_constant},
                                         {"envmap", read_envmap},
                                         {"spectral_envmap", read_spectral_envmap},
                                         {"point", read_point},
                                         {"spot", read_spot},
                                         {"projector", read_projector},
                                         {"directional", read_directional}};

/// They may be two emitters; `sun` and `sky` are of old files.
bool is_sunsky(const Node& node) {
  return node.type == "sunsky" || (node.legacy && (node.type == "sun" || node.type == "sky"));
}

[[noreturn]] void refuse(const ObjectReader& object) {
  object.refuse_type({"area", "thermal", "constant", "envmap", "spectral_envmap", "point", "spot",
                      "projector", "directional", "sunsky"});
}

}  // namespace

Transform rotation_and_position(const ObjectReader& object) {
  Transform to_world = object.get_transform("to_world");
  if (!is_similarity(glm::dmat3(to_world))) {
    object.fail_at("to_world", "to_world must only rotate, move, mirror and scale uniformly");
  }
  // Its size means nothing here, but its square would have to fit into single precision.
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(glm::length(glm::dvec3(to_world[axis])) - 1) > 1e-6)
      to_world[axis] = glm::dvec4(unit_vector(glm::dvec3(to_world[axis])), 0);
  return to_world;
}

/// Mitsuba's weight for choosing lights. Ours are chosen by what they emit: only the noise differs.
void accept_sampling_weight(const ReadContext& context, const ObjectReader& object) {
  if (!object.has("sampling_weight")) return;
  const double weight = object.get_float("sampling_weight", 1);
  object.check(weight > 0, "sampling_weight", weight, "must be > 0");
  if (weight != 1) {
    note(context.sink, object.value_place("sampling_weight").position(),
         object.label() + ": 'sampling_weight' has no meaning here: lights are chosen by their power");
  }
}

AreaEmitter read_area_emitter(ReadContext& context, Node& node) {
  const ObjectReader object(node);
  for (const EmitterType& type : kEmitterTypes) {
    if (node.type == type.name)
      fail(node.type_place, object.label() + ": only area and thermal emitters can be part of a shape");
  }
  if (is_sunsky(node))
    fail(node.type_place, object.label() + ": only area and thermal emitters can be part of a shape");
  if (node.type != "area") refuse(object);
  if (object.has("to_world")) object.fail_at("to_world", "an area emitter has no transform of its own");
  accept_sampling_weight(context, object);
  AreaEmitter emitter{read_texture(context, object, "radiance", SpectrumUse::kEmission, default_emission())};
  object.finish();
  return emitter;
}

std::vector<Emitter> read_emitters(ReadContext& context, Node& node) {
  const ObjectReader object(node);
  if (is_sunsky(node)) {
    accept_sampling_weight(context, object);
    std::vector<Emitter> emitters = read_sunsky(context, object);
    object.finish();
    return emitters;
  }
  for (const EmitterType& type : kEmitterTypes) {
    if (node.type != type.name) continue;
    accept_sampling_weight(context, object);
    Emitter emitter{node.id, node.place.position(), type.read(context, object)};
    object.finish();
    return {std::move(emitter)};
  }
  refuse(object);
}

}  // namespace kiloband
