#include "src_gpu/evaluate/evaluation.hpp"

#include <algorithm>

namespace kiloband::opencl {
namespace {

constexpr uint64_t kLocalSize = 64;

uint64_t ceil_div(uint64_t n, uint64_t d) {
  return (n + d - 1) / d;
}

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const char* main_file(Method method) {
  return method == Method::kPt ? "evaluate/pt.cl" : "evaluate/evaluate.cl";
}
const char* main_kernel(Method method) {
  if (method == Method::kPt) return "pt_update";
  return method == Method::kDpeptPath ? "dpept_path" : "dpept_batch";
}

Program build(DeviceContext& context, const char* file, std::vector<std::string> defines, bool cache,
              uint32_t registers = 0) {
  return build_program(context, file, ProgramOptions{std::move(defines), cache, registers});
}

/// resample_rows asks for the width, and whether the scene has gas or narrow spectra: scenes that differ in all else share its program.
std::vector<std::string> resample_defines(const EvaluationShape& shape,
                                          const std::vector<std::string>& of_scene) {
  std::vector<std::string> d{"KB_WIDTH=" + std::to_string(shape.width)};
  if (std::ranges::find(of_scene, "KB_HAS_GAS=0") != of_scene.end())
    d.insert(d.end(), {"KB_SPECIALISED", "KB_HAS_GAS=0"});
  if (std::ranges::find(of_scene, "KB_SPECTRAL_LINES=1") != of_scene.end())
    d.push_back("KB_SPECTRAL_LINES=1");
  return d;
}

/// Floats of the parts of derived channels that work-items leave behind.
uint64_t partial_floats(const KbSpectraLayout& layout, const EvaluationShape& shape, const PoolSize& pool) {
  if (shape.method == Method::kDpeptPath) return 0;
  const uint64_t units = shape.method == Method::kPt ? pool.slots : pool.pixels;
  return units * shape.local_size * layout.derived;
}

/// Throughputs, or radiances, of the paths in flight.
uint64_t state_floats(const KbSpectraLayout& layout, const EvaluationShape& shape, const PoolSize& pool) {
  return shape.method == Method::kPt ? uint64_t{pool.slots} * layout.stride : 0;
}

/// The smallest groups of GPUs that are worth while. Pixels with half of that, or fewer, vectors of channels share it.
constexpr uint64_t kWarp = 32, kHalfWarp = 16;
/// Work-items of a GPU's group at most, usually: those that share a path, those of pixels side by side, those with a path each; and pixels side
/// by side (measured on an H100: validation/results/gpu_h100.md).
constexpr uint32_t kItemsOfPath = 256, kItemsSideBySide = 64, kPathsOfGroup = 64;
constexpr uint64_t kMostPixels = 16;

/// Vectors of channels that a work-item takes at most, where vertices have one reflectance.
constexpr uint32_t kMostVectors = 4;

/// Work-items of a GPU that share a path, for so many parts of its channels.
uint64_t sharing_items(uint64_t parts) {
  return parts <= kHalfWarp ? parts : ceil_div(parts, kWarp) * kWarp;
}

/// Vectors of a work-item: several spare each the decoding of vertices that it has in common with the others, but may leave more lanes idle. The
/// least of the instructions that a vertex takes: 11 and 19 for each vector (counted: validation/results/gpu_static.md). Work-items fill a warp.
uint32_t vectors_of_item(uint64_t vectors) {
  constexpr uint64_t kOfVertex = 11, kOfVector = 19;
  uint32_t best = 1;
  uint64_t least = sharing_items(vectors) * (kOfVertex + kOfVector);
  for (uint32_t some = 2; some <= kMostVectors && ceil_div(vectors, some) > kHalfWarp; ++some) {
    const uint64_t instructions = sharing_items(ceil_div(vectors, some)) * (kOfVertex + kOfVector * some);
    if (instructions >= least) continue;
    least = instructions;
    best = some;
  }
  return best;
}

/// dpept_batch with the stage: pixels side by side fill the lanes that channels leave.
void put_pixels_side_by_side(const EvaluationTask& task, uint64_t most_items, uint64_t filled,
                             EvaluationShape& shape) {
  shape.width = task.channels >= 4 ? 4 : task.channels >= 2 ? 2 : 1;
  const uint64_t vectors = ceil_div(task.channels, shape.width);
  const bool plain = task.vertices == VertexSpectra::kOneReflectance && task.shared_wavelengths;
  shape.vectors = plain ? vectors_of_item(vectors) : 1;
  shape.local_size =
      static_cast<uint32_t>(std::min(sharing_items(ceil_div(vectors, shape.vectors)), most_items));
  shape.units_per_group =
      static_cast<uint32_t>(std::clamp<uint64_t>(filled / shape.local_size, 1, kMostPixels));
}

/// Of dpept_batch with the stage, measured on an H100 as the sizes above.
uint32_t most_registers(const EvaluationTask& task, uint32_t vectors) {
  if (task.vertices == VertexSpectra::kAny) return 96;
  return vectors == 1 ? 56 : 24 + 24 * vectors;
}

}  // namespace

std::vector<std::string> EvaluationShape::defines(uint32_t derived) const {
  std::vector<std::string> d{
      "KB_WIDTH=" + std::to_string(width),
      "KB_VECTORS=" + std::to_string(vectors),
      "KB_DERIVED=" + std::to_string(derived),
      "KB_PIXELS=" + std::to_string(method == Method::kDpeptBatch ? units_per_group : 1),
      std::string("KB_PER_PATH=") + (shared_wavelengths ? "0" : "1"),
      std::string("KB_STAGED=") + (staged ? "1" : "0")};
  if (film_transposed) d.emplace_back("KB_FILM_TRANSPOSED=1");
  d.push_back("KB_SAMPLES_IN_REGISTERS=" + std::to_string(registers) + "u");
  return d;
}

VertexSpectra vertex_spectra(const SceneFeatures& f, bool specialised) {
  if (!specialised || f.bitmap || f.envmap_light || f.temperature_field || f.conductor || f.rough_conductor ||
      f.dispersion || f.gas)
    return VertexSpectra::kAny;
  const bool two = f.rough_dielectric || f.plastic || f.rough_plastic || f.principled;
  return two ? VertexSpectra::kRows : VertexSpectra::kOneReflectance;
}

EvaluationTask evaluation_task(const FlatScene& scene, Method method, bool shared_wavelengths,
                               bool specialised) {
  return {method, shared_wavelengths, static_cast<uint32_t>(scene.channels.size()),
          vertex_spectra(scene.features, specialised)};
}

EvaluationShape evaluation_shape(const DeviceInfo& device, const EvaluationTask& task,
                                 std::optional<uint32_t> largest_group) {
  EvaluationShape shape;
  shape.method = task.method;
  shape.shared_wavelengths = task.shared_wavelengths;
  shape.registers = samples_in_registers(device.type == DeviceType::kCpu);
  if (device.type == DeviceType::kCpu) {
    // SIMD comes from the vectors, not from the group: one work-item takes up to 128 channels at a time, and
    // walks a tile of pixels sample by sample while their dense spectra are
    // in the first cache (measured: validation/README.md).
    shape.width = 16;
    shape.vectors = static_cast<uint32_t>(std::min<uint64_t>(8, ceil_div(task.channels, 16)));
    shape.units_per_group = 16;
    return shape;
  }
  shape.film_transposed = task.method == Method::kDpeptPath;
  shape.staged = task.method == Method::kDpeptBatch;
  shape.vectors = 1;
  const auto at_most = [&](uint32_t usual) {
    return std::min<uint64_t>(device.max_work_group_size, largest_group.value_or(usual));
  };
  if (shape.staged) {
    put_pixels_side_by_side(task, at_most(kItemsOfPath), at_most(kItemsSideBySide), shape);
    shape.most_registers = most_registers(task, shape.vectors);
    return shape;
  }
  shape.width = task.channels >= 512 ? 4 : task.channels >= 128 ? 2 : 1;
  const uint64_t items = ceil_div(ceil_div(task.channels, shape.width), kWarp) * kWarp;
  shape.local_size = static_cast<uint32_t>(
      task.method == Method::kDpeptPath ? at_most(kPathsOfGroup) : std::min(items, at_most(kItemsOfPath)));
  return shape;
}

uint32_t fitting_local_size(const EvaluationShape& shape, uint64_t kernel_limit) {
  if (shape.group_size() <= kernel_limit) return shape.local_size;
  const uint64_t pixels = shape.group_size() / shape.local_size;
  const uint64_t items = std::max<uint64_t>(kernel_limit, 1) / pixels;
  if (items == 0)
    throw DeviceError("a work-group of this kernel can have " + std::to_string(kernel_limit) +
                      " work-items on this device, and " + std::to_string(pixels) + " pixels share one");
  return static_cast<uint32_t>(items >= 32 ? items / 32 * 32 : items);
}

uint64_t partial_bytes(const KbSpectraLayout& layout, const EvaluationShape& shape) {
  const bool of_pixels = shape.method == Method::kDpeptBatch;
  return of_pixels ? uint64_t{shape.local_size} * layout.derived * sizeof(float) : 0;
}

uint64_t table_bytes(const KbSpectraLayout& layout, const EvaluationShape& shape) {
  return shape.shared_wavelengths ? sizeof(float) * uint64_t{layout.rows} * layout.stride : 0;
}

uint64_t slot_bytes(const KbSpectraLayout& layout, const EvaluationShape& shape) {
  if (shape.method != Method::kPt) return 0;
  return sizeof(float) * (2 * uint64_t{layout.stride} + uint64_t{shape.local_size} * layout.derived);
}

Evaluation::Evaluation(DeviceContext& context, DeviceMemory& memory, const KbSpectraLayout& layout,
                       const EvaluationShape& shape, const std::vector<std::string>& defines,
                       bool program_cache, const PoolSize& pool, const DeviceFilm& film)
    : layout_(layout),
      shape_(shape),
      film_(film),
      buffers_{
          .dense = memory.allocate<float>("dense spectra",
                                          pool.tables * table_bytes(layout, shape) / sizeof(float)),
          .tau = memory.allocate<float>("throughputs", state_floats(layout, shape, pool)),
          .radiance = memory.allocate<float>("radiances", state_floats(layout, shape, pool)),
          .partial = memory.allocate<float>("derived channels", partial_floats(layout, shape, pool)),
          .parts = shape.local_size,
      },
      program_(build(context, main_file(shape.method), joined(defines, shape.defines(layout.derived)),
                     program_cache, shape.most_registers)),
      main_(program_.kernel(main_kernel(shape.method))) {
  shape_.local_size = fitting_local_size(shape, main_->max_work_group_size());
  buffers_.parts = shape_.local_size;
  if (layout.derived > 0 && shape.method != Method::kDpeptPath)
    derived_ = program_.kernel(shape.method == Method::kPt ? "pt_derived" : "derived_add");
  if (!shape.shared_wavelengths) return;
  resample_program_ = build(context, "evaluate/resample.cl", resample_defines(shape, defines), program_cache);
  resample_ = resample_program_->kernel("resample_rows");
}

void Evaluation::bind(const DeviceScene& scene, const DeviceSpectra& spectra, const PathPool& pool) {
  const auto bind_one = [&](EvaluationKernel& kernel, LaunchScale scale) {
    kernel.set(scene, spectra, pool.buffers(), buffers_, film_.arguments(0), pool.queue().slots);
    kernel->set_scale(scale);
  };
  const LaunchScale scale = shape_.method == Method::kPt ? LaunchScale::kSlots : LaunchScale::kPaths;
  bind_one(main_, scale);
  if (derived_) bind_one(*derived_, scale);
  if (resample_) bind_one(*resample_, LaunchScale::kPaths);
}

void Evaluation::resample(const KbRound& round) {
  if (!resample_) return;
  const uint64_t tables = uint64_t{round.blocks} * round.samples;
  (*resample_)->launch(tables * layout_.rows * layout_.stride / shape_.width, kLocalSize);
}

void Evaluation::evaluate(const KbRound& round, uint64_t film_pixel) {
  main_.set(film_.arguments(film_pixel, round.open != 0));
  if (shape_.method == Method::kDpeptPath) {
    main_->launch(round.pixels, shape_.local_size);
    return;
  }
  const uint64_t groups = ceil_div(round.pixels, shape_.units_per_group);
  main_->launch(groups * shape_.group_size(), shape_.group_size());
  if (!derived_) return;
  derived_->set(film_.arguments(film_pixel, round.open != 0));
  (*derived_)->launch(uint64_t{round.pixels} * layout_.derived, kLocalSize);
}

void Evaluation::update(const LaunchQueue& queue, uint64_t film_pixel) {
  if (queue.most == 0) return;
  main_.set(film_.arguments(film_pixel), queue.slots);
  const uint64_t groups = ceil_div(queue.most, shape_.units_per_group);
  main_->launch(groups * shape_.local_size, shape_.local_size);
  if (!derived_) return;
  derived_->set(film_.arguments(film_pixel), queue.slots);
  (*derived_)->launch(uint64_t{queue.most} * layout_.derived, kLocalSize);
}

}  // namespace kiloband::opencl
