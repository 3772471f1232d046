// Target: checkpoints.
#include "tests/fuzz/fuzz_checkpoint.hpp"

#include <span>
#include <vector>

#include "film/spectral_film.hpp"
#include "render/checkpoint.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace kiloband::fuzz {
namespace {

constexpr uint64_t kFingerprint = 0x1234;

/// A film with pixels in two blocks.
SpectralFilm small_film() {
  FilmOptions options;
  options.channels = 2;
  options.replicates = 2;
  options.held = true;
  options.sums = SumRule{};
  return SpectralFilm({31, 0, 2, 1}, options);
}

}  // namespace

void write_small_checkpoint(const std::filesystem::path& file) {
  SpectralFilm film = small_film();
  const PixelSums sums = film.pixel_sums(1, 0);
  sums.count = 4;
  sums.open[0] = 4;
  sums.open[1] = 2;
  film.set_attempted(1, 0, 4);
  write_checkpoint(file, film, kFingerprint);
}

void checkpoint(std::string_view bytes) {
  const auto file = scratch_file("render.checkpoint", bytes);
  accept_or_refuse([&] { checkpoint_replicates(file); });
  accept_or_refuse([&] { inspect_checkpoint(std::span(bytes), "render.checkpoint"); });
  accept_or_refuse([&] {
    SpectralFilm film = small_film();
    read_checkpoint(file, film, kFingerprint);
    std::vector<float> mean(4), variance(4);
    film.row(0, mean, variance);
    film.image_moments();
    write_checkpoint(scratch_folder() / "again.checkpoint", film, kFingerprint);
  });
}

}  // namespace kiloband::fuzz
