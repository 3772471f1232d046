// Speed of deferred evaluation on an OpenCL device: ns per channel and vertex of dpept_batch, dpept_path and
// pt_update against K, beside the CPU backend's evaluator in the same run on as many threads; the bandwidth
// of pt_update beside a triad. Shared wavelengths, paths as in a Cornell box: 5 vertices in the mean, 4096
// pixels in four blocks, 16 samples.
//
// Times are processor time over the number of cores, the best of several repetitions. Those of the device
// hold everything from dense spectra to the film; spectra are resampled apart (column "resample": per channel
// and vertex of the round).
#include <fmt/format.h>

#include <functional>
#include <thread>

#include "src_cpu/evaluate/evaluator.hpp"
#include "tests/unit/src_cpu/evaluate/following_rows.hpp"
#include "tests/unit/src_gpu/evaluate/device_evaluator.hpp"
#include "validation/bench/synthetic_paths.hpp"

namespace kiloband::test {

using namespace cpu;
namespace {

constexpr uint32_t kBlockPixels = 1024, kBlocks = 2, kPixels = kBlocks * kBlockPixels, kSamples = 32;
/// Paths in flight of pt.
constexpr uint32_t kSlots = 8192;
/// Pixels that a work-item of dpept_batch evaluates side by side, and slots of a work-group of pt.
constexpr uint32_t kTile = 16;
constexpr uint32_t kRepetitions = 25;

double best_seconds(const std::function<void()>& work) {
  double best = 1e30;
  for (uint32_t i = 0; i <= kRepetitions; ++i) {  // the first warms up
    const double start = processor_seconds();
    work();
    if (i > 0) best = std::min(best, processor_seconds() - start);
  }
  return best;
}

RoundOfPaths make_round(uint32_t blocks, uint32_t samples) {
  RoundOfPaths round;
  round.pixels = blocks * kBlockPixels;
  round.samples = samples;
  round.blocks = blocks;
  for (uint32_t p = 0; p < blocks * kBlockPixels; ++p) round.block.push_back(p / kBlockPixels);
  for (uint32_t job = 0; job < blocks * kBlockPixels * samples; ++job) round.path.push_back(job);
  for (uint32_t t = 0; t < blocks * samples; ++t)
    round.mu.push_back(static_cast<float>(t) / (blocks * samples));
  return round;
}

/// The CPU backend's evaluator: each thread takes blocks, sample by sample.
double cpu_seconds(const FlatScene& scene, const PathBuffer& paths, const RoundOfPaths& round) {
  const uint32_t threads = std::max(1u, std::thread::hardware_concurrency());
  struct Part {
    Evaluator evaluator;
    std::vector<float> sums;
    std::vector<PathBuffer> samples;
  };
  std::vector<Part> parts;
  for (uint32_t b = 0; b < kBlocks; ++b) {
    Part part{Evaluator(scene, {}, Isa::kAuto), {}, {}};
    part.sums.assign(kBlockPixels * part.evaluator.stride(), 0.0f);
    for (uint32_t s = 0; s < kSamples; ++s) {
      PathBuffer sample;
      for (uint32_t p = 0; p < kBlockPixels; ++p) {
        const SavedPath& path = paths.paths[s * kPixels + b * kBlockPixels + p];
        sample.paths.push_back({static_cast<uint32_t>(sample.entries.size()), path.count, p});
        sample.entries.insert(sample.entries.end(), paths.entries.begin() + path.first,
                              paths.entries.begin() + path.first + path.count);
      }
      part.samples.push_back(std::move(sample));
    }
    parts.push_back(std::move(part));
  }
  return best_seconds([&] {
    std::vector<std::thread> workers;
    for (uint32_t t = 0; t < threads; ++t) {
      workers.emplace_back([&, t] {
        for (uint32_t b = t; b < kBlocks; b += threads) {
          const FollowingRows rows(parts[b].evaluator, parts[b].sums);
          for (uint32_t s = 0; s < kSamples; ++s)
            parts[b].evaluator.add_shared(parts[b].samples[s], round.mu[b * kSamples + s], rows);
        }
      });
    }
    for (std::thread& worker : workers) worker.join();
  });
}

void launch(OpenclProbe& probe, cl::Kernel& kernel, std::size_t items, std::size_t local) {
  probe.queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(items), cl::NDRange(local));
  probe.queue.finish();
}

/// GB/s of a[i] = b[i] + s c[i] over three arrays that together take `bytes`.
double triad_bandwidth(std::size_t bytes) {
  OpenclProbe probe(
      "__kernel void triad(__global float16* restrict a, __global const float16* restrict b,"
      "                    __global const float16* restrict c, float s) {"
      "  const size_t i = get_global_id(0); a[i] = b[i] + s * c[i]; }");
  const std::size_t vectors = std::max<std::size_t>(bytes / 3 / 64 / 256, 1) * 256;
  cl::Kernel kernel(probe.program, "triad");
  const std::vector<float> ones(vectors * 16, 1.0f);
  const cl::Buffer buffers[] = {probe.upload(ones), probe.upload(ones), probe.upload(ones)};
  for (cl_uint i = 0; i < 3; ++i) kernel.setArg(i, buffers[i]);
  kernel.setArg(3, 0.5f);
  const double seconds = best_seconds([&] { launch(probe, kernel, vectors, 256); });
  return 3e-9 * 64 * static_cast<double>(vectors) / seconds;
}

void bench(std::size_t channels) {
  const FlatScene scene = synthetic_scene(channels);
  const opencl::ChannelTables tables = opencl::make_channel_tables(scene, {});
  const PathBuffer paths = synthetic_paths(kPixels * kSamples, kBlockPixels, 4.0, 0.7f);
  const RoundOfPaths round = make_round(kBlocks, kSamples);
  EvaluatorBuild build;
  build.vectors = std::min<uint32_t>(8, static_cast<uint32_t>((channels + 15) / 16));
  build.tile = kTile;
  build.features = "-DKB_SPECIALISED -DKB_HAS_DIFFUSE=1 -DKB_HAS_AREA_LIGHT=1";
  EvaluatorProgram program(build);
  DeviceEvaluator device(program, scene, tables, kPixels);
  device.load(paths, round, false);
  cl::Kernel batch = device.batch_kernel(), path = device.path_kernel();
  const double unit = 1e9 / (static_cast<double>(paths.entries.size()) * static_cast<double>(channels));
  const double cpu = cpu_seconds(scene, paths, round) * unit;
  const double batch_ns = best_seconds([&] { launch(program.probe, batch, kPixels / kTile, 1); }) * unit;
  const double path_ns = best_seconds([&] { launch(program.probe, path, kPixels, 16); }) * unit;
  const double resample_ns = best_seconds([&] { device.resample(); }) * unit;
  DeviceEvaluator streaming(program, scene, tables, kSlots);
  streaming.load(paths, make_round(kSlots / kBlockPixels, 1), false);
  const PtTiming pt = streaming.time_pt(kSlots, kSlots / kTile, 5, kRepetitions);
  const double pt_ns = pt.seconds * 1e9 / (kSlots * 5.0 * static_cast<double>(channels));
  const double triad = triad_bandwidth(pt.state_bytes);
  fmt::print("{:5} {:8.4f} {:8.4f} {:8.4f} {:9.4f} {:8.4f} {:9.1f} {:9.1f} {:7.2f}\n", channels, cpu,
             batch_ns, path_ns, resample_ns, pt_ns, pt.bytes / pt.seconds * 1e-9, triad,
             pt.bytes / pt.seconds * 1e-9 / triad);
}

void run() {
  fmt::print("ns per channel and vertex; pt: {} slots, 5 bounces, GB/s of its traffic beside a triad's\n",
             kSlots);
  fmt::print("{:>5} {:>8} {:>8} {:>8} {:>9} {:>8} {:>9} {:>9} {:>7}\n", "K", "cpu", "batch", "path",
             "resample", "pt", "pt GB/s", "triad", "ratio");
  for (std::size_t channels : {8u, 16u, 32u, 64u, 128u, 256u, 512u, 1024u}) bench(channels);
}

}  // namespace
}  // namespace kiloband::test

int main() {
  kiloband::test::run();
}
