// The nozzle: from the round turbine face through a double bend to a flat exit. The bends hide the turbine
// from most directions behind, which is what they are for.
#include "scenes/generator/aircraft/aircraft.hpp"

namespace kiloband::generator {
namespace {

constexpr int kAround = 160;

/// Looks away from the axis where sections go back (-z), towards it where they go forwards.
Mesh turned(const std::vector<Section>& sections) {
  std::vector<Ring> rings;
  for (const Section& s : sections) rings.push_back(section_ring(s, kAround));
  Mesh mesh = loft(rings, {true, Ends::kOpen, 50});
  flip(mesh);
  return mesh;
}

const std::vector<Section> kDuct{
    {kExitZ, 0.872, 0.242, 0.232, 0.10, 3.8}, {-6.3, 0.86, 0.25, 0.24, 0.085, 3.6},
    {-5.7, 0.80, 0.27, 0.26, 0.00, 3.2},      {-5.1, 0.72, 0.30, 0.29, -0.06, 2.7},
    {-4.5, 0.63, 0.36, 0.35, 0.00, 2.3},      {-3.9, 0.54, 0.43, 0.43, 0.07, 2.05},
    {kTurbineZ, 0.50, 0.50, 0.50, 0.08, 2.0}};

}  // namespace

void add_nozzle(Parts& parts) {
  const Section outer = exit_section();
  constexpr double kLip = 0.024;
  std::vector<Section> lip;
  for (int i = 0; i <= 10; ++i) {
    const double a = kPi * i / 10, by = kLip * (1 - cosine(a));
    lip.push_back({kExitZ - kLip * sine(a), outer.width - by, outer.top - by, outer.bottom - by, outer.y,
                   outer.exponent});
  }
  append(parts["nozzle_lip"], turned(lip));

  // The rear half of the duct is cooler than the part next to the turbine.
  const std::vector<Section> all = interpolate(kDuct, 20);
  const std::vector<Section> rear_part(all.begin(), all.begin() + 61),
      front_part(all.begin() + 60, all.end());
  append(parts["nozzle_rear"], turned(rear_part));
  append(parts["nozzle_front"], turned(front_part));

  const Frame at = translate({0, 0.08, kTurbineZ});
  Mesh face = transformed(lathe({{0, 0}, {0.505, 0}}, 96), at * translate({0, 0, 0.12}) * rotate_x(90));
  append(parts["turbine"], face);
  append(parts["turbine"], transformed(lathe({{0.497, 0}, {0.497, 0.125}}, 96), at * rotate_x(90)));
  append(parts["tail_cone"], transformed(lathe({{0, 0.11},
                                                {0.20, 0.11},
                                                {0.20, 0},
                                                {0.19, -0.1},
                                                {0.165, -0.22},
                                                {0.12, -0.36},
                                                {0.06, -0.50},
                                                {0.02, -0.56},
                                                {0, -0.57}},
                                               72, false, 40),
                                         at * rotate_x(90)));
  for (int i = 0; i < 18; ++i) {  // exit guide vanes
    Mesh vane = grid(8, 6, [](double u, double v) {
      return Vec3{0.05 * sine(1.6 * u), 0.19 + 0.307 * v, 0.10 - 0.16 * u};
    });
    append(parts["turbine"], transformed(vane, at * rotate_z(20.0 * i)));
  }
}

void add_plume(Parts& parts) {
  std::vector<Ring> rings;
  constexpr int kRings = 48;
  for (int i = 0; i <= kRings; ++i) {
    const double t = static_cast<double>(i) / kRings, round = smooth_step(0, 0.35, t),
                 width = mix(0.86, 0.95 + 1.2 * t, round);
    const double height = mix(0.235, 0.85 + 1.3 * t, round);
    rings.push_back(
        section_ring({kExitZ - 0.03 - 14 * t, width, height, height, 0.10, mix(3.8, 2.0, round)}, 96));
  }
  append(parts["plume"], loft(rings, {true, Ends::kCapped, 50}));
}

}  // namespace kiloband::generator
