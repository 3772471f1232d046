// Sensor responses applied to a cube after rendering.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cube/channel_cover.hpp"
#include "cube/cube_io.hpp"
#include "spectral/spectrum.hpp"

namespace kiloband {

using NamedResponse = std::pair<std::string, Spectrum>;

/// Integrals of colour matching functions times 683.002 lm/W: X, Y, Z in cd m^-2 (Y is the luminance).
std::vector<NamedResponse> xyz_responses();

/// Part of the integral of |response| that no channel covers, 0 to 1; overlaps count once.
double uncovered_part(const Spectrum& response, const ChannelCover& cover);

/// How a response sees a cube: the integral of response times radiance is the sum over channels of weight
/// times channel integral, where the weight is the mean of response / number of channels that cover the
/// wavelength. A response that changes inside a channel makes that an approximation: by however much the
/// radiance varies inside, the channel's part is off by at most `deviation` times its integral.
/// `cover` is that of the bands' channels.
struct SensorWeights {
  std::vector<double> weight;     // by band; 0 for derived bands
  std::vector<double> deviation;  // by band: largest |response - weight| inside
};
SensorWeights sensor_weights(const Spectrum& response, const std::vector<Band>& bands,
                             const ChannelCover& cover);

/// The cube with one derived band per response, in integrals over its channels, with the effective_band() of
/// the response as its interval. A band that the render has accumulated under a response's name (--response)
/// is taken as it is, with its variance; other bands have none (NaN).
/// throws InputError  a response that no channel covers, two of one name
std::unique_ptr<CubeReader> apply_responses(std::unique_ptr<CubeReader> cube,
                                            const std::vector<NamedResponse>& responses);

/// Reads the cube once and says what is uncertain: per response one warning if more than 1e-3 of its integral
/// lies outside the channels, one with the error of the image's mean that its changes inside channels can
/// cause, if that is more than 1e-3, and a note where the render's own band is taken.
void report_responses(CubeReader& cube, const std::vector<NamedResponse>& responses,
                      const DiagnosticSink& sink);

}  // namespace kiloband
