// Cameras as a page moves them: a place, a point that is looked at, a direction that is up.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "scene/description/description.hpp"

namespace kiloband::viewer {

/// distance: to the point that is looked at, m
nlohmann::json camera_json(const Sensor& sensor, double distance, double scene_size);

/// The sensor at another place; what the request does not name stays. Mirrored cameras stay mirrored, scaled ones
/// (parallel projections) scaled.
/// wanted  {"origin", "target", "up", "fov_deg"}
/// throws InputError  origin and target equal, up along the view, an angle that is none
Sensor placed_sensor(const Sensor& sensor, const nlohmann::json& wanted, double distance);

/// A <sensor> without film and sampler.
std::string sensor_xml(const Sensor& sensor);

/// The sensor with a film that is `factor` times smaller, for a quick look.
Sensor reduced_sensor(const Sensor& sensor, uint32_t factor);

}  // namespace kiloband::viewer
