// Smooth glass at its limits: total internal reflection, nested bodies,
// and rough glass and mirrors of roughness 1e-4.
#include <cmath>
#include <complex>

#include "validation/suite/hard_cases/groups.hpp"
#include "validation/suite/hard_cases/trial.hpp"
#include "validation/suite/scene_text.hpp"

namespace kiloband::validation {
namespace {

using namespace scene_text;

constexpr double kIndex = 1.5;

std::string glass(double inside, double outside, const std::string& type = "dielectric",
                  const std::string& more = "") {
  return bsdf(type, real("int_ior", inside) + real("ext_ior", outside) + more);
}

/// Unpolarised Fresnel reflectance towards the relative index eta; 1 beyond the critical angle.
double reflectance(double cosine, double eta) {
  const double sin2 = (1 - cosine * cosine) / (eta * eta);
  if (sin2 >= 1) return 1;
  const double c = std::sqrt(1 - sin2);
  const double s = (cosine - eta * c) / (cosine + eta * c), p = (eta * cosine - c) / (eta * cosine + c);
  return 0.5 * (s * s + p * p);
}

/// From inside glass (z < 0) towards its surface z = 0 under theta, everywhere an environment of radiance 1.
/// What is reflected shows 1; what comes in from outside is brighter by n^2:
///   L = R + (1 - R) n^2, and 1 beyond the critical angle asin(1 / n): there without variance.
/// Near the critical angle R(theta) is a square root: a cosine that is 6e-8 off moves R by up to
/// 4 n sqrt(2 * 6e-8 ...), so that the angles here stay 1e-5 rad away from it.
std::vector<HardFigure> total_reflection(const HardCaseContext& context) {
  Trial trial(context);
  const double critical = std::asin(1 / kIndex);
  const std::string surface = shape("rectangle", to_world(scale(10, 10, 1)) + glass(kIndex, 1.0));
  const auto scene = [&](double theta) {
    const std::string view = orthographic(
        lookat(point(-2 * std::sin(theta), 0, -2 * std::cos(theta)), "0, 0, 0"), 0.5, film(16), 1e-3);
    return scene_text::scene(-1, view + surface + sky(1));
  };
  const TrialSettings fixed{.samples = static_cast<uint32_t>(trial.by_effort(4, 64, 1024))};
  for (const double beyond : {1e-5, 1e-3, 0.3, kPi / 2 - critical - 1e-4}) {
    trial.exact("beyond the critical angle by " + short_text(std::round(beyond * 1e5) / 1e5),
                trial.render(scene(critical + beyond), fixed), 0, 1, 5e-7, "all is reflected");
  }
  const TrialSettings random{.samples = static_cast<uint32_t>(trial.by_effort(16, 256, 4096)),
                             .replicates = 64};
  for (const double before : {1e-4, 1e-2, 0.4}) {
    const double r = reflectance(std::cos(critical - before), 1 / kIndex);
    trial.statistical("before the critical angle by " + short_text(before),
                      trial.render(scene(critical - before), random), 0, r + (1 - r) * kIndex * kIndex,
                      1e-6 + 1e-6 / std::sqrt(before));
  }
  return trial.finish();
}

/// Two glass surfaces 2 m apart and 2000 m long; light between them under 45 degrees, beyond the critical
/// angle, is reflected 1000 times before it leaves at the end: exactly the environment's radiance 1, if
/// nothing is lost.
std::vector<HardFigure> light_pipe(const HardCaseContext& context) {
  Trial trial(context);
  const std::string wall = scale(2000, 10, 1) + rotate(0, 1, 0, 90);
  const std::string walls =
      shape("rectangle", to_world(wall + translate(1, 0, 0)) + glass(kIndex, 1.0)) +
      shape("rectangle", to_world(wall + rotate(0, 0, 1, 180) + translate(-1, 0, 0)) + glass(kIndex, 1.0));
  const std::string view = orthographic(lookat("0, 0, 0", "1, 0, 1"), 0.1, film(8), 1e-3);
  const TrialSettings settings{.samples = static_cast<uint32_t>(trial.by_effort(1, 8, 64))};
  const TrialImage image = trial.render(scene_text::scene(-1, view + walls + sky(1)), settings);
  trial.exact("after 1000 total reflections", image, 0, 1, 1e-6, "every factor is 1");
  trial.figure("rays per path", "rays", static_cast<double>(image.rays) / static_cast<double>(image.paths),
               1001, 1, "a path has 1000 bounces and leaves");
  return trial.finish();
}

/// Glass around water around glass around air, concentric, in an environment of radiance 1: lossless bodies
/// show 1 wherever one looks. Each boundary multiplies by the square of the ratio of the indices, and on the
/// way out by its inverse: rounding of 6e-8 per boundary, some 30 of them in the longest path of a pixel.
std::vector<HardFigure> nested_glass(const HardCaseContext& context) {
  Trial trial(context);
  const double indices[] = {1.0, 1.5, 1.33, 2.4, 1.0}, radii[] = {1, 0.8, 0.5, 0.2};
  std::string bodies;
  for (int i = 0; i < 4; ++i)
    bodies += shape("sphere", real("radius", radii[i]) + glass(indices[i + 1], indices[i]));
  const std::string view = orthographic(lookat("0.3, 0.2, 5", "0, 0, 0"), 1.1, film(32), 1e-3);
  const std::string scene = scene_text::scene(-1, view + bodies + sky(1));
  const TrialSettings settings{.samples = static_cast<uint32_t>(trial.by_effort(8, 128, 2048))};
  const TrialImage image = trial.render(scene, settings);
  trial.exact("four bodies in a furnace", image, 0, 1, 5e-6, "sums of rounding, about 80 boundaries at most");
  // A diffuse core behind three boundaries, reflectance 0.5: it sees the furnace too and shows less
  // than 1, never more.
  trial.oracle("evaluation", scene, settings);
  return trial.finish();
}

/// Roughness 1e-4 in an environment of radiance 1: a perfect mirror (reflectance 1) and lossless glass show 1
/// less what single scattering loses, of order alpha^2 = 1e-8 at these angles.
std::vector<HardFigure> smallest_roughness(const HardCaseContext& context) {
  Trial trial(context);
  const TrialSettings settings{.samples = static_cast<uint32_t>(trial.by_effort(8, 64, 512)),
                               .replicates = 32};
  for (const char* distribution : {"ggx", "beckmann"}) {
    const std::string rough = text("distribution", distribution) + real("alpha", 1e-4);
    const struct {
      std::string name, bsdf;
    } surfaces[] = {{"mirror", bsdf("roughconductor", rough)},
                    {"glass", glass(kIndex, 1.0, "roughdielectric", rough)}};
    for (const auto& surface : surfaces) {
      for (const double degrees : {0.0, 60.0, 89.0}) {
        const double theta = degrees * kPi / 180;
        const std::string plate = shape("rectangle", to_world(scale(1e3, 1e3, 1)) + surface.bsdf);
        const std::string view = orthographic(
            lookat(point(-2 * std::sin(theta), 0, 2 * std::cos(theta)), "0, 0, 0"), 0.01, film(8), 1e-3);
        const TrialImage image = trial.render(scene_text::scene(-1, view + plate + sky(1)), settings);
        // Into the glass radiance grows by n^2: L = R + (1 - R) / n^2 seen from outside.
        const double r = surface.name == "mirror" ? 1 : reflectance(std::cos(theta), kIndex);
        trial.statistical(
            std::string(distribution) + " " + surface.name + ", " + short_text(degrees) + " degrees", image,
            0, r + (1 - r) / (kIndex * kIndex), 2e-4);
      }
    }
  }
  return trial.finish();
}

}  // namespace

std::vector<HardCase> boundary_cases() {
  return {{"total_reflection", "glass from inside, on both sides of the critical angle", total_reflection},
          {"light_pipe", "1000 total reflections in a row", light_pipe},
          {"nested_glass", "four dielectric bodies inside each other", nested_glass},
          {"roughness_1e-4", "rough mirrors and glass, nearly smooth", smallest_roughness}};
}

}  // namespace kiloband::validation
