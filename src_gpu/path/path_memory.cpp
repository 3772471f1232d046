#include "src_gpu/path/path_memory.hpp"

namespace kiloband::opencl {

uint64_t bytes_per_path(Method method, uint64_t channels, uint64_t vertices, uint64_t entries_each,
                        const SceneFeatures& features) {
  PoolSize one;
  one.dispersion = features.dispersion;
  one.chunk_entries = chunk_entries(method, features);
  one.slots = 1;
  one.gas = features.gas;
  one.instances = features.instances;
  if (method == Method::kPt) {
    one.arena_chunks = 1;
    const uint64_t padded = (channels + 15) / 16 * 16;
    return path_pool_bytes(one) + 2 * sizeof(float) * padded;  // throughput and radiance
  }
  one.jobs = 1;
  one.arena_chunks =
      static_cast<uint32_t>((vertices * entries_each + KB_CHUNK_ENTRIES - 1) / KB_CHUNK_ENTRIES);
  return path_pool_bytes(one);
}

}  // namespace kiloband::opencl
