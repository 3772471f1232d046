// Metadata of other programs that have an entry for every band, such as ENVI's bad bands list.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace kiloband {

/// "{1, 0, 1}": what ENVI headers have in braces keeps them as metadata, on one line.
bool is_list(const std::string& value);

/// Lists (bbl, data gain values, solar irradiance ...) of `bands` entries get those of the bands in `picked`; where that is empty they no
/// longer describe anything, and go.
void pick_band_lists(std::map<std::string, std::string>& metadata, std::size_t bands,
                     const std::vector<std::size_t>& picked);

}  // namespace kiloband
