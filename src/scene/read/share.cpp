// Opacities and weights: one number for all wavelengths.
#include <span>
#include <string>

#include "base/text.hpp"
#include "scene/read/context.hpp"
#include "spectral/colour/colour.hpp"

namespace kiloband {
namespace {

/// Of a surface of this reflectance under D65, divided by that of a white one.
double relative_luminance(const Spectrum& reflectance) {
  static const Spectrum kWeight = Spectrum::product(illuminant_d65(), cie_y());
  static const double kWhite = kWeight.integral(kCieMinNm, kCieMaxNm);
  return Spectrum::product(reflectance, kWeight).integral(kCieMinNm, kCieMaxNm) / kWhite;
}

/// Of a colour its luminance, as of pictures; of a table the mean over its own range, so that neither the channels
/// of an image nor its guide bands change what is where.
Spectrum one_number(ReadContext& context, const Spectrum& spectrum, const std::string& label,
                    const SourcePosition& position) {
  if (spectrum.is_constant()) return spectrum;
  const std::span<const double> knots = spectrum.knots_nm();
  const double number = knots.empty()       ? relative_luminance(spectrum)
                        : knots.size() == 1 ? spectrum(knots.front())
                                            : spectrum.mean(knots.front(), knots.back());
  warn(context.sink, position,
       label + ": one number for all wavelengths: " +
           (knots.empty() ? "its luminance, " : "the mean of its data, ") +
           format_number(static_cast<float>(number)) + ", is taken");
  return Spectrum::constant(number);
}

}  // namespace

Texture read_share(ReadContext& context, const ObjectReader& object, const std::string& name,
                   const Texture& fallback) {
  Node* node = object.find(name);
  const std::string label = object.label() + ": " + name;
  Texture share = node ? read_texture_node(context, *node, label, SpectrumUse::kReflectance) : fallback;
  if (auto board = number_board(share)) return board;
  if (std::holds_alternative<std::shared_ptr<const CheckerboardTexture>>(share))
    object.fail_at(name, name + ": a checkerboard must have two numbers here");
  if (std::holds_alternative<std::shared_ptr<const SpectralBitmapTexture>>(share))
    object.fail_at(name, name + ": a spectral_bitmap is not supported here");
  if (const auto* spectrum = std::get_if<Spectrum>(&share))
    return one_number(context, *spectrum, label, object.value_place(name).position());
  return share;
}

}  // namespace kiloband
