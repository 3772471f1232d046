#include "render/checkpoint/checkpoint_keeper.hpp"

#include <fmt/core.h>

#include "render/checkpoint/checkpoint.hpp"

namespace kiloband {

std::string CheckpointKeeper::save(const SpectralFilm& film) {
  try {
    write_checkpoint(*settings_.checkpoint, film, settings_.fingerprint);
  } catch (const DeviceError& error) {
    return error.what();
  }
  stands_ = true;
  return {};
}

void CheckpointKeeper::save_if_due(const SpectralFilm& film) {
  const double interval = settings_.checkpoint_interval_seconds;
  if (std::chrono::duration<double>(Clock::now() - last_).count() < interval) return;
  const std::string failure = save(film);
  last_ = Clock::now();
  if (failure.empty() || !told_.insert(failure).second) return;
  warn(settings_.sink, {},
       fmt::format("checkpoint: {}: the render goes on, the next attempt follows in {:g} s", failure,
                   interval));
}

void CheckpointKeeper::save_last(const SpectralFilm& film) {
  const std::string failure = save(film);
  if (failure.empty()) return;
  warn(settings_.sink, {},
       fmt::format(
           "checkpoint: {}: {}", failure,
           stands_ ? "what it holds is older than the image" : "this render has none, only its image"));
}

}  // namespace kiloband
