// Scenes of these tests, as text: an open box of diffuse walls under an area light, as the Cornell box.
#pragma once

#include <string>

#include "tests/support/scene_text.hpp"

namespace kiloband::test {

using namespace scene_text;

/// The sensor in front of the box: all of the opening along the film's longer side. film_text: what scene_text::film() takes
std::string box_sensor(const std::string& film_text);
/// Five walls (red left, green right) with spectra from 400 to 780 nm.
std::string box_walls();
/// The light below the ceiling. radiance: points "nm:value, ..."
std::string box_light(const std::string& radiance);
/// A diffuse block on the floor.
std::string box_block();

/// A triangle wave: low at first_nm + i period_nm, high in the middle between. On channels of one period
/// each, the wavelength offset changes all of them together and strongly.
std::string comb(double first_nm, double last_nm, double period_nm, double low, double high);

}  // namespace kiloband::test
