// A twin-fin jet with one engine: z forwards, y up, x to the left wing; metres. Every part that may have a
// temperature of its own is a mesh of its own.
#pragma once

#include "scenes/generator/image.hpp"
#include "scenes/generator/mesh.hpp"
#include "scenes/generator/primitives.hpp"

namespace kiloband::generator {

/// A cross-section of a body: a superellipse of half width `width` and half heights `top` and `bottom` about
/// height y. exponent 2: ellipse; larger: towards a rectangle.
struct Section {
  double z, width, top, bottom, y, exponent;
};
/// Points from +x by +y round to +x again.
Ring section_ring(const Section& s, int points);
/// Smooth sections between the given ones: `steps` pieces each.
std::vector<Section> interpolate(const std::vector<Section>& stations, int steps);

void add_fuselage(Parts& parts);  // forebody with spine, centre body, canopy
void add_intakes(Parts& parts);   // lip, ducts, compressor face
void add_nozzle(Parts& parts);    // lip, serpentine duct, turbine face, tail cone
void add_wings(Parts& parts);     // wings with strakes, tailplanes, fins, stores
/// The hull that the exhaust gas fills: nothing in visible light, for scenes of the infrared.
void add_plume(Parts& parts);

inline constexpr double kIntakeZ = 2.0, kCompressorZ = -0.6, kTurbineZ = -3.3, kExitZ = -6.8;
/// Where the outer skin of the centre body ends: lip of the intakes, lip of the nozzle.
Section intake_section();
Section exit_section();

}  // namespace kiloband::generator
