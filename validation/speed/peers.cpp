#include "validation/speed/peers.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "cube/cube_io.hpp"
#include "validation/suite/child_process.hpp"

namespace kiloband::speed {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;
using validation::ChildEnd;
using validation::run_child;

constexpr const char* kInterpreters[] = {"python3", "/usr/bin/python3"};

/// The last line that a script printed to its standard error says why.
std::string reason_of(const ChildEnd& end) {
  std::string text = end.err;
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const std::string last = text.substr(text.find_last_of('\n') + 1);
  return last.empty() || end.code < 0 ? end.description() : last;
}

Peer probe(const Settings& settings, const std::string& backend, const std::string& script,
           const std::string& variant) {
  Peer peer{backend, variant, {}, {}, (settings.root / script).string(), {}};
  for (const char* interpreter : kInterpreters) {
    std::vector<std::string> command{interpreter, peer.script, "--probe"};
    if (!variant.empty()) command.insert(command.end(), {"--variant", variant});
    const ChildEnd end = run_child(command, {}, {});
    const json versions = json::parse(end.out, nullptr, false);
    if (end.code == 0 && versions.is_object()) {
      peer.interpreter = interpreter;
      peer.version = versions.value(backend, "");
      peer.why.clear();
      return peer;
    }
    if (peer.why.empty()) peer.why = reason_of(end);
  }
  return peer;
}

/// Its script writes scenes for it, of those that are made of diffuse meshes alone.
Peer probe_raysect(const Settings& settings) {
  Peer peer = probe(settings, "raysect", "validation/raysect/time_raysect.py", {});
  peer.refuses = true;
  return peer;
}

std::vector<std::string> command_words(const Settings& settings, const Peer& peer, const SceneFile& scene,
                                       const Setup& setup, uint32_t rounds, const std::string& output) {
  std::vector<std::string> words{peer.script, scene.file.string(),
                                 "--bands",   bands_text(scene, setup.channels),
                                 "--size",    fmt::format("{}x{}", setup.width, setup.height),
                                 "--spp",     fmt::format("{}", setup.samples),
                                 "--rounds",  fmt::format("{}", rounds),
                                 "--seed",    fmt::format("{}", settings.seed),
                                 "-o",        output};
  if (!peer.variant.empty()) words.insert(words.end(), {"--variant", peer.variant});
  return words;
}

/// And the folder, if nothing else is in it.
void remove_images(const fs::path& stem, uint32_t rounds) {
  std::error_code none;
  for (uint32_t r = 0; r < rounds; ++r)
    for (const char* extension : {"hdr", "img"})
      fs::remove(fmt::format("{}.r{:02d}.{}", stem.string(), r, extension), none);
  fs::remove(stem.parent_path(), none);
}

std::vector<float> read_image(const fs::path& file, const Setup& setup) {
  const auto cube = open_cube(file);
  const CubeInfo& info = cube->info();
  if (info.width != setup.width || info.height != setup.height || info.bands.size() != setup.channels)
    throw InputError(file.string() + ": another size or number of channels than was asked for");
  std::vector<float> values(std::size_t{info.width} * info.height * info.bands.size());
  cube->read_rows(0, info.height, values, {});
  return values;
}

}  // namespace

std::vector<Peer> find_peers(const Settings& settings) {
  const std::string mitsuba = "validation/mitsuba/time_mitsuba.py";
  return {probe(settings, "mitsuba", mitsuba, "llvm_ad_spectral"),
          probe(settings, "mitsuba", mitsuba, "scalar_spectral"), probe_raysect(settings)};
}

std::string refusal(const Peer& peer, const SceneFile& scene) {
  if (!peer.refuses) return {};
  const ChildEnd end = run_child({peer.interpreter, peer.script, scene.file.string(), "--load"}, {}, {});
  return end.code == 0 ? std::string{} : reason_of(end);
}

PeerTiming time_peer(const Bench& bench, const Peer& peer, const SceneFile& scene, const Setup& setup,
                     uint32_t rounds) {
  const fs::path folder = bench.settings().output / "peers";
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw DeviceError(folder.string() + ": " + error.message());
  const fs::path stem = folder / "image";
  std::vector<std::string> command{peer.interpreter};
  for (const std::string& word :
       command_words(bench.settings(), peer, scene, setup, rounds, stem.string() + ".hdr"))
    command.push_back(word);
  const ChildEnd end = run_child(command, bench.watch(), {});
  PeerTiming timing;
  const json result = json::parse(end.out, nullptr, false);
  if (end.code != 0 || !result.is_object()) {
    timing.failure = reason_of(end);
  } else {
    timing.load_seconds = result.value("load_seconds", kNone);
    timing.warm_up_seconds = result.value("warm_up_seconds", kNone);
    timing.images = {
        setup.width, setup.height, setup.channels, {}, result.value("seconds", std::vector<double>{})};
    for (std::size_t r = 0; r < timing.images.seconds.size(); ++r)
      timing.images.images.push_back(read_image(fmt::format("{}.r{:02d}.hdr", stem.string(), r), setup));
  }
  remove_images(stem, rounds);
  return timing;
}

std::string peer_command(const Settings& settings, const Peer& peer, const SceneFile& scene,
                         const Setup& setup, uint32_t rounds) {
  const auto words = command_words(settings, peer, scene, setup, rounds, "image.hdr");
  std::string text = peer.interpreter;
  for (const std::string& word : words) {
    const fs::path near = fs::path(word).lexically_proximate(settings.root);
    const bool inside = word.starts_with('/') && !near.empty() && *near.begin() != "..";
    text += ' ' + (inside ? near.string() : word);
  }
  return text;
}

}  // namespace kiloband::speed
