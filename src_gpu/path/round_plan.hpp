// How an image is cut so that it fits the device: groups of pixels whose film is resident, rounds of paths
// that are generated and then evaluated, and the sizes of pool and arena. Pure arithmetic.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "film/replicate_sums.hpp"
#include "src_gpu/path/path_pool.hpp"

namespace kiloband::opencl {

/// The three evaluations of one pipeline (DPEPT paper, sections 4 and 5).
enum class Method { kDpeptBatch, kDpeptPath, kPt };
/// "dpept-batch", "dpept-path", "pt"
const char* to_string(Method method);
/// The method of that name; nothing: there is none.
std::optional<Method> find_method(std::string_view name);

/// Vertices of a chunk: with the method pt, which empties chunks at every bounce, what a bounce may append.
uint32_t chunk_entries(Method method, const SceneFeatures& features);

struct PlanRequest {
  uint64_t budget = 0;   // bytes that may be used
  uint64_t largest = 0;  // bytes of the largest buffer
  uint64_t pixels = 0;   // of the image part
  uint32_t samples = 1;  // per pixel and round: samples_of_round()
  uint32_t rounds = 1;   // that may be one, if they fit: rounds_as_one()
  Method method = Method::kDpeptBatch;
  uint64_t film_bytes = 0;     // per pixel: sums, compensation, counts, what finishing needs
  uint64_t table_bytes = 0;    // per block and sample: dense spectra; 0 with per-path wavelengths
  uint64_t slot_bytes = 0;     // per slot beside the pool's own: pt's state of every channel
  uint32_t most_slots = 1;     // paths in flight that the device gains from
  uint64_t most_jobs = 1;      // paths per round that it gains from
  double chunks_per_path = 3;  // expected
  bool dispersion = false;     // PoolSize::dispersion
  uint32_t chunk_entries = KB_CHUNK_ENTRIES;
  bool gas = false;  // the scene has gas
  bool instances = false;
  uint32_t shading_keys = 0;
};

struct RoundPlan {
  uint64_t group_pixels = 0;  // film on the device
  uint32_t round_pixels = 0;  // of them in a round, at most
  uint64_t round_jobs = 0;    // pixels * samples of a round, at most
  PoolSize pool;
};

/// Samples of a pixel that a round renders, as far as there are that many; of rounds that are one (rounds_as_one) each has so many.
/// Evaluation sums them before it adds them to the film, so this number must not follow from memory or time: it depends on the scene and the
/// kind of device alone, and images are the same bit by bit whatever the budget.
/// table_bytes  of a block and sample: dense spectra
uint32_t samples_of_round(bool cpu_device, uint64_t table_bytes);

/// Samples that kernels sum in registers before they add them to the film (KB_SAMPLES_IN_REGISTERS,
/// kernels/evaluate/evaluate_tile.clh), if a round has as many: 32, on CPU devices the 16 that their rounds have.
uint32_t samples_in_registers(bool cpu_device);

/// Paths in flight and paths of a round that a GPU gains from and that its memory has room for, powers of two.
uint32_t gpu_slots(uint64_t budget);
uint64_t gpu_jobs(uint64_t budget);

/// Paths in flight and paths of a round that a device has where nobody says otherwise. budget: bytes of its memory;
/// slot_bytes: PlanRequest::slot_bytes
uint32_t usual_slots(bool cpu_device, uint64_t budget, uint64_t slot_bytes);
uint64_t usual_jobs(bool cpu_device, uint64_t budget);

/// How the film is summed where rounds have at most `round_samples`: in chunks of a round, and of what
/// registers take of it; pt adds every sample to the film at once.
/// derived  there are derived channels, whose sums are kept for whole rounds alone
SumRule sum_rule_of(Method method, uint32_t round_samples, bool derived);

/// A round of a replicate that may be gone on with.
struct SampleCut {
  uint32_t samples = 0;
  bool open = false;  // its sums are those of a chunk that goes on, KbRound::open
};
/// The next round of the samples [first, end) of a replicate. Chunks that are rendered as a whole go to the
/// film; the one at the end stays open, so that the samples after it find its sums.
/// rounds  that may be one, where all of their chunks go to the film
SampleCut next_cut(uint32_t first, uint32_t end, const SumRule& rule, uint32_t rounds = 1);
/// Of samples of a pixel whose vertices do not fit together: about half go first. Rounds that are one part between two of them, which
/// leaves the bits of their sums. samples: at least 2; round_samples: of a round alone
uint32_t first_part(uint32_t samples, uint32_t round_samples);
/// Whether sample `first` begins a chunk: that before it is complete.
bool begins_chunk(uint32_t first, const SumRule& rule);

/// What decides how many rounds may be one.
struct RoundsAsOne {
  SumRule rule;            // sum_rule_of()
  uint32_t registers = 1;  // samples_in_registers()
  uint64_t table_bytes = 0;
  uint32_t slots = 1;    // paths in flight that the device gains from
  uint64_t pixels = 1;   // of the image part
  uint32_t samples = 1;  // that are wanted
};
/// Rounds that follow each other and may be one, at least 1: as many as the paths in flight allow, with no larger tables than a round of a block
/// may have; a power of 2 where there is room for it, so that pools are seldom made anew. A round of few pixels does not fill a device, and
/// costs it as many launches as one of many. Kernels add what is in registers to the film, and begin anew: rounds whose samples
/// are a multiple of those leave the same bits as one after the other. Where they are not (large tables), where sums belong to a
/// whole round (derived channels), and with pt, they stay alone.
uint32_t rounds_as_one(const RoundsAsOne& wanted);

/// throws DeviceOutOfMemory  not even a pixel fits: says what would be needed
RoundPlan plan_rounds(const PlanRequest& request);

}  // namespace kiloband::opencl
