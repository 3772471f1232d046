// Floor, pedestals, a colonnade, the landscape behind it.
#include "scenes/generator/implicit.hpp"
#include "scenes/generator/primitives.hpp"
#include "scenes/generator/sky.hpp"
#include "scenes/generator/statues/statues.hpp"

namespace kiloband::generator {
namespace {

Mesh box(Vec3 low, Vec3 high, double edge, int segments = 3) {
  return transformed(rounded_box(high - low, edge, segments), translate((low + high) * 0.5));
}

/// A fluted shaft with entasis on a round base, a plain capital.
Mesh column(double height) {
  constexpr int kFlutes = 20, kPerFlute = 10, kRows = 40;
  const double foot = 0.32, top = height - 0.30;
  std::vector<Ring> rings;
  for (int r = 0; r <= kRows; ++r) {
    const double t = static_cast<double>(r) / kRows;
    const double radius = 0.30 * (1 - 0.16 * t * t) * (1 + 0.02 * sine(kPi * t));
    const double depth = 0.024 * smooth_step(0, 0.02, t) * smooth_step(1, 0.98, t);
    Ring ring;
    for (int c = 0; c < kFlutes * kPerFlute; ++c) {
      const double a = 2 * kPi * c / (kFlutes * kPerFlute), s = sine(a * kFlutes / 2);
      ring.push_back({(radius - depth * std::fabs(s)) * cosine(a), foot + (top - foot) * t,
                      (radius - depth * std::fabs(s)) * sine(a)});
    }
    rings.push_back(ring);
  }
  Mesh mesh = loft(rings, {true, Ends::kCapped, 30});
  append(mesh, lathe({{0, 0.12},
                      {0.38, 0.12},
                      {0.41, 0.14},
                      {0.425, 0.175},
                      {0.41, 0.21},
                      {0.375, 0.23},
                      {0.355, 0.245},
                      {0.36, 0.265},
                      {0.37, 0.285},
                      {0.36, 0.31},
                      {0.33, 0.325},
                      {0, 0.33}},
                     96, false, 50));
  append(mesh, box({-0.45, 0, -0.45}, {0.45, 0.12, 0.45}, 0.012));
  append(mesh, lathe({{0, top - 0.01},
                      {0.255, top - 0.01},
                      {0.275, top + 0.01},
                      {0.27, top + 0.03},
                      {0.29, top + 0.06},
                      {0.345, top + 0.12},
                      {0.36, top + 0.16},
                      {0.35, top + 0.175},
                      {0, top + 0.18}},
                     96, false, 50));
  append(mesh, box({-0.40, top + 0.17, -0.40}, {0.40, height, 0.40}, 0.012));
  return mesh;
}

/// White marble with grey veins: sRGB values, 1 m.
Image marble() {
  Image image(512, 512);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Vec3 p{3.0 * x / image.width, 3.0 * y / image.height, 0.4};
      const double warp = turbulence(p * 1.3, 400, 4);
      const double vein = 1 - std::fabs(sine(2.2 * p.x + 3.1 * p.y + 4.5 * warp));
      const double thin = 1 - std::fabs(sine(5 * p.x - 4 * p.y + 6 * turbulence(p * 2, 410, 3)));
      const double tone = 0.55 * power(vein, 9) + 0.25 * power(thin, 14) + 0.06 * (1 + warp);
      image.at(x, y) = mix(Vec3{0.93, 0.92, 0.895}, Vec3{0.52, 0.54, 0.56}, clamp(tone, 0, 1));
    }
  }
  return image;
}

}  // namespace

void add_pedestal(Parts& parts, const std::string& part, const Pedestal& at) {
  const double h = at.height, w = at.half;
  Mesh mesh = box({-w - 0.06, 0, -w - 0.06}, {w + 0.06, 0.12, w + 0.06}, 0.01);
  append(mesh, box({-w - 0.03, 0.11, -w - 0.03}, {w + 0.03, 0.16, w + 0.03}, 0.02, 5));
  append(mesh, box({-w, 0.15, -w}, {w, h - 0.12, w}, 0.006));
  append(mesh, box({-w - 0.03, h - 0.13, -w - 0.03}, {w + 0.03, h - 0.07, w + 0.03}, 0.025, 5));
  append(mesh, box({-w - 0.05, h - 0.075, -w - 0.05}, {w + 0.05, h, w + 0.05}, 0.010));
  for (const double side : {-1.0, 1.0}) {  // a raised field on the front and the back
    append(mesh, box({-w + 0.07, 0.24, side * w - 0.012}, {w - 0.07, h - 0.21, side * w + 0.012}, 0.008));
  }
  project_uvs(mesh, {0.6, 0.05, 0.55}, {0.1, -0.7, 0.15});
  append(parts[part], transformed(mesh, translate({at.x, 0, at.z})));
}

