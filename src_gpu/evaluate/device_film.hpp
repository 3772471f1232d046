// The film on the device: sums of the samples of one replicate, and their way to and from the host (kernels/film/film.cl).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "src_gpu/device/program.hpp"
#include "src_gpu/evaluate/pinned_memory.hpp"
#include "src_gpu/scene/device_scene.hpp"

namespace kiloband::opencl {

/// Sums of pixels as the host keeps them, [pixel][channels + derived] (film/replicate_sums.hpp).
struct FilmSums {
  std::vector<float> open, sum, lost;
  std::vector<uint32_t> counts;  // valid samples
};

/// What a film is made for.
struct FilmForm {
  bool transposed = false;  // kernels/film/film.clh: neighbouring work-items own neighbouring pixels
  bool open = false;        // it has sums of chunks that go on
  /// What replicates come to is kept beside it (DeviceReplicates).
  enum class Moments { kNone, kMean, kMeanAndSquares } moments = Moments::kNone;

  /// Whether a film of this form serves for the other.
  bool serves(const FilmForm& other) const { return (open || !other.open) && moments >= other.moments; }
};

/// Numbers of a pixel that leave the device: channels and derived ones.
uint64_t film_values(const KbSpectraLayout& layout);

class DeviceFilm {
 public:
  static uint64_t bytes_per_pixel(const KbSpectraLayout& layout, const FilmForm& form);

  /// pixels: resident at once; device_layout must outlive the film
  /// throws DeviceOutOfMemory
  DeviceFilm(DeviceContext& context, DeviceMemory& memory, const KbSpectraLayout& layout,
             const DeviceBuffer<KbSpectraLayout>& device_layout, const FilmForm& form, bool program_cache,
             uint64_t pixels);

  /// For kernels that add to it; open: rounds that go on with a chunk find its sums in place of the film's.
  FilmArguments::Of<BufferRef> arguments(uint64_t first_pixel, bool open = false) const;

  /// Of the first `pixels`, as all that follow.
  void clear(uint64_t pixels);
  /// Films with sums of chunks: puts the host's sums into the film, or takes them from it.
  void load(const FilmSums& sums);
  void save(uint64_t pixels, FilmSums& sums);
  /// The chunk that rounds went on with is complete: its sums become part of the film.
  void close_chunk(uint64_t pixels);
  /// Means [pixel][K + D] and valid samples.
  void finish(uint64_t pixels, std::vector<float>& means, std::vector<uint32_t>& counts);

  const FilmForm& form() const { return form_; }
  /// Pixels of an array that stands like the film's: packed[pixel][K + D].
  struct Pixels {
    uint64_t first = 0, number = 0;
  };
  void pack(const Pixels& pixels, const DeviceBuffer<float>& values, std::vector<float>& packed);
  void download_counts(uint64_t pixels, std::vector<uint32_t>& counts) const;
  void clear_counts(uint64_t pixels) { counts_.fill(0, 0, pixels); }

 private:
  PackingArguments::Of<BufferRef> packing(const DeviceBuffer<float>& values, uint64_t pixels) const;
  void unpack(const std::vector<float>& packed, DeviceBuffer<float>& values);
  void download_packed(FilmKernel& kernel, const DeviceBuffer<float>& values, const Pixels& pixels,
                       std::vector<float>& packed);
  void launch_over(FilmKernel& kernel, const DeviceBuffer<float>& values, uint64_t pixels);
  uint64_t touched_pixels(uint64_t pixels) const;

  KbSpectraLayout layout_;
  const DeviceBuffer<KbSpectraLayout>& device_layout_;
  FilmForm form_;
  uint64_t pixels_, packed_pixels_;
  DeviceBuffer<float> sum_, compensation_, open_, packed_;
  DeviceBuffer<uint32_t> counts_;
  PinnedFloats landing_[2];  // where packed values come down, in turns
  Program program_;
  FilmKernel clear_, finish_, close_, pack_, unpack_;
};

}  // namespace kiloband::opencl
