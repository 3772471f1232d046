// Tumblers, a carafe with water, cups on saucers.
#include "scenes/generator/conference/conference.hpp"
#include "scenes/generator/primitives.hpp"

namespace kiloband::generator {
namespace {

/// Outer profile up, inner profile down: a closed vessel of glass.
Mesh tumbler() {
  std::vector<Vec2> profile{{0, 0.001}, {0.020, 0.001}, {0.024, 0}, {0.027, 0.001}, {0.029, 0.004}};
  for (int i = 1; i <= 8; ++i) profile.push_back({0.029 + 0.006 * i / 8, 0.004 + 0.106 * i / 8});
  profile.insert(profile.end(), {{0.0346, 0.1112}, {0.0340, 0.1114}, {0.0334, 0.111}});
  for (int i = 7; i >= 0; --i) profile.push_back({0.0274 + 0.006 * i / 8, 0.014 + 0.096 * i / 8});
  profile.insert(profile.end(), {{0.025, 0.011}, {0.020, 0.0095}, {0.012, 0.009}, {0, 0.009}});
  return lathe(profile, 56, false, 50);
}

/// Radius of the carafe's outside at height y in metres.
double carafe_radius(double y) {
  const double belly = 0.052 + 0.012 * sine(kPi * clamp(y / 0.14, 0, 1));
  const double neck = 0.024 + 0.014 * smooth_step(0.225, 0.27, y);
  return mix(belly, neck, smooth_step(0.09, 0.20, y)) - 0.01 * smooth_step(0.012, 0, y);
}

Mesh carafe() {
  constexpr double kThickness = 0.0028;
  constexpr int kSteps = 44;
  std::vector<Vec2> profile{{0, 0}, {0.02, 0}};
  for (int i = 0; i <= kSteps; ++i) profile.push_back({carafe_radius(0.27 * i / kSteps), 0.27 * i / kSteps});
  profile.push_back({carafe_radius(0.27) - kThickness / 2, 0.2712});
  for (int i = kSteps; i >= 2; --i)
    profile.push_back({carafe_radius(0.27 * i / kSteps) - kThickness, 0.27 * i / kSteps});
  profile.insert(profile.end(), {{0.035, 0.0085}, {0.02, 0.007}, {0, 0.0065}});
  return lathe(profile, 80, false, 60);
}

/// Water fills the vessel but for a gap of 0.2 mm: two boundaries instead of one between glass and water,
/// which is what can be said with closed bodies that know only what is outside of them as air.
Mesh carafe_water(double level) {
  constexpr int kSteps = 30;
  std::vector<Vec2> profile{{0, 0.0085}, {0.02, 0.009}, {0.034, 0.0105}};
  for (int i = 0; i <= kSteps; ++i) {
    const double y = 0.016 + (level - 0.016) * i / kSteps;
    profile.push_back({carafe_radius(y) - 0.0030, y});
  }
  profile.push_back({0, level});
  return lathe(profile, 80, false, 60);
}

Mesh tumbler_water(double level) {
  const auto inner = [](double y) { return 0.0272 + 0.006 * (y - 0.014) / 0.096; };
  return lathe({{0, 0.0095},
                {0.02, 0.0102},
                {0.0245, 0.0115},
                {inner(0.016), 0.016},
                {inner(level), level},
                {0, level}},
               56, false, 50);
}

void add_cup(Parts& parts, const Frame& at) {
  Mesh& china = parts["china"];
  append(china, transformed(lathe({{0, 0.003},
                                   {0.03, 0.003},
                                   {0.045, 0.007},
                                   {0.072, 0.015},
                                   {0.074, 0.0165},
                                   {0.071, 0.0175},
                                   {0.045, 0.0095},
                                   {0.03, 0.006},
                                   {0, 0.006}},
                                  64, false, 60),
                            at));
  append(china, transformed(lathe({{0, 0.007},
                                   {0.022, 0.007},
                                   {0.026, 0.012},
                                   {0.037, 0.035},
                                   {0.041, 0.066},
                                   {0.0405, 0.067},
                                   {0.039, 0.066},
                                   {0.035, 0.036},
                                   {0.024, 0.014},
                                   {0, 0.011}},
                                  64, false, 70),
                            at));
  append(china, transformed(tube(
                                smooth_curve({{0.036, 0.056, 0},
                                              {0.055, 0.058, 0},
                                              {0.062, 0.043, 0},
                                              {0.050, 0.028, 0},
                                              {0.034, 0.027, 0}},
                                             10),
                                [](double) { return 0.0038; }, 14),
                            at));
  append(parts["coffee"], transformed(lathe({{0, 0.058}, {0.0385, 0.058}}, 48), at));
}

}  // namespace

void add_drinks(Parts& parts) {
  const Mesh glass = tumbler(), water = tumbler_water(0.075);
  for (int i = 0; i < kSeats; ++i) {
    const auto counter = static_cast<unsigned>(i);
    const Seat s = seat(i);
    const Frame place = translate({s.x, kTableHeight, s.z}) * rotate_y(s.degrees);
    const Frame at = place * translate({-0.24 + 0.05 * random_number(31, counter), 0.0005,
                                        0.44 + 0.06 * random_number(32, counter)});
    if (i % 4 == 3) {
      add_cup(parts, at * rotate_y(360 * random_number(33, counter)));
    } else {
      append(parts["glasses"], transformed(glass, at));
      if (i % 2 == 0) append(parts["water"], transformed(water, at));
    }
  }
  for (const double x : {-0.75, 1.75}) {
    const Frame at = translate({x, kTableHeight + 0.0005, 0.07});
    append(parts["glasses"], transformed(carafe(), at));
    append(parts["water"], transformed(carafe_water(0.15), at));
  }
}

}  // namespace kiloband::generator
