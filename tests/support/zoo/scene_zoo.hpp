// A table of small scenes that together use everything a scene file can say:
// what tests of backends loop over.
#pragma once

#include <string>
#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "scene/description/derived_channels.hpp"
#include "tests/support/temporary_folder.hpp"

namespace kiloband::test {

/// How much of a rounding error is left at a path's end: what parity can ask for.
enum class Chains {
  kRough,   // diffuse and rough surfaces: errors stay small
  kCurved,  // some balls or prisms that reflect or refract sharply: each multiplies an error by ten and more
  kSpecular,  // long specular chains
  kPlume      // segments whose cells end where a threshold says: a hundred such decisions each
};

struct ZooScene {
  std::string name;
  std::string xml;  // 32 x 32 pixels are rendered; file names are relative to a ZooFolder
  Chains chains = Chains::kRough;
};

/// All scenes. Bands of them all: kZooBands.
const std::vector<ZooScene>& scene_zoo();
/// throws std::out_of_range for an unknown name
const ZooScene& zoo_scene(const std::string& name);

inline const char* const kZooBands = "450:650:4";

/// A folder with the pictures, meshes and indices that the scenes name.
class ZooFolder : public TemporaryFolder {
 public:
  ZooFolder();
  /// The scene read and flattened for the bands (guide bands are the same).
  FlatScene flatten(const ZooScene& scene, const std::string& bands = kZooBands) const;
};

/// Two responses over the zoo's bands: a triangle and a constant.
DerivedChannels zoo_responses(const ChannelList& channels);

}  // namespace kiloband::test
