// How fast a film becomes files: wall clock and processor time of CubeOutput, beside the same bytes written
// plainly and flushed (as `dd conv=fsync` does). All are repeated in turn; medians.
//
//   bench_output FOLDER [--edge 256] [--channels 512] [--repetitions 5] [--no-variance]
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <map>
#include <stdexcept>

#include "render/cube_output.hpp"

namespace kiloband {
namespace {

struct Settings {
  std::string folder;
  uint32_t edge = 256;
  std::size_t channels = 512;
  int repetitions = 5;
  bool no_variance = false;
};

struct Seconds {
  double wall = 0, processor = 0;
};

double processor_seconds() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

template <class Action>
Seconds measure(const Action& action) {
  const auto start = std::chrono::steady_clock::now();
  const double before = processor_seconds();
  action();
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
          processor_seconds() - before};
}

FlatScene scene_of(const Settings& settings) {
  FlatScene scene;
  scene.film.crop_width = scene.film.crop_height = settings.edge;
  for (std::size_t k = 0; k < settings.channels; ++k) {
    const double step = 300.0 / static_cast<double>(settings.channels),
                 first = 400 + step * static_cast<double>(k);
    scene.channels.push_back({first, first + step, ""});
  }
  return scene;
}

SpectralFilm film_of(const Settings& settings) {
  FilmOptions options;
  options.channels = settings.channels;
  options.replicates = 2;
  options.variance = !settings.no_variance;
  SpectralFilm film({0, 0, settings.edge, settings.edge}, options);
  for (uint32_t block = 0; block < film.blocks().size(); ++block) {
    const std::size_t pixels = film.blocks()[block].pixels();
    const std::vector<uint32_t> counts(pixels, 16);
    for (uint32_t r = 0; r < 2; ++r) {
      std::vector<float> means(pixels * settings.channels);
      for (std::size_t i = 0; i < means.size(); ++i)
        means[i] = 1 + 1e-3f * static_cast<float>((i * 2654435761u + r * 40503u + block) % 1024);
      film.add({block, r, counts, means, settings.channels});
    }
  }
  return film;
}

/// Bands come in files of at least this size; what the disk can do.
void write_plainly(const std::string& file, const std::vector<char>& bytes, uint64_t size) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  for (uint64_t done = 0; done < size;) {
    const ssize_t written = write(descriptor, bytes.data(), std::min<uint64_t>(bytes.size(), size - done));
    if (written <= 0) throw std::runtime_error("cannot write " + file);
    done += static_cast<uint64_t>(written);
  }
  fsync(descriptor);
  close(descriptor);
  unlink(file.c_str());
}

void run(const Settings& settings) {
  const FlatScene scene = scene_of(settings);
  const SpectralFilm film = film_of(settings);
  const BandSelection bands = select_bands(scene, {});
  const std::vector<double> scale(settings.channels, 0.25);
  const std::vector<char> megabytes(8u << 20, 'x');
  std::map<std::string, std::vector<Seconds>> results;
  const uint64_t bytes = uint64_t{settings.edge} * settings.edge * settings.channels * sizeof(float) *
                         (settings.no_variance ? 1 : 2);
  for (int i = 0; i < settings.repetitions; ++i) {
    for (const std::string format : {"hdr", "exr"}) {
      SessionSettings session;
      session.variance = !settings.no_variance;
      session.outputs = {settings.folder + "/bench_output." + format};
      results[format].push_back(measure([&] {
        CubeOutput output(scene, bands, scale, session, 2, settings.edge);
        for (uint32_t y = 0; y < settings.edge; y += output.rows_at_once())
          output.write(film, y, std::min(output.rows_at_once(), settings.edge - y), {});
        RenderReport report;
        output.finish(report);
      }));
    }
    results["plain"].push_back(
        measure([&] { write_plainly(settings.folder + "/bench_output.plain", megabytes, bytes); }));
  }
  fmt::print("{:.0f} MB into {}, medians of {}\n", 1e-6 * static_cast<double>(bytes), settings.folder,
             settings.repetitions);
  for (auto& [name, all] : results) {
    const auto median = [&](double Seconds::*what) {
      std::ranges::sort(all, {}, what);
      return all[all.size() / 2].*what;
    };
    fmt::print("  {:<6} {:.3f} s, processor {:.3f} s\n", name, median(&Seconds::wall),
               median(&Seconds::processor));
  }
}

}  // namespace
}  // namespace kiloband

int main(int argc, char** argv) {
  kiloband::Settings settings;
  CLI::App program{"Writing cubes beside writing plain bytes"};
  program.add_option("FOLDER", settings.folder)->required()->check(CLI::ExistingDirectory);
  program.add_option("--edge", settings.edge)->check(CLI::Range(1, 4096));
  program.add_option("--channels", settings.channels)->check(CLI::Range(1, 100000));
  program.add_option("--repetitions", settings.repetitions)->check(CLI::Range(1, 1000));
  program.add_flag("--no-variance", settings.no_variance);
  CLI11_PARSE(program, argc, argv);
  kiloband::run(settings);
  return 0;
}
