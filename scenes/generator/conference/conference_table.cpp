// The table: a boat-shaped top with a rounded edge on two steel pedestals.
#include "scenes/generator/conference/conference.hpp"
#include "scenes/generator/primitives.hpp"

namespace kiloband::generator {
namespace {

/// Outline of the top, moved inwards by `inset`: curved long sides, corners of a superellipse.
Ring outline(double inset, double y) {
  Ring ring;
  constexpr int kPoints = 240;
  for (int i = 0; i < kPoints; ++i) {
    const double a = 2 * kPi * i / kPoints, c = cosine(a), s = sine(a);
    const double k = 1 / power(power(std::fabs(c), 8) + power(std::fabs(s), 8), 1.0 / 8);
    const double x = kTableHalfLength * c * k;
    const double half_width = table_half_width(x);
    ring.push_back({x * (1 - inset / kTableHalfLength), y, -half_width * s * k * (1 - inset / half_width)});
  }
  return ring;
}

/// A slab between two heights whose edges are rounded with `radius`.
Mesh slab(double inset, double y0, double y1, double radius) {
  std::vector<Ring> rings;
  constexpr int kSteps = 6;
  for (int i = 0; i <= kSteps; ++i) {
    const double a = kPi / 2 * i / kSteps;
    rings.push_back(outline(inset + radius * (1 - sine(a)), y0 + radius * (1 - cosine(a))));
  }
  for (int i = 0; i <= kSteps; ++i) {
    const double a = kPi / 2 * i / kSteps;
    rings.push_back(outline(inset + radius * (1 - cosine(a)), y1 - radius * (1 - sine(a))));
  }
  return loft(rings, {true, Ends::kCapped, 40});
}

void add_pedestal(Parts& parts, double x) {
  Mesh& steel = parts["table_legs"];
  const auto box = [&](Vec3 size, Vec3 centre, double radius) {
    append(steel, transformed(rounded_box(size, radius, 4), translate(centre)));
  };
  box({0.10, 0.62, 0.42}, {x, 0.35, 0}, 0.012);
  box({0.16, 0.025, 1.0}, {x, 0.02, 0}, 0.010);
  box({0.14, 0.02, 0.9}, {x, 0.68, 0}, 0.008);
}

}  // namespace

double table_half_width(double x) {
  const double t = x / kTableHalfLength;
  return 0.56 + 0.19 * (1 - t * t);
}

void add_table(Parts& parts) {
  Mesh top = slab(0.03, kTableHeight - 0.012, kTableHeight, 0.004);
  project_uvs(top, {1.0, 0, 0}, {0, 0, 1.0});
  append(parts["table_top"], top);
  append(parts["table_edge"], slab(0, kTableHeight - 0.045, kTableHeight - 0.004, 0.018));
  add_pedestal(parts, -1.65);
  add_pedestal(parts, 1.65);
  append(parts["cable_tray"], transformed(rounded_box({3.1, 0.07, 0.16}, 0.012, 2), translate({0, 0.63, 0})));
  for (const double x : {-1.2, 0.0, 1.2}) {  // lids of the cable outlets
    append(parts["cable_tray"],
           transformed(rounded_box({0.28, 0.006, 0.11}, 0.0025, 3), translate({x, kTableHeight + 0.002, 0})));
  }
}

}  // namespace kiloband::generator
