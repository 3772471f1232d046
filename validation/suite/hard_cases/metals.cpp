// Metals without absorption, with an extinction of 100, and with an index next to 1.
//
// A smooth surface in an environment of radiance 1 shows its reflectance, without variance. In double,
// complex amplitudes from the boundary conditions (Born, Wolf, Principles of Optics, 1.5.2 and 14.2) with the
// index N = n - i k:
//   r_s = (cos - N cos') / (cos + N cos'), r_p = (N cos - cos') / (N cos + cos'), N sin' = sin;
//   R = (|r_s|^2 + |r_p|^2) / 2.
// In float, R is a ratio of sums of positive terms and of one difference of order n - 1 or cos: an absolute
// error of a few 6e-8 where R is of order 1, and of 6e-8 / R otherwise.
#include <cmath>
#include <complex>

#include "validation/suite/hard_cases/groups.hpp"
#include "validation/suite/hard_cases/trial.hpp"
#include "validation/suite/scene_text.hpp"

namespace kiloband::validation {
namespace {

using namespace scene_text;

double reflectance(double cosine, std::complex<double> index) {
  const std::complex<double> c = std::sqrt(1.0 - (1 - cosine * cosine) / (index * index));
  const std::complex<double> s = (cosine - index * c) / (cosine + index * c);
  const std::complex<double> p = (index * cosine - c) / (index * cosine + c);
  return 0.5 * (std::norm(s) + std::norm(p));
}

std::string metal_scene(double n, double k, double theta, const std::string& light) {
  const std::string plate = shape(
      "rectangle", to_world(scale(1e5, 1e5, 1)) + bsdf("conductor", spectrum("eta", n) + spectrum("k", k)));
  const std::string view = orthographic(
      lookat(point(-100 * std::sin(theta), 0, 100 * std::cos(theta)), "0, 0, 0"), 1e-3, film(4), 1e-4);
  return scene_text::scene(-1, view + plate + light);
}

std::vector<HardFigure> optical_constants(const HardCaseContext& context) {
  Trial trial(context);
  const TrialSettings settings{.samples = static_cast<uint32_t>(trial.by_effort(1, 16, 256))};
  for (const auto& [n, k] : {std::pair{1.5, 0.0},
                             {1.0, 0.0},
                             {1.0001, 0.0},
                             {0.05, 0.0},
                             {1.0, 100.0},
                             {100.0, 100.0},
                             {0.001, 100.0}}) {
    for (const double degrees : {0.0, 60.0, 89.99}) {
      const double theta = degrees * kPi / 180, expected = reflectance(std::cos(theta), {n, -k});
      const TrialImage image = trial.render(metal_scene(n, k, theta, sky(1)), settings);
      double worst = expected;
      for (const double value : image.mean)
        if (!(std::abs(value / 1e-3 - expected) <= std::abs(worst - expected))) worst = value / 1e-3;
      // cos(89.99 deg) = 1.7e-4 is known to 6e-8 through the direction: dR/dcos is 4 n or 4 / n at most.
      trial.figure("n " + short_text(n) + ", k " + short_text(k) + ", " + short_text(degrees) + " degrees",
                   "reflectance", worst, expected, 2e-6, "absolute, worst pixel");
    }
  }
  return trial.finish();
}

/// Kirchhoff: at one temperature a metal shows Planck's law whatever its constants, R B + (1 - R) B. The
/// emissivity is tabulated to the larger of 1e-4 absolute and 1e-3 of its value (docs/scene_format.md).
std::vector<HardFigure> hot_metals(const HardCaseContext& context) {
  Trial trial(context);
  const TrialSettings settings{.samples = static_cast<uint32_t>(trial.by_effort(16, 128, 1024)),
                               .replicates = 16};
  for (const auto& [n, k] : {std::pair{1.5, 0.0}, {1.0, 100.0}, {0.001, 100.0}}) {
    for (const double degrees : {0.0, 80.0}) {
      const double theta = degrees * kPi / 180;
      const TrialImage image = trial.render(metal_scene(n, k, theta, thermal(1000)), settings);
      trial.statistical(
          "n " + short_text(n) + ", k " + short_text(k) + ", " + short_text(degrees) + " degrees", image, 0,
          planck_per_nm(10000.0005, 1000), 1e-4);
    }
  }
  return trial.finish();
}

}  // namespace

std::vector<HardCase> metal_cases() {
  return {{"metals", "reflectance of conductors with k = 0, k = 100 and n next to 1", optical_constants},
          {"hot_metals", "their emission in an isothermal scene", hot_metals}};
}

}  // namespace kiloband::validation
