// Target: checkpoints.
#include "tests/fuzz/fuzz_checkpoint.hpp"

#include <vector>

#include "film/spectral_film.hpp"
#include "render/checkpoint/checkpoint.hpp"
#include "render/checkpoint/checkpoint_reader.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace kiloband::fuzz {
namespace {

constexpr uint64_t kFingerprint = 0x1234;

/// A film with two pixels in each of two blocks: all parts of its checkpoints are whole words.
SpectralFilm small_film() {
  FilmOptions options;
  options.channels = 2;
  options.replicates = 2;
  options.held = true;
  options.sums = SumRule{};
  return SpectralFilm({30, 0, 4, 1}, options);
}

/// The bytes with right checksums, of the header and of all, so that mutations come past them.
std::string with_checksums(std::string_view bytes) {
  std::string repaired(bytes);
  const auto repair = [&](std::size_t at) {
    WordHash hash;
    hash.add(std::span(repaired).first(at));
    const uint64_t value = hash.value();
    std::memcpy(&repaired[at], &value, sizeof value);
  };
  constexpr std::size_t kHeader = kCheckpointMagic.size() + sizeof(CheckpointHeader);
  if (bytes.size() < kHeader + 2 * sizeof(uint64_t)) return repaired;
  repair(kHeader);
  repair(bytes.size() - sizeof(uint64_t));
  return repaired;
}

void read(std::string_view bytes) {
  const auto file = scratch_file("render.checkpoint", bytes);
  accept_or_refuse([&] { checkpoint_replicates(file); });
  accept_or_refuse([&] {
    SpectralFilm film = small_film();
    read_checkpoint(file, film, kFingerprint);
    std::vector<float> mean(8), variance(8);
    film.row(0, mean, variance);
    film.image_moments();
    write_checkpoint(scratch_folder() / "again.checkpoint", film, kFingerprint);
  });
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
  read(bytes);
  read(with_checksums(bytes));
}

}  // namespace kiloband::fuzz
