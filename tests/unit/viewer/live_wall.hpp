// What renders that are looked at are tested with: a wall of 40 x 36 pixels on the CPU backend.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "scene/read/reader.hpp"
#include "src_cpu/cpu_backend.hpp"
#include "viewer/live/live_settings.hpp"

namespace kiloband::test {

/// A white wall under a lamp of 1 W m^-2 sr^-1 nm^-1 everywhere, whose radiance is its reflectance.
inline const char* const kWallScene = R"(<scene version='3.0.0'>
<integrator type='path'><integer name='max_depth' value='3'/></integrator>
<sensor type='perspective'><float name='fov' value='40'/>
 <transform name='to_world'><lookat origin='0,0,4' target='0,0,0' up='0,1,0'/></transform>
 <film type='hdrfilm'><integer name='width' value='40'/><integer name='height' value='36'/><rfilter type='box'/></film>
</sensor>
<shape type='rectangle' id='wall'><transform name='to_world'><scale value='9'/></transform>
 <bsdf type='diffuse' id='paint'><spectrum name='reflectance' value='0.5'/></bsdf></shape>
<emitter type='constant' id='sky'><spectrum name='radiance' value='1'/></emitter></scene>)";

/// Wavelengths of their own for all paths, so that errors of rectangles are known.
inline viewer::LiveOptions wall_options(uint64_t samples, const std::string& text = kWallScene) {
  viewer::LiveOptions live;
  live.scene = read_scene_text(text, "wall.xml", ".");
  live.channels = parse_channels("500:600:4");
  live.scene_name = "wall.xml";
  live.settings.backend = "cpu";
  live.settings.method = "dpept-batch";
  live.settings.max_depth = 3;
  live.settings.sampling.wavelengths = WavelengthMode::kPerPath;
  live.backends.choices = {{"cpu", "this one", {}, {"dpept-batch"}}};
  live.backends.make = [](const viewer::LiveSettings& settings, std::shared_ptr<const FlatScene> scene,
                          const DerivedChannels& derived) {
    return cpu::make_backend(std::move(scene), derived, settings.sampling, {});
  };
  live.samples = samples;
  live.threads = 2;
  return live;
}

}  // namespace kiloband::test
