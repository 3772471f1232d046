// Other renderers, found at run time: Mitsuba 3 (validation/mitsuba/time_mitsuba.py) and Raysect (validation/raysect/time_raysect.py).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "validation/speed/subject.hpp"

namespace kiloband::speed {

/// A renderer and a variant of it, or why it cannot take part.
struct Peer {
  std::string backend, variant;  // "mitsuba", "llvm_ad_spectral"
  std::string interpreter;       // empty: not there
  std::string version;
  std::string script;
  std::string why;       // it is not there
  bool refuses = false;  // scenes, whatever it has no word for: refusal() asks
};

/// Every variant that is asked for; which python3 has it is tried.
std::vector<Peer> find_peers(const Settings& settings);

/// Why the peer cannot render that scene; empty: it can.
std::string refusal(const Peer& peer, const SceneFile& scene);

struct PeerTiming {
  Repetitions images;
  double load_seconds = 0;
  double warm_up_seconds = 0;  // of a first render, which compiles
  std::string failure;         // the script's words; empty: it went well
};

/// `rounds` renders of setup.samples per pixel of the setup's channels and size.
/// throws InputError  its images cannot be read
PeerTiming time_peer(const Bench& bench, const Peer& peer, const SceneFile& scene, const Setup& setup,
                     uint32_t rounds);

/// The command line that time_peer() runs, `-o` aside.
std::string peer_command(const Settings& settings, const Peer& peer, const SceneFile& scene,
                         const Setup& setup, uint32_t rounds);

}  // namespace kiloband::speed
