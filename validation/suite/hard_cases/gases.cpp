// Gas of optical depth x from 1e-8 to 1e4: a column of 1 m at temperature T in front of a wall
// of radiance L0 shows
//   L = L0 exp(-x) + B(T) (1 - exp(-x)),
// without variance. Relative to each term: 1 - exp(-x) must keep its accuracy where exp(-x) is 1 in float.
#include <cmath>

#include "src_cpu/geometry/embree_scene.hpp"
#include "validation/suite/hard_cases/groups.hpp"
#include "validation/suite/hard_cases/trial.hpp"
#include "validation/suite/scene_text.hpp"

namespace kiloband::validation {
namespace {

using namespace scene_text;

/// Relative, of the length of a column: the CPU's (other devices divide, which is off by a rounding or two).
constexpr double kColumn = cpu::kEmbreeDistanceError;

std::string column(double depth, double kelvin) {
  const std::string gas = "<medium type=\"absorbing\" name=\"interior\">" + spectrum("absorption", depth) +
                          (kelvin > 0 ? real("temperature", kelvin) : "") + "</medium>";
  return shape("cube", to_world(scale(1, 1, 0.5) + translate(0, 0, 1)) + bsdf("null") + gas);
}

std::vector<HardFigure> optical_depths(const HardCaseContext& context) {
  Trial trial(context);
  const std::string view = orthographic(lookat("0, 0, 2", "0, 0, 0"), 0.5, film(8), 1e-3);
  const double planck = planck_per_nm(10000.0005, 1000);
  for (const auto mode : {WavelengthMode::kShared, WavelengthMode::kPerPath}) {
    const TrialSettings settings{.samples = static_cast<uint32_t>(trial.by_effort(2, 16, 128)),
                                 .wavelengths = mode};
    const std::string name = mode == WavelengthMode::kShared ? ", shared" : ", per path";
    for (const double depth : {1e-8, 1e-4, 1.0, 80.0, 1e4}) {
      const std::string wall = shape("rectangle", diffuse(0));
      const TrialImage glow = trial.render(scene_text::scene(2, view + wall + column(depth, 1000)), settings);
      trial.exact("emission at depth " + short_text(depth) + name, glow, 0, -std::expm1(-depth) * planck,
                  3e-6, "a few roundings, and Planck's law as float");
      const std::string light = shape("rectangle", diffuse(0) + lamp(1));
      const TrialImage dim = trial.render(scene_text::scene(2, view + light + column(depth, 0)), settings);
      // exp(-x) of an x whose factor, the length, is off by kColumn and which is rounded; below 1e-38 floats hold nothing.
      if (depth < 100)
        trial.exact("transmission at depth " + short_text(depth) + name, dim, 0, std::exp(-depth),
                    1e-6 + (kColumn + 0x1p-24) * depth, "the error of x times x");
      else
        trial.figure("transmission at depth " + short_text(depth) + name, "W m^-2 sr^-1 nm^-1",
                     dim.image_mean[0] / 1e-3, 0, 0, "absolute: exp(-1e4) is 0 in float");
    }
  }
  return trial.finish();
}

}  // namespace

std::vector<HardCase> gas_cases() {
  return {{"gas_depth", "gas of optical depth 1e-8 to 1e4", optical_depths}};
}

}  // namespace kiloband::validation
