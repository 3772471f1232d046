// Places and sizes: coordinates of a million metres, triangles from micrometres to ten kilometres, grazing
// angles, and lights of a square millimetre.
//
// The furnace of these cases has no variance. A closed box of diffuse walls (reflectance rho) at the ambient
// temperature T, with roulette behind the depth limit n, adds (1 - rho) B(T) at every vertex of every path:
//   L = B (1 - rho) (1 + rho + ... + rho^(n-1)) = B (1 - rho^n).
// Outside shines an environment of kOutside: a ray that leaves,
// or a shadow ray that passes a wall, shows at once.
#include <cmath>

#include "validation/suite/hard_cases/groups.hpp"
#include "validation/suite/hard_cases/trial.hpp"
#include "validation/suite/scene_text.hpp"

namespace kiloband::validation {
namespace {

using namespace scene_text;

constexpr double kKelvin = 300, kReflectance = 0.5;
constexpr int kDepth = 10;
constexpr double kOutside = 1e3;  // W m^-2 sr^-1 nm^-1; Planck's law at 300 K and 10 um is 1e-2
/// Ten vertices of about ten roundings of 6e-8 each, and Planck's law as float.
constexpr double kFurnaceLimit = 5e-6;

double furnace_radiance() {
  return planck_per_nm(10000.0005, kKelvin) * (1 - std::pow(kReflectance, kDepth));
}
const std::string kTilt = rotate(0.3, 1, 0.2, 33);

std::string furnace_scene(const std::string& walls, const std::string& view) {
  return scene_text::scene(kDepth, view + walls + thermal(kKelvin) + sky(kOutside),
                           integer("rr_depth", kNoRoulette));
}
/// A tilted cube of half side `half` about a place, seen from inside.
std::string furnace_cube(double half, double x, double y, double z) {
  const std::string cube =
      shape("cube", kInwards + to_world(scale(half, half, half) + kTilt + translate(x, y, z)) +
                        diffuse(kReflectance));
  const std::string look = lookat(point(x + 0.3 * half, y - 0.2 * half, z + 0.1 * half),
                                  point(x - half, y + 0.3 * half, z - 0.7 * half));
  return furnace_scene(cube, perspective(look, 90, film(32), 1e-3 * half));
}

std::vector<HardFigure> far_from_the_origin(const HardCaseContext& context) {
  Trial trial(context);
  const TrialSettings settings{.samples = static_cast<uint32_t>(trial.by_effort(4, 64, 1024))};
  const double far = 1e6;
  for (const double half : {50.0, 5.0}) {
    const TrialImage box = trial.render(furnace_cube(half, far, -far, 0.7 * far), settings);
    trial.exact("furnace of " + short_text(2 * half) + " m", box, 0, furnace_radiance(), kFurnaceLimit,
                "rounding of 10 vertices");
  }
  trial.oracle("evaluation", furnace_cube(50, far, -far, 0.7 * far), settings);
  // A point light I at height h over a diffuse ground, seen at its foot: L = rho I / (pi h^2), and for the
  // pixel's finite size cos^3(theta) of that: 2 mm at 10 m, 3e-8.
  const double height = 10;
  const std::string ground =
      shape("rectangle", to_world(scale(100, 100, 1) + translate(far, far, 0)) + diffuse(kReflectance));
  const std::string light = emitter("point", spectrum("intensity", 7) + "<point name=\"position\" value=\"" +
                                                 point(far, far, height) + "\"/>");
  const std::string view = orthographic(lookat(point(far, far, 50), point(far, far, 0)), 1e-3, film(4), 1e-3);
  const TrialImage lit = trial.render(scene_text::scene(2, view + ground + light), settings);
  trial.exact("point light 10 m above ground", lit, 0, kReflectance * 7 / (kPi * height * height), 1e-5,
              "the light's place to 2^-24 of 10 m and the offset of its shadow ray");
  return trial.finish();
}

std::vector<HardFigure> all_sizes(const HardCaseContext& context) {
  Trial trial(context);
  const TrialSettings settings{.samples = static_cast<uint32_t>(trial.by_effort(4, 64, 1024))};
  for (const double half : {1e-6, 1e-3, 1.0, 1e4}) {
    const TrialImage box = trial.render(furnace_cube(half, 0, 0, 0), settings);
    trial.exact("furnace of triangles of " + short_text(2 * half) + " m", box, 0, furnace_radiance(),
                kFurnaceLimit, "rounding of 10 vertices");
  }
  // Both in one scene: the small box stands in the large one, whose lamp would shine into it.
  const std::string large =
      shape("cube", kInwards + to_world(scale(1e4, 1e4, 1e4) + kTilt) + diffuse(0) + lamp(kOutside));
  const std::string small = shape(
      "cube", kInwards + to_world(scale(1e-6, 1e-6, 1e-6) + kTilt) + bsdf("twosided", diffuse(kReflectance)));
  const std::string look = lookat("3e-7, -2e-7, 1e-7", "-1e-6, 3e-7, -7e-7");
  const std::string inside = perspective(look, 90, film(32), 1e-9);
  const TrialImage both = trial.render(
      scene_text::scene(kDepth, inside + small + large + thermal(kKelvin), integer("rr_depth", kNoRoulette)),
      settings);
  trial.exact("2e-6 m box within a 2e4 m lamp", both, 0, furnace_radiance(), kFurnaceLimit,
              "no light of the lamp comes in");
  // A point light at height h over a tilted square of 2e4 m, seen at its foot:
  // rho I cos / (pi h^2) with cos = 1.
  const std::string ground =
      shape("rectangle", to_world(scale(1e4, 1e4, 1) + rotate(1, 0.4, 0, 30)) + diffuse(kReflectance));
  const double norm = std::hypot(1, 0.4), s = std::sin(kPi / 6), c = std::cos(kPi / 6);
  const double n[3] = {0.4 / norm * s, -1 / norm * s, c};
  const std::string light = emitter("point", spectrum("intensity", 7) + "<point name=\"position\" value=\"" +
                                                 point(n[0], n[1], n[2]) + "\"/>");
  const std::string view =
      orthographic(lookat(point(2 * n[0], 2 * n[1], 2 * n[2]), "0, 0, 0"), 1e-4, film(16), 1e-4);
  const TrialImage lit = trial.render(scene_text::scene(2, view + ground + light), settings);
  trial.exact("point light 1 m above a tilted square of 2e4 m", lit, 0, kReflectance * 7 / kPi, 1e-2,
              "a corner is 2^-11 m off: 5e-4 of the height, 1e-3 of the irradiance");
  return trial.finish();
}

/// A square turned about x by `degrees`, under a directional light of irradiance 5 that
/// comes from its y side.
std::string sunlit_square(double half, double degrees, double sine) {
  const double angle = degrees * kPi / 180, y = -std::sqrt(1 - sine * sine), z = -sine;
  const std::string way =
      point(0, y * std::cos(angle) - z * std::sin(angle), y * std::sin(angle) + z * std::cos(angle));
  const std::string ground =
      shape("rectangle", to_world(scale(half, half, 1) + rotate(1, 0, 0, degrees)) + diffuse(kReflectance));
  const std::string sun = emitter(
      "directional", spectrum("irradiance", 5) + "<vector name=\"direction\" value=\"" + way + "\"/>");
  const std::string view = orthographic(lookat(point(0, 0, half), "0, 0, 0"), half / 2, film(16), 1e-3);
  return scene_text::scene(2, view + ground + sun);
}

/// A directional light of irradiance E under elevation e over a diffuse square: L = rho E sin(e) / pi. A
/// direction's components are rounded to 6e-8, which is 6e-8 / sin(e) of the cosine on a tilted square.
std::vector<HardFigure> grazing_angles(const HardCaseContext& context) {
  Trial trial(context);
  const TrialSettings settings{.samples = static_cast<uint32_t>(trial.by_effort(4, 64, 1024))};
  for (const bool tilted : {false, true}) {
    for (const double half : {10.0, 1e4}) {
      for (const double sine : {1e-2, 1e-4, 1e-6}) {
        const TrialImage image = trial.render(sunlit_square(half, tilted ? 30 : 0, sine), settings);
        trial.exact((tilted ? "sun on a tilted square of " : "sun on a level square of ") +
                        short_text(2 * half) + " m, sine " + short_text(sine),
                    image, 0, kReflectance * 5 * sine / kPi, 1e-6 + (tilted ? 1.5e-7 / sine : 0),
                    tilted ? "components of directions and normals to 6e-8" : "rounding");
      }
    }
  }
  // Seen under sine 1e-4: the same everywhere, the square's own emission.
  const std::string light = shape("rectangle", to_world(scale(100, 100, 1) + kTilt) + diffuse(0) + lamp(3));
  const double c = std::cos(33 * kPi / 180), s = std::sin(33 * kPi / 180), norm = std::sqrt(0.09 + 1 + 0.04);
  const double a[3] = {0.3 / norm, 1 / norm, 0.2 / norm};
  const auto turned = [&](double x, double y, double z) {
    const double d = (a[0] * x + a[1] * y + a[2] * z) * (1 - c);
    return point(x * c + (a[1] * z - a[2] * y) * s + a[0] * d, y * c + (a[2] * x - a[0] * z) * s + a[1] * d,
                 z * c + (a[0] * y - a[1] * x) * s + a[2] * d);
  };
  const std::string along =
      orthographic(lookat(turned(50, 0, 50e-4), turned(0, 0, 0), turned(0, 0, 1)), 1e-4, film(16), 1e-3);
  const TrialImage seen = trial.render(scene_text::scene(1, along + light), settings);
  trial.exact("light seen under sine 1e-4", seen, 0, 3, 1e-6, "emission does not depend on the angle");
  return trial.finish();
}

/// A lamp of area 1e-6 m^2 and radiance L0 faces a diffuse square at distance h, seen at its foot. The
/// irradiance of a square is four times Lambert's formula for a parallel rectangle above its corner,
///   E = L0 / 2 (x / sqrt(1 + x^2) atan(y / sqrt(1 + x^2)) + y / sqrt(1 + y^2) atan(x / sqrt(1 + y^2))),
/// with x = y = a / h, a half its side; of a disk and a sphere of radius r: pi L0 r^2 / (h^2 + r^2) and
/// pi L0 r^2 / h^2.
std::vector<HardFigure> small_lights(const HardCaseContext& context) {
  Trial trial(context);
  const TrialSettings settings{.samples = static_cast<uint32_t>(trial.by_effort(32, 256, 4096)),
                               .replicates = 64};
  constexpr double kArea = 1e-6, kRadiance = 1e6;
  const std::string ground = shape("rectangle", diffuse(kReflectance));
  for (const double height : {1.0, 1000.0}) {
    const double a = std::sqrt(kArea) / 2, x = a / height, r2 = kArea / kPi;
    const double corner = x / std::sqrt(1 + x * x) * std::atan(x / std::sqrt(1 + x * x));
    const std::string down = rotate(1, 0, 0, 180) + translate(0, 0, height);
    const struct {
      const char* name;
      std::string shape;
      double irradiance;
    } lamps[] = {
        {"square", shape("rectangle", to_world(scale(a, a, 1) + down) + diffuse(0) + lamp(kRadiance)),
         4 * kRadiance * corner},
        {"disk",
         shape("disk",
               to_world(scale(std::sqrt(r2), std::sqrt(r2), 1) + down) + diffuse(0) + lamp(kRadiance)),
         kPi * kRadiance * r2 / (height * height + r2)},
        {"sphere",
         shape("sphere", "<point name=\"center\" value=\"" + point(0, 0, height) + "\"/>" +
                             real("radius", std::sqrt(r2 / 4)) + diffuse(0) + lamp(kRadiance)),
         kPi * kRadiance * r2 / 4 / (height * height)}};
    for (const auto& lamp : lamps) {
      const std::string view = orthographic(lookat("0.3, 0, 0.4", "0, 0, 0"), 1e-5, film(8), 1e-3);
      const TrialImage image = trial.render(scene_text::scene(2, view + ground + lamp.shape), settings);
      trial.statistical(std::string(lamp.name) + " at " + short_text(height) + " m", image, 0,
                        kReflectance * lamp.irradiance / kPi, 2e-5);
    }
  }
  return trial.finish();
}

}  // namespace

std::vector<HardCase> geometry_cases() {
  return {{"far_from_origin", "everything stands 1e6 m from the origin", far_from_the_origin},
          {"all_sizes", "triangles of 1e-6 m and of 1e4 m", all_sizes},
          {"grazing", "light and views under angles down to 1e-6", grazing_angles},
          {"small_light", "lights of 1e-6 m^2, at 1 m and at 1 km", small_lights}};
}

}  // namespace kiloband::validation
