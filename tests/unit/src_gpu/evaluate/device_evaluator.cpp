#include "device_evaluator.hpp"

#include <numeric>
#include <random>

#include "shared/sampler.h"

namespace kiloband::test {
namespace {

constexpr uint32_t kFilmWidth = 1000;
constexpr uint64_t kSeed = 77;

/// Paths in chunks: of slots that fill their paths side by side, as the pool does, or in no order.
struct Arena {
  static constexpr uint32_t kPool = 8192;

  std::vector<KbPathVertex> entries;
  std::vector<uint32_t> next, first;
  std::vector<std::vector<uint32_t>> chunks;  // of a path

  Arena(const PathBuffer& paths, bool scattered) : chunks(paths.paths.size()) {
    uint32_t count = 0;
    for (std::size_t begin = 0; begin < paths.paths.size(); begin += kPool) {
      const std::size_t end = std::min<std::size_t>(begin + kPool, paths.paths.size());
      bool more = true;
      for (uint32_t level = 0; more; ++level) {
        more = false;
        for (std::size_t p = begin; p < end; ++p) {
          if (level * KB_CHUNK_ENTRIES >= paths.paths[p].count) continue;
          chunks[p].push_back(count++);
          more = true;
        }
      }
    }
    if (scattered) scatter(count);
    entries.resize(std::size_t{count} * KB_CHUNK_ENTRIES);
    next.assign(count, 0xfffffff0u);
    for (std::size_t p = 0; p < chunks.size(); ++p) place(paths, paths.paths[p], chunks[p]);
  }