void add_hall(Parts& parts) {
  Mesh floor = grid(1, 1, [](double u, double v) { return Vec3{(2 * u - 1) * 12, 0, 9 - 14.2 * v}; });
  project_uvs(floor, {0.5, 0, 0.0}, {0.0, 0, 0.5});
  append(parts["floor"], floor);
  for (int i = 0; i < 3; ++i) {  // steps to the landscape
    append(parts["hall_stone"],
           box({-12, -0.17 - 0.16 * i, -5.6 - 0.35 * i}, {12, -0.001 - 0.16 * i, -5.1 - 0.35 * i}, 0.008));
  }
  constexpr double kHeight = 4.2, kZ = -4.3;
  const Mesh one = column(kHeight);
  for (int i = -3; i <= 3; ++i) append(parts["columns"], transformed(one, translate({2.4 * i, 0, kZ})));
  Mesh& beam = parts["hall_stone"];
  append(beam, box({-12, kHeight, kZ - 0.38}, {12, kHeight + 0.30, kZ + 0.38}, 0.006));
  append(beam, box({-12, kHeight + 0.29, kZ - 0.42}, {12, kHeight + 0.36, kZ + 0.42}, 0.012));
  append(beam, box({-12, kHeight + 0.35, kZ - 0.36}, {12, kHeight + 0.80, kZ + 0.36}, 0.006));
  append(beam, box({-12, kHeight + 0.78, kZ - 0.55}, {12, kHeight + 0.95, kZ + 0.55}, 0.02));
  for (int i = -48; i <= 48; ++i) {  // a row of dentils
    append(beam, box({0.24 * i - 0.07, kHeight + 0.66, kZ + 0.3},
                     {0.24 * i + 0.07, kHeight + 0.78, kZ + 0.47}, 0.004, 1));
  }
  for (int i = -4; i <= 3; ++i) {  // a balustrade between the columns
    for (int k = 0; k < 7; ++k) {
      const double x = 2.4 * i + 0.62 + 0.195 * k;
      append(parts["columns"], transformed(lathe({{0, 0.06},
                                                  {0.05, 0.06},
                                                  {0.055, 0.09},
                                                  {0.035, 0.12},
                                                  {0.06, 0.22},
                                                  {0.066, 0.30},
                                                  {0.05, 0.40},
                                                  {0.028, 0.52},
                                                  {0.026, 0.60},
                                                  {0.045, 0.64},
                                                  {0.055, 0.68},
                                                  {0, 0.68}},
                                                 32, false, 50),
                                           translate({x, 0, kZ})));
    }
    append(beam, box({2.4 * i + 0.3, 0, kZ - 0.11}, {2.4 * i + 2.1, 0.07, kZ + 0.11}, 0.01));
    append(beam, box({2.4 * i + 0.3, 0.67, kZ - 0.11}, {2.4 * i + 2.1, 0.78, kZ + 0.11}, 0.015));
  }
}

/// Hills behind the colonnade up to 900 m, with a valley in front of it; cypresses on them.
void add_landscape(Parts& parts) {
  const auto height = [](double x, double z) {
    const double away = length({x, 0, z}), hill = turbulence({x / 210, 0.3, z / 210}, 500, 5);
    return -9 * smooth_step(8, 40, away) + smooth_step(60, 500, away) * (10 + 30 * hill) +
           2.0 * noise({x / 30, 0, z / 30}, 510) * smooth_step(20, 60, away);
  };
  append(parts["meadow"], grid(220, 120, [&](double u, double v) {
           const double a = (0.97 - 0.94 * u) * kPi, r = 7 * power(130.0, v);
           const double x = r * cosine(a), z = -r * sine(a) - 1;
           return Vec3{x, height(x, z), z};
         }));
  for (unsigned i = 0; i < 46; ++i) {
    const double a = kPi * (0.12 + 0.76 * random_number(520, i)),
                 r = 45 + 260 * random_number(521, i) * random_number(522, i);
    const double x = r * cosine(a), z = -r * sine(a), tall = 8 + 6 * random_number(523, i);
    Mesh tree = grid(28, 40, [&](double u, double v) {
      const double around = -2 * kPi * u, taper = power(sine(kPi * power(v, 0.62)), 0.8);
      const Vec3 p{cosine(around), 6 * v, sine(around)};
      const double radius = 0.13 * tall * taper *
                            (1 + 0.28 * turbulence(u == 1 ? Vec3{1, 6 * v, 0} * 3.0 : p * 3.0, 530 + i, 3));
      return Vec3{x + radius * p.x, height(x, z) - 0.2 + tall * v, z + radius * p.z};
    });
    append(parts["cypresses"], tree);
  }
}

void add_statue_images(Images& images) {
  images["sky.pfm"] = clear_sky({-0.62, 0.58, 0.53}, 0.85);
  images["marble.ppm"] = marble();
}

}  // namespace kiloband::generator
