// Channels of 1e-3 nm at 10 um, a ten-millionth of the wavelength and next to what a float can tell
// apart, and of 1e4 nm.
#include <cmath>

#include "validation/suite/hard_cases/groups.hpp"
#include "validation/suite/hard_cases/trial.hpp"
#include "validation/suite/scene_text.hpp"

namespace kiloband::validation {
namespace {

using namespace scene_text;

const std::string kPrismView = orthographic(lookat("0, 0, 2", "0, 0, 0"), 1e-3, film(8), 1e-3);

struct Mode {
  WavelengthMode wavelengths;
  const char* name;
};
constexpr Mode kModes[] = {{WavelengthMode::kShared, "shared"}, {WavelengthMode::kPerPath, "per path"}};

/// A radiance that rises from 0 to 1 within the channel has the mean 1/2; one that rises within the second of
/// three channels of 1e-3 nm side by side is 0, 1/2, 1 there: a wavelength that is wrong by a channel's width
/// shows. Light of radiance a + b x on a reflectance of c + d x: the mean of the product,
/// a c + (a d + b c) / 2 + b d / 3.
std::vector<HardFigure> narrow_channels(const HardCaseContext& context) {
  Trial trial(context);
  for (const Mode& mode : kModes) {
    const TrialSettings settings{.bands = "10000-10000.001, 10000.001-10000.002, 10000.002-10000.003",
                                 .samples = static_cast<uint32_t>(trial.by_effort(16, 256, 4096)),
                                 .replicates = 32,
                                 .wavelengths = mode.wavelengths};
    const std::string within = "9999:0, 10000.001:0, 10000.002:1, 10001:1";
    const TrialImage seen = trial.render(
        scene_text::scene(1, kPrismView + emitter("constant", spectrum("radiance", within))), settings);
    const std::string name = std::string(", ") + mode.name;
    trial.statistical("radiance rising within 1e-3 nm" + name, seen, 1, 0.5, 1e-5);
    trial.figure("the channel before it" + name, "W m^-2 sr^-1 nm^-1", seen.image_mean[0] / 1e-3, 0, 1e-5,
                 "absolute");
    trial.exact("the channel behind it" + name, seen, 2, 1, 1e-5, "rounding");
    // The square sees half a sphere of the sky and reflects rho of it.
    const std::string ground =
        shape("rectangle", bsdf("conductor", spectrum("specular_reflectance",
                                                      "9999:0.2, 10000.001:0.2, 10000.002:0.8, 10001:0.8")));
    const TrialImage product = trial.render(
        scene_text::scene(2, kPrismView + ground + emitter("constant", spectrum("radiance", within))),
        settings);
    trial.statistical("radiance times reflectance" + name, product, 1, 0.2 / 2 + 0.6 / 3, 1e-5);
  }
  return trial.finish();
}

/// 10 to 20 um in one channel: a ramp from 0 to 1 (mean 1/2),
/// and Planck's law at 300 K against Simpson's rule.
std::vector<HardFigure> wide_channels(const HardCaseContext& context) {
  Trial trial(context);
  double planck = 0;
  constexpr int kSteps = 2000;
  for (int i = 0; i <= kSteps; ++i)
    planck += (i == 0 || i == kSteps ? 1
               : i % 2               ? 4
                                     : 2) *
              planck_per_nm(10000 + 1e4 * i / kSteps, 300) / (3.0 * kSteps);
  for (const Mode& mode : kModes) {
    const TrialSettings settings{.bands = "10000-20000",
                                 .samples = static_cast<uint32_t>(trial.by_effort(16, 256, 4096)),
                                 .replicates = 32,
                                 .wavelengths = mode.wavelengths};
    const std::string name = std::string(", ") + mode.name;
    const TrialImage seen = trial.render(
        scene_text::scene(1, kPrismView + emitter("constant", spectrum("radiance", "10000:0, 20000:1"))),
        settings);
    trial.statistical("ramp over 1e4 nm" + name, seen, 0, 0.5, 1e-5);
    const std::string law =
        "<spectrum name=\"radiance\" type=\"planck\">" + real("temperature", 300) + "</spectrum>";
    const TrialImage hot =
        trial.render(scene_text::scene(1, kPrismView + emitter("constant", law)), settings);
    trial.statistical("Planck's law over 1e4 nm" + name, hot, 0, planck, 1e-5);
  }
  return trial.finish();
}

}  // namespace

std::vector<HardCase> wavelength_cases() {
  return {{"channel_1e-3_nm", "spectra that change within a channel of 1e-3 nm at 10 um", narrow_channels},
          {"channel_1e4_nm", "channels of 1e4 nm", wide_channels}};
}

}  // namespace kiloband::validation
