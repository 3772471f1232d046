// <emitter type="sunsky">
#pragma once

#include <vector>

#include "scene/read/context.hpp"

namespace kiloband {

/// The sky as an environment, the sun as a directional light; one of them where the other's scale is 0.
/// throws InputError  the sun is not above the horizon; parameters outside their ranges
std::vector<Emitter> read_sunsky(ReadContext& context, const ObjectReader& object);

}  // namespace kiloband
