#include "src_gpu/path_memory.hpp"

namespace kiloband::gpu {

uint64_t bytes_per_path(Method method, uint64_t channels, uint64_t vertices, uint64_t slots_each, bool gas) {
  PoolSize one;
  one.slots = 1;
  one.gas = gas;
  if (method == Method::kPt) {
    one.arena_chunks = 1;
    if (gas) one.chunk_slots = KB_PT_GAS_CHUNK_SLOTS;
    const uint64_t padded = (channels + 15) / 16 * 16;
    return path_pool_bytes(one) + 2 * sizeof(float) * padded;  // throughput and radiance
  }
  one.jobs = 1;
  one.arena_chunks = static_cast<uint32_t>((vertices * slots_each + KB_CHUNK_SLOTS - 1) / KB_CHUNK_SLOTS);
  return path_pool_bytes(one);
}

}  // namespace kiloband::gpu
