// Elements that only files of Mitsuba 0.x have.
#pragma once

#include <optional>

#include "scene/xml/document.hpp"

namespace kiloband {

/// <srgb> as <rgb>, <blackbody> as a spectrum of type planck; nothing for all others. Attributes are substituted already.
/// throws InputError  their values are not colours or temperatures
std::optional<XmlElement> modern_form(const XmlElement& element);

}  // namespace kiloband
