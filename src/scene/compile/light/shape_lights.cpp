// Shapes that are lights: by an emitter, or by their temperature.
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "scene/compile/light/emitters.hpp"
#include "scene/compile/record_vectors.hpp"
#include "spectral/colour/colour.hpp"
#include "spectral/planck.hpp"

namespace kiloband {

EmitterCompiler::Power EmitterCompiler::scaled_power(const WeightedSpectra& colour, double factor) {
  Power power{colour.front().first, factor * colour.front().second, {}};
  for (std::size_t i = 1; i < colour.size(); ++i)
    power.more.emplace_back(colour[i].first, factor * colour[i].second);
  return power;
}

double EmitterCompiler::band_power(const Power& power, const Channel& band) {
  double sum = power.factor * power.spectrum.integral(band.min_nm, band.max_nm);
  for (const auto& [spectrum, factor] : power.more)
    sum += factor * spectrum.integral(band.min_nm, band.max_nm);
  return std::max(0.0, sum);
}

void EmitterCompiler::add_area_emitter(const Shape& shape) {
  const auto shape_index = static_cast<uint32_t>(out_.shapes.size() - 1);
  const std::string name = fmt::format("emitter of {}", out_.shape_names[shape_index]);
  KbEmitter record{};
  record.type = KB_EMITTER_AREA;
  record.shape = shape_index;
  record.ref =
      textures_.reference(shape.emitter->radiance, {name + ": radiance", shape.emitter_position, true});
  set_transforms(record, Transform{1.0});
  out_.shapes[shape_index].emitter = static_cast<uint32_t>(out_.emitters.size());
  add(record, out_.shape_names[shape_index]);
  out_.features.area_light = true;

  const double factor = std::numbers::pi * out_.shapes[shape_index].area;
  if (std::holds_alternative<std::shared_ptr<const SpectralBitmapTexture>>(shape.emitter->radiance)) {
    powers_.push_back(scaled_power(textures_.colour_of(record.ref & KB_REF_INDEX_MASK), factor));
    return;
  }
  Spectrum colour = illuminant_d65();
  double mean = 1;
  if (std::holds_alternative<std::shared_ptr<const MeshAttributeTexture>>(shape.emitter->radiance)) {
    colour = Spectrum::constant(1);
    mean = textures_.mean_of(record.ref & KB_REF_INDEX_MASK);
  }
  if (const auto* spectrum = std::get_if<Spectrum>(&shape.emitter->radiance)) {
    colour = *spectrum;
  } else if (const auto* image =
                 std::get_if<std::shared_ptr<const BitmapTexture>>(&shape.emitter->radiance)) {
    if ((*image)->raw) colour = Spectrum::constant(1);
    mean = textures_.mean_of(record.ref & KB_REF_INDEX_MASK);
  }
  powers_.push_back({colour, mean * factor});
}

void EmitterCompiler::add_thermal_emitter(const Heat& heat) {
  const auto shape_index = static_cast<uint32_t>(out_.shapes.size() - 1);
  KbShape& shape = out_.shapes[shape_index];
  const KbSurface& surface = out_.surfaces[shape.surface];
  if (!thermal_.emits(surface)) return;
  KbEmitter record{};
  record.type = KB_EMITTER_THERMAL;
  record.ref = KB_NONE;
  record.shape = shape_index;
  store_transform(Transform{1.0}, record.to_world);
  store_transform(Transform{1.0}, record.to_object);
  shape.flags |= KB_SHAPE_LIT_BOTH_SIDES;
  shape.emitter = static_cast<uint32_t>(out_.emitters.size());
  add(record, out_.shape_names[shape_index]);
  out_.features.area_light = true;
  const double temperature_k = heat.field == KB_NONE ? heat.temperature_k : heat.mean_k;
  Power power{Spectrum(), 0};
  for (const Channel& band : out_.guide) {
    const double emissivity = thermal_.side_estimate(surface, true, band.centre_nm()) +
                              thermal_.side_estimate(surface, false, band.centre_nm());
    power.by_band.push_back(emissivity * std::numbers::pi * shape.area *
                            planck_integral(band.min_nm, band.max_nm, temperature_k));
  }
  powers_.push_back(power);
}

}  // namespace kiloband
