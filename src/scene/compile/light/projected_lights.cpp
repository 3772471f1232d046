// Pictures that spots and projectors throw: a texture times a spectrum, and where its borders are.
#include <algorithm>
#include <numbers>

#include "scene/compile/light/emitters.hpp"
#include "scene/compile/place.hpp"
#include "scene/compile/record_vectors.hpp"
#include "spectral/colour/colour.hpp"

namespace kiloband {
namespace {

/// World to coordinates whose x and y over z are from -1 to 1 inside the picture.
void set_picture_frame(KbEmitter& record, const Transform& to_world, double tan_x, double tan_y) {
  Transform to_picture = glm::inverse(to_world);
  for (int column = 0; column < 4; ++column) {
    to_picture[column][0] /= tan_x;
    to_picture[column][1] /= tan_y;
  }
  store_transform(to_picture, record.to_object);
}

}  // namespace

/// A bitmap's texels are those of a reflectance, or above 1; the record of the texture is its own, since it names the spectrum that
/// they are multiplied by.
uint32_t EmitterCompiler::bitmap_picture(const std::shared_ptr<const BitmapTexture>& texture,
                                         const Spectrum& light, double factor, const SpectrumSource& use) {
  const uint32_t index = textures_.bitmap(texture, BitmapUse::kPicture);
  KbTexture record = out_.textures[index];
  record.illuminant_row = spectra_.row(light, use);
  double& peak = textures_.peaks().row_factors.try_emplace(record.illuminant_row, 1.0).first->second;
  peak = std::max(peak, textures_.bound_of(index));
  powers_.push_back({light, textures_.mean_of(index) * factor});
  return KB_REF_BITMAP | textures_.add_record(record, textures_.mean_of(index), textures_.bound_of(index));
}

uint32_t EmitterCompiler::checkerboard_picture(const CheckerboardTexture& texture, const Spectrum& light,
                                               double factor, const SpectrumSource& use) {
  out_.features.checkerboard = true;
  const Spectrum colours[2] = {Spectrum::product(light, texture.color0),
                               Spectrum::product(light, texture.color1)};
  KbCheckerboard record{};
  record.ref0 = spectra_.row(colours[0], {use.name + " color0", texture.position, true});
  record.ref1 = spectra_.row(colours[1], {use.name + " color1", texture.position, true});
  store_uv_transform(texture.to_uv, record.to_uv);
  out_.checkerboards.push_back(record);
  powers_.push_back(scaled_power({{colours[0], 0.5}, {colours[1], 0.5}}, factor));
  return KB_REF_CHECKERBOARD | static_cast<uint32_t>(out_.checkerboards.size() - 1);
}

uint32_t EmitterCompiler::picture(const Texture& texture, const Spectrum& light, double factor,
                                  const SpectrumSource& use) {
  out_.features.projected_light = true;
  if (const auto* spectrum = std::get_if<Spectrum>(&texture)) {
    powers_.push_back({*spectrum, factor});
    return KB_REF_SPECTRUM | spectra_.row(*spectrum, use);
  }
  if (const auto* image = std::get_if<std::shared_ptr<const BitmapTexture>>(&texture))
    return bitmap_picture(*image, light, factor, use);
  if (const auto* board = std::get_if<std::shared_ptr<const CheckerboardTexture>>(&texture))
    return checkerboard_picture(**board, light, factor, use);
  const uint32_t index =
      textures_.spectral_bitmap(std::get<std::shared_ptr<const SpectralBitmapTexture>>(texture), use);
  powers_.push_back(scaled_power(textures_.colour_of(index), factor));
  return KB_REF_BITMAP | index;
}

/// The picture lies over the square around the cone's cross section, u along +X and v along +Y, both from 0 to 1 (Mitsuba 3.9.1: of an
/// image the first row is at -Y).
void EmitterCompiler::add_spot_picture(KbEmitter& record, const SpotEmitter& spot, double solid_angle,
                                       const SpectrumSource& use) {
  record.ref = picture(*spot.texture, spot.intensity, solid_angle, use);
  const double edge = std::tan(spot.cutoff_angle);
  set_picture_frame(record, placed_at(out_.origin, spot.to_world), edge, edge);
}

/// The picture is what a camera at this place would see of it: u along -X (right in the image), v along -Y (down). A plane across the
/// axis at distance 1 gets E = pi scale times the picture (Mitsuba 3.9.1, measured: 1.000 with pi). Its flux is
/// E over the picture's area 4 tan_x tan_y.
void EmitterCompiler::add_projector(KbEmitter& record, const ProjectorEmitter& projector,
                                    const SpectrumSource& use) {
  const double plane = std::numbers::pi * projector.scale;
  record.type = KB_EMITTER_PROJECTOR;
  record.scale = static_cast<float>(plane);
  set_transforms(record, placed_at(out_.origin, projector.to_world));
  set_picture_frame(record, placed_at(out_.origin, projector.to_world), -projector.tan_half_x,
                    -projector.tan_half_y);
  const double factor = plane * 4 * projector.tan_half_x * projector.tan_half_y;
  const Spectrum light = projector.d65 ? illuminant_d65() : Spectrum::constant(1);
  record.ref = picture(projector.irradiance, light, factor, use);
}

}  // namespace kiloband
