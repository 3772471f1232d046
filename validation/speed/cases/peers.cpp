// Other renderers on the same scene and machine, in the same run: speed, and time to equal error, against K.
//
// Theirs and ours are held against one reference, which is ours; so the means are compared first, and a peer whose means differ
// says so, for its errors then contain that difference. Efficiency does not depend on the number of samples for
// independent samples; with Sobol points, whose error falls faster, it is that of the stated number.
#include "validation/speed/peers.hpp"

#include <fmt/format.h>

#include "validation/speed/errors.hpp"

namespace kiloband::speed {
namespace {

/// An image's efficiency by pixels, of those that are compared.
struct Rated {
  Setup setup;
  Estimate efficiency;
  Estimate rate;  // paths per second
  std::string command;
};

std::vector<SceneFile> peer_scenes(const Settings& settings) {
  std::vector<SceneFile> scenes{
      bench_scene(settings, "cornell_box"),
      {"glass", settings.root / "validation/mitsuba/scenes/glass.xml", 400, 700, {}}};
  for (const SceneFile& scene : bench_scenes(settings))
    if (scene.name == "matpreview") scenes.push_back(scene);
  return scenes;
}

Setup setup_for(const Bench& bench, const SceneFile& scene, uint32_t channels) {
  Setup setup;
  setup.scene = scene.name;
  setup.channels = channels;
  setup.width = setup.height = 64;
  setup.samples = bench.pick(16u, 64u);
  return setup;
}

Record record_for(const Setup& setup, const std::string& command) {
  Record record;
  record.group = "peers";
  record.setup = setup;
  record.command = command;
  return record;
}

void add_number(Bench& bench, Record record, const char* quantity, const char* unit, const Estimate& e,
                const char* kind = "standard error") {
  record.quantity = quantity, record.unit = unit;
  record.value = e.value, record.error = e.error;
  record.error_kind = kind;
  bench.add(record);
}

/// What is known of images and seconds; what comparisons need of it.
Rated rate(Bench& bench, const Setup& setup, const std::string& command, const Repetitions& images,
           const Reference& reference) {
  std::vector<double> rates;
  for (const double seconds : images.seconds)
    rates.push_back(double{1} * setup.width * setup.height * static_cast<double>(setup.samples) / seconds);
  Record record = record_for(setup, command);
  record.repetitions = static_cast<uint32_t>(rates.size());
  add_number(bench, record, "paths_per_second", "1/s", median_of(rates), "half range");
  const MeanDifference means = compare_means(images, reference);
  if (means.differ) record.note = "the means differ from the reference's: the errors contain that";
  add_number(bench, record, "mean_difference", "", {means.relative, means.error});
  add_errors(bench, record, images, reference, false);
  const Estimate efficiency =
      efficiency_of(errors_of(images, reference).front().square, mean_of(images.seconds));
  return {setup, efficiency, median_of(rates), command};
}

Rated rate_ours(Bench& bench, const SceneFile& scene, Setup setup, const char* sampler,
                const Reference& reference) {
  setup.backend = "cpu", setup.wavelengths = "shared", setup.sampler = sampler;
  setup.replicates = 1;
  const uint32_t rounds = bench.pick(4u, 8u);
  Subject subject = make_subject(bench.settings(), setup, load(scene, setup), rounds, bench.settings().seed);
  time_samples(subject, 1, bench.watch());
  const Repetitions images = repeat(subject, setup, rounds, bench.watch());
  const std::string command = render_command(bench.settings(), scene, setup, bench.settings().seed);
  return bench.stopped() ? Rated{} : rate(bench, setup, command, images, reference);
}

/// throws DeviceError  the peer was there and did not render
Rated rate_theirs(Bench& bench, const Peer& peer, const SceneFile& scene, Setup setup,
                  const Reference& reference) {
  setup.backend = peer.backend, setup.method = peer.variant;
  const uint32_t rounds = bench.pick(3u, 4u);
  const std::string command = peer_command(bench.settings(), peer, scene, setup, rounds);
  const PeerTiming timing = time_peer(bench, peer, scene, setup, rounds);
  if (bench.stopped()) return {};
  if (!timing.failure.empty()) throw DeviceError(fmt::format("{}: {}", command, timing.failure));
  add_number(bench, record_for(setup, command), "load_seconds", "s", {timing.load_seconds, kNone});
  add_number(bench, record_for(setup, command), "warm_up_seconds", "s", {timing.warm_up_seconds, kNone});
  return rate(bench, setup, command, timing.images, reference);
}

void add_ratio(Bench& bench, const Rated& ours, const Rated& theirs) {
  Record record = record_for(ours.setup, bench_command(bench.settings(), "peers"));
  record.series = theirs.setup.backend;
  if (!theirs.setup.method.empty()) record.series += " " + theirs.setup.method;
  add_number(bench, record, "equal_error_speed", "", ratio_of(ours.efficiency, theirs.efficiency));
  add_number(bench, record, "path_speed", "", ratio_of(ours.rate, theirs.rate), "half range");
}

/// scene: that the peer cannot render; empty: it is not there at all
void add_missing(Bench& bench, const Peer& peer, const std::string& scene, const std::string& why) {
  Setup setup;
  setup.scene = scene;
  setup.backend = peer.backend, setup.method = peer.variant;
  Record record = record_for(setup, bench_command(bench.settings(), "peers"));
  record.quantity = "paths_per_second", record.unit = "1/s";
  record.note = "not measured: " + why;
  bench.add(record);
}

/// Those of the peers that are there and can render it; the others leave a record that says why.
std::vector<Peer> peers_for(Bench& bench, const SceneFile& scene, const std::vector<Peer>& peers) {
  std::vector<Peer> able;
  for (const Peer& peer : peers) {
    if (peer.interpreter.empty()) continue;
    const std::string why = refusal(peer, scene);
    if (why.empty())
      able.push_back(peer);
    else
      add_missing(bench, peer, scene.name, why);
  }
  return able;
}

/// Scalar renders of many channels take hours and say nothing new.
bool takes_part(const Bench& bench, const Peer& peer, uint32_t channels) {
  return peer.variant != "scalar_spectral" || channels <= (bench.quick() ? 0u : 31u);
}

void measure_scene(Bench& bench, const SceneFile& scene, uint32_t channels, const std::vector<Peer>& peers) {
  const Setup setup = setup_for(bench, scene, channels);
  const Reference reference = reference_of(bench, scene, setup, bench.pick(2048u, 16384u));
  std::vector<Rated> ours;
  for (const char* sampler : {"sobol", "independent"})
    if (!bench.stopped()) ours.push_back(rate_ours(bench, scene, setup, sampler, reference));
  for (const Peer& peer : peers) {
    if (bench.stopped()) return;
    if (!takes_part(bench, peer, channels)) continue;
    const Rated theirs = rate_theirs(bench, peer, scene, setup, reference);
    if (bench.stopped()) return;
    for (const Rated& own : ours) add_ratio(bench, own, theirs);
  }
}

}  // namespace

void run_peers(Bench& bench) {
  const std::vector<Peer> peers = find_peers(bench.settings());
  for (const Peer& peer : peers)
    if (peer.interpreter.empty()) add_missing(bench, peer, {}, peer.why);
  std::vector<SceneFile> scenes = peer_scenes(bench.settings());
  if (bench.quick()) scenes.resize(1);
  const std::vector<uint32_t> few{8}, many{8, 31, 100, 512};
  const auto& counts = bench.quick() ? few : many;
  double done = 0;
  for (const SceneFile& scene : scenes) {
    const std::vector<Peer> able = peers_for(bench, scene, peers);
    for (const uint32_t channels : counts) {
      measure_scene(bench, scene, channels, able);
      if (bench.stopped()) return;
      bench.progress(++done / static_cast<double>(scenes.size() * counts.size()));
    }
  }
}

}  // namespace kiloband::speed
