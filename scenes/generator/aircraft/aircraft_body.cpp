// Forebody and spine, centre body, canopy, intakes. The centre body is open in front; the forebody passes
// through that opening and divides it into the two intakes.
#include <stdexcept>

#include "scenes/generator/aircraft/aircraft.hpp"

namespace kiloband::generator {
namespace {

constexpr int kAround = 160;

/// Open skins look away from the axis where sections go forwards (+z) and towards it where they go back.
Mesh body(const std::vector<Section>& sections, Ends ends) {
  std::vector<Ring> rings;
  for (const Section& s : sections) rings.push_back(section_ring(s, kAround));
  return loft(rings, {true, ends, 50});
}

/// Behind the compressor only the spine is left of it, above the engine and the nozzle.
const std::vector<Section> kForebody{
    {7.60, 0.004, 0.004, 0.004, -0.10, 2.0}, {7.45, 0.055, 0.052, 0.050, -0.10, 2.0},
    {7.1, 0.155, 0.15, 0.135, -0.095, 2.0},  {6.5, 0.30, 0.28, 0.25, -0.075, 2.0},
    {5.6, 0.46, 0.42, 0.38, -0.04, 2.05},    {4.5, 0.60, 0.54, 0.47, 0.0, 2.15},
    {3.3, 0.68, 0.62, 0.53, 0.02, 2.3},      {2.2, 0.68, 0.68, 0.56, 0.02, 2.4},
    {1.0, 0.62, 0.74, 0.55, 0.02, 2.4},      {-0.8, 0.50, 0.67, 0.44, 0.10, 2.3},
    {-2.9, 0.36, 0.20, 0.04, 0.52, 2.2},     {-4.2, 0.24, 0.12, 0.02, 0.50, 2.0},
    {-5.4, 0.08, 0.07, 0.02, 0.42, 2.0},     {-5.8, 0.01, 0.02, 0.02, 0.40, 2.0}};

const std::vector<Section> kCentreBody{
    {kIntakeZ, 1.40, 0.37, 0.46, -0.08, 3.2}, {1.2, 1.48, 0.46, 0.50, -0.05, 3.0},
    {-0.6, 1.46, 0.54, 0.53, 0.0, 2.8},       {-2.6, 1.30, 0.56, 0.53, 0.02, 2.8},
    {-4.6, 1.12, 0.49, 0.46, 0.06, 3.0},      {-6.0, 0.98, 0.36, 0.35, 0.09, 3.4},
    {kExitZ, 0.92, 0.29, 0.28, 0.10, 3.8}};

const std::vector<Section> kCanopy{{5.35, 0.02, 0.02, 0.10, 0.36, 2.0}, {5.1, 0.19, 0.16, 0.15, 0.38, 2.0},
                                   {4.6, 0.31, 0.34, 0.2, 0.42, 2.0},   {3.9, 0.37, 0.45, 0.25, 0.46, 2.0},
                                   {3.2, 0.38, 0.42, 0.25, 0.50, 2.0},  {2.4, 0.32, 0.28, 0.2, 0.54, 2.0},
                                   {1.6, 0.20, 0.15, 0.2, 0.58, 2.0},   {1.1, 0.03, 0.05, 0.2, 0.60, 2.0}};

/// A section made smaller on all sides.
Section inset(Section s, double by, double z) {
  return {z, s.width - by, s.top - by, s.bottom - by, s.y, s.exponent};
}

}  // namespace

Ring section_ring(const Section& s, int points) {
  Ring ring;
  const auto bent = [&](double c) {
    const double v = power(std::fabs(c), 2 / s.exponent);
    return c < 0 ? -v : v;
  };
  for (int i = 0; i < points; ++i) {
    const double a = 2 * kPi * i / points, c = bent(cosine(a)), h = bent(sine(a));
    ring.push_back({s.width * c, s.y + (h > 0 ? s.top : s.bottom) * h, s.z});
  }
  return ring;
}

std::vector<Section> interpolate(const std::vector<Section>& stations, int steps) {
  // Two curves in space carry the six numbers; both run over the same parameter.
  std::vector<Vec3> first, second;
  for (const Section& s : stations) {
    first.push_back({s.z, s.width, s.top});
    second.push_back({s.bottom, s.y, s.exponent});
  }
  first = smooth_curve(first, steps);
  second = smooth_curve(second, steps);
  std::vector<Section> sections;
  for (std::size_t i = 0; i < first.size(); ++i) {
    sections.push_back(
        {first[i].x, std::max(first[i].y, 0.002), first[i].z, second[i].x, second[i].y, second[i].z});
  }
  return sections;
}

Section intake_section() {
  return kCentreBody.front();
}

Section exit_section() {
  return kCentreBody.back();
}

void add_fuselage(Parts& parts) {
  append(parts["skin"], body(interpolate(kForebody, 14), Ends::kCapped));
  Mesh centre = body(interpolate(kCentreBody, 22), Ends::kOpen);
  flip(centre);
  append(parts["skin"], centre);
  append(parts["canopy"], body(interpolate(kCanopy, 10), Ends::kCapped));
  append(parts["leading_edges"],
         tube(
             {{0, -0.10, 7.55}, {0, -0.10, 8.3}}, [](double t) { return 0.014 - 0.006 * t; }, 20));
}

void add_intakes(Parts& parts) {
  constexpr double kLip = 0.022;
  const Section outer = intake_section();
  std::vector<Section> lip;
  for (int i = 0; i <= 10; ++i) {  // half round from the skin to the duct
    const double a = kPi * i / 10;
    lip.push_back(inset(outer, kLip * (1 - cosine(a)), kIntakeZ + kLip * sine(a)));
  }
  append(parts["intake_lips"], body(lip, Ends::kOpen));
  const Section entry = inset(outer, 2 * kLip, kIntakeZ);
  const std::vector<Section> duct{entry,
                                  {1.5, 1.30, 0.27, 0.39, -0.12, 3.0},
                                  {0.6, 1.12, 0.28, 0.36, -0.14, 2.6},
                                  {-0.1, 0.92, 0.31, 0.34, -0.16, 2.2},
                                  {kCompressorZ, 0.85, 0.32, 0.32, -0.17, 2.0}};
  append(parts["intake_ducts"], body(interpolate(duct, 16), Ends::kOpen));
  // Compressor: a disc and a row of blades before it, seen past the forebody; as flat as the duct's end.
  const Frame face = translate({0, -0.17, kCompressorZ}) * scale({1, 0.376, 1});
  append(parts["compressor"],
         transformed(lathe({{0, 0}, {0.86, 0}}, 96), face * translate({0, 0, 0.001}) * rotate_x(90)));
  for (int i = 0; i < 32; ++i) {
    const Mesh blade = grid(6, 8, [](double u, double v) {
      const double twist = 0.3 + 0.7 * v;
      return Vec3{(u - 0.5) * 0.16 * twist + 0.01 * sine(kPi * u), 0.18 + 0.64 * v, (u - 0.5) * 0.12};
    });
    append(parts["compressor"],
           transformed(blade, face * translate({0, 0, 0.08}) * rotate_z(360.0 * i / 32)));
  }
}

}  // namespace kiloband::generator
