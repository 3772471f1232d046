// Target: scene files. What is read is flattened for a few channels.
#include "scene/read/reader.hpp"
#include "tests/fuzz/flat_scene_check.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace kiloband::fuzz {
namespace {

constexpr std::size_t kMostChannels = 8;  // of a scene's own; more take long, not another way

/// The emissivities of rough materials are integrated over all directions:
/// under sanitizers that takes half a minute.
bool is_slow(std::string_view bytes) {
  return bytes.find("rough") != bytes.npos && bytes.find("thermal") != bytes.npos;
}

}  // namespace

void scene(std::string_view bytes) {
  accept_or_refuse([&] {
    const SceneDescription description =
        read_scene_text(std::string(bytes), "scene.xml", std::filesystem::path(KILOBAND_FUZZ_FILES), {});
    if (is_slow(bytes)) return;
    accept_or_refuse([&] { flatten_and_check(description, parse_channels("450:650:3")); });
    const ChannelList& own = description.sensor.film.channels;
    if (own.empty() || own.size() > kMostChannels) return;
    flatten_and_check(description, own);
  });
}

}  // namespace kiloband::fuzz