 private:
  void scatter(uint32_t count) {
    std::vector<uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::shuffle(order.begin(), order.end(), std::mt19937(5));
    for (std::vector<uint32_t>& path : chunks)
      for (uint32_t& chunk : path) chunk = order[chunk];
  }
  void place(const PathBuffer& paths, const SavedPath& path, const std::vector<uint32_t>& own) {
    first.push_back(own.empty() ? 0xfffffff0u : own.front());
    for (std::size_t i = 1; i < own.size(); ++i) next[own[i - 1]] = own[i];
    for (uint32_t i = 0; i < path.count; ++i)
      entries[own[i / KB_CHUNK_ENTRIES] * KB_CHUNK_ENTRIES + i % KB_CHUNK_ENTRIES] =
          paths.entries[path.first + i];
  }
};

std::vector<float> texel_values(const FlatScene& scene) {
  std::vector<float> all;
  for (std::size_t t = 0; t < scene.spectral_texels.size(); ++t) {
    if (!scene.spectral_texels[t]) continue;
    all.resize(std::size_t{scene.textures[t].first_value} * KB_VALUE_UNIT);
    all.insert(all.end(), scene.spectral_texels[t]->begin(), scene.spectral_texels[t]->end());
  }
  return all;
}

}  // namespace

uint32_t entries_of(const KbPathVertex& vertex) {
  return 1 + kb_vertex_extensions(vertex.head);
}

std::string EvaluatorBuild::options() const {
  return "-DKB_WIDTH=" + std::to_string(width) + " -DKB_VECTORS=" + std::to_string(vectors) +
         " -DKB_PER_PATH=" + std::to_string(per_path) + " -DKB_DERIVED=" + std::to_string(derived) +
         film_options() + " -DKB_PIXELS=" + std::to_string(tile) + " -DKB_STAGED=" + std::to_string(staged) +
         (stage_entries ? " -DKB_STAGE_ENTRIES=" + std::to_string(*stage_entries) : "") + " " + features;
}

std::string EvaluatorBuild::film_options() const {
  return " -DKB_FILM_TRANSPOSED=" + std::to_string(transposed);
}

EvaluatorProgram::EvaluatorProgram(const EvaluatorBuild& b)
    : build(b),
      probe(std::string("#include \"evaluate/evaluate.cl\"\n") +
                (b.staged ? "" : "#include \"evaluate/pt.cl\"\n"),
            b.options()),
      resample(probe.build("#include \"evaluate/resample.cl\"\n",
                           "-DKB_WIDTH=" + std::to_string(b.width) + " " + b.features)),
      film(probe.build("#include \"film/film.cl\"\n", b.film_options())) {}

float per_path_mu(const RoundOfPaths& round, uint32_t pixel, uint32_t sample) {
  const uint32_t index = round.first_index + sample;
  return kb_path_mu(KB_SAMPLER_INDEPENDENT, kSeed, pixel / 7 * kFilmWidth + pixel % 7, index, 0, index);
}

DeviceEvaluator::DeviceEvaluator(EvaluatorProgram& program, const FlatScene& scene,
                                 const opencl::ChannelTables& t, uint32_t film_pixels)
    : program_(program), layout_(t.layout), film_pixels_(film_pixels) {
  OpenclProbe& probe = program.probe;
  layout_.film_width = kFilmWidth;
  spectra_.layout = probe.upload(std::vector{layout_});
  spectra_.nodes = probe.upload(t.nodes);
  spectra_.tables = probe.upload(t.tables);
  spectra_.material_rows = probe.upload(t.material_rows);
  spectra_.cover = probe.upload(t.cover);
  spectra_.cover_breaks = probe.upload(t.cover_breaks);
  scene_.materials = probe.upload(scene.materials);
  scene_.textures = probe.upload(scene.textures);
  scene_.texels = probe.upload(scene.texels);
  scene_.texel_values = probe.upload(texel_values(scene));
  const std::size_t floats = std::size_t{film_pixels} * layout_.film_columns;
  film_.sum = probe.upload(std::vector<float>(floats, 7.0f));  // clear() must do something
  film_.compensation = probe.upload(std::vector<float>(floats, 7.0f));
  film_.counts = probe.upload(std::vector<uint32_t>(film_pixels, 7u));
  film_.pixels = film_pixels;
  clear();
}

void DeviceEvaluator::load(const PathBuffer& paths, const RoundOfPaths& round, bool scattered) {
  OpenclProbe& probe = program_.probe;
  round_ = round;
  record_ = {};
  record_.seed = kSeed;
  record_.sampler = KB_SAMPLER_INDEPENDENT;
  record_.wavelengths = program_.build.per_path ? KB_WAVELENGTHS_PER_PATH : KB_WAVELENGTHS_SHARED;
  record_.replicates = 1;
  record_.first_index = round.first_index;
  record_.samples = round.samples;
  record_.pixels = round.pixels;
  record_.padded_pixels = round.pixels;
  record_.blocks = round.blocks;
  pool_.round = probe.upload(std::vector{record_});
  std::vector<KbRoundPixel> pixels;
  for (uint32_t p = 0; p < round.pixels; ++p) pixels.push_back({p % 7, p / 7, round.block[p]});
  pool_.pixels = probe.upload(pixels);
  const Arena arena(paths, scattered);
  pool_.arena = probe.upload(arena.entries);
  pool_.chunk_next = probe.upload(arena.next);
  std::vector<KbSavedPath> saved;
  for (const uint32_t p : round.path) {
    if (p == RoundOfPaths::kEmpty)
      saved.push_back({0xfffffff0u, 0});
    else if (p == RoundOfPaths::kInvalid)
      saved.push_back({0xfffffff0u, KB_SAVED_INVALID});
    else
      saved.push_back({arena.first[p], paths.paths[p].count});
  }
  pool_.saved = probe.upload(saved);
  pool_.shared_mu = probe.upload(round.mu);
  if (!program_.build.per_path) resample();
}

void DeviceEvaluator::resample() {
  const std::size_t floats = std::size_t{round_.blocks} * round_.samples * layout_.rows * layout_.stride;
  evaluation_.dense = cl::Buffer(program_.probe.context, CL_MEM_READ_WRITE, floats * sizeof(float));
  cl::Kernel k = evaluation_kernel(program_.resample, "resample_rows");
  run(k, floats / program_.build.width, 1);
}

template <class... Groups>
cl::Kernel DeviceEvaluator::kernel(const cl::Program& program, const char* name, const Groups&... groups) {
  cl::Kernel k(program, name);
  cl_uint index = 0;
  ((index = set_argument(k, index, groups)), ...);
  return k;
}

cl::Kernel DeviceEvaluator::evaluation_kernel(const cl::Program& program, const char* name) {
  return kernel(program, name, scene_, spectra_, pool_, evaluation_, film_, queue_);
}

cl::Kernel DeviceEvaluator::evaluation_kernel(const char* name) {
  return evaluation_kernel(program_.probe.program, name);
}

void DeviceEvaluator::run(cl::Kernel& k, std::size_t items, std::size_t local) {
  program_.probe.queue.enqueueNDRangeKernel(
      k, cl::NullRange, cl::NDRange((items + local - 1) / local * local), cl::NDRange(local));
  program_.probe.queue.finish();
}

cl::Kernel DeviceEvaluator::batch_kernel() {
  const std::size_t parts = std::max<std::size_t>(1, std::size_t{round_.pixels} * 64 * layout_.derived);
  evaluation_.partial = cl::Buffer(program_.probe.context, CL_MEM_READ_WRITE, parts * sizeof(float));
  return evaluation_kernel("dpept_batch");
}

cl::Kernel DeviceEvaluator::path_kernel() {
  return evaluation_kernel("dpept_path");
}

void DeviceEvaluator::batch(uint32_t local_size, uint32_t groups) {
  cl::Kernel k = batch_kernel();
  const std::size_t items = program_.build.staged ? program_.build.tile * local_size : local_size;
  run(k, groups * items, items);
  if (layout_.derived == 0) return;
  evaluation_.parts = local_size;
  cl::Kernel add = evaluation_kernel("derived_add");
  run(add, round_.pixels * layout_.derived, 1);
}

void DeviceEvaluator::path(uint32_t local_size) {
  cl::Kernel k = path_kernel();
  run(k, round_.pixels, local_size);
}

cl::Kernel DeviceEvaluator::film_kernel(const char* name, const cl::Buffer& packed) {
  const opencl::PackingArguments::Of<ProbeBuffer> packing{
      .layout = spectra_.layout, .open = {}, .values = {}, .packed = packed, .pixels = film_pixels_};
  return kernel(program_.film, name, film_, packing);
}

void DeviceEvaluator::clear() {
  cl::Kernel k = film_kernel("film_clear", {});
  run(k, std::size_t{film_pixels_} * layout_.film_columns, 1);
}

std::vector<float> DeviceEvaluator::means() {
  const std::size_t values = std::size_t{film_pixels_} * (layout_.channels + layout_.derived);
  const cl::Buffer out = program_.probe.upload(std::vector<float>(values, 7.0f));
  cl::Kernel k = film_kernel("film_finish", out);
  run(k, values, 1);
  return program_.probe.download<float>(out, values);
}

std::vector<uint32_t> DeviceEvaluator::counts() {
  return program_.probe.download<uint32_t>(film_.counts, film_pixels_);
}

}  // namespace kiloband::test
