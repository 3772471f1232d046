#include "src_gpu/device_state.hpp"

#include <algorithm>
#include <stdexcept>

#include "src_gpu/scene/scene_arguments.hpp"

namespace kiloband::opencl {
namespace {

/// Rays of a launch that cannot be measured beforehand: short on any device.
constexpr uint32_t kAuxiliaryPixels = 1u << 15;
/// Of the kernels of path generation: 16 warps per multiprocessor at least. An H100 takes 0.74 to 0.99 of the time for `shade` that it takes
/// with 80 registers, which gives 24 warps and spills (validation/results/gpu_h100.md).
constexpr uint32_t kPathRegisters = 128;

/// A program's chunks where they are not the usual ones.
void add_chunk_define(std::vector<std::string>& defines, const HostScene& host, Method method) {
  const uint32_t slots = chunk_entries(method, host.scene.features);
  if (slots != KB_CHUNK_ENTRIES) defines.push_back("KB_CHUNK_ENTRIES=" + std::to_string(slots) + "u");
}

std::vector<std::string> evaluation_defines(const HostScene& host, const DeviceSettings& settings) {
  std::vector<std::string> defines = scene_defines(host.scene.features, settings.specialised);
  if (host.spectra.has_lines) defines.push_back("KB_SPECTRAL_LINES=1");
  add_chunk_define(defines, host, settings.method);
  return defines;
}

/// Entries of a work-item's stack, in steps: scenes whose trees differ a little share a program. On CPU devices, where what is not used of it
/// costs nothing, nearly all scenes do.
uint32_t bvh_stack(const DeviceInfo& device, const Bvh& bvh) {
  const uint32_t step = device.type == DeviceType::kCpu ? 96 : 8;
  return bvh.stack_entries() / step * step + step;
}

std::vector<std::string> path_defines(const DeviceInfo& device, const HostScene& host,
                                      const DeviceSettings& settings) {
  std::vector<std::string> defines = scene_defines(host.scene.features, settings.specialised);
  defines.push_back("KB_BVH_STACK=" + std::to_string(bvh_stack(device, host.bvh)));
  defines.push_back("KB_SLOTS_PER_ITEM=" + std::to_string(slots_per_item(device)));
  defines.push_back("KB_SHADING_KEYS=" + std::to_string(shading_keys(device, host.scene.features)) + "u");
  if (settings.method == Method::kPt) defines.push_back("KB_METHOD_PT=1");
  add_chunk_define(defines, host, settings.method);
  return defines;
}

}  // namespace

HostScene::HostScene(std::shared_ptr<const FlatScene> flat, const DerivedChannels& derived_channels)
    : kept(std::move(flat)),
      scene(*kept),
      derived(derived_channels),
      spectra(make_channel_tables(scene, derived)),
      bvh(build_bvh(scene)) {}

std::vector<double> HostScene::film_scale() const {
  std::vector<double> scale = scene.channel_scale;
  scale.insert(scale.end(), spectra.derived_scale.begin(), spectra.derived_scale.end());
  for (double& s : scale) s *= scene.filter_scale;
  return scale;
}

DeviceState::DeviceState(DeviceContext& device_context, const HostScene& host,
                         const DeviceSettings& device_settings)
    : context(device_context),
      memory(device_context, device_settings.memory_budget),
      method(device_settings.method),
      host_(host),
      settings_(device_settings),
      shape_(evaluation_shape(
          device_context.device(),
          evaluation_task(host.scene, method, settings_.shared_wavelengths, settings_.specialised),
          settings_.tuning.evaluation_group)),
      paths_(build_program(context, "path/paths.cl",
                           ProgramOptions{path_defines(context.device(), host, settings_),
                                          settings_.program_cache, kPathRegisters})),
      scene_(upload_scene(memory, host.scene)),
      bvh_(upload_bvh(memory, host.bvh)),
      spectra_(upload_spectra(memory, host.spectra)) {}

uint64_t DeviceState::film_bytes_per_pixel(FilmForm form) const {
  const KbSpectraLayout& layout = host_.spectra.layout;
  const uint64_t film = DeviceFilm::bytes_per_pixel(layout, form) + partial_bytes(layout, shape_);
  if (form.moments == FilmForm::Moments::kNone) return film;
  return film + DeviceReplicates::bytes_per_pixel(layout, form.moments == FilmForm::Moments::kMeanAndSquares);
}
uint64_t DeviceState::table_bytes() const {
  return opencl::table_bytes(host_.spectra.layout, shape_);
}
uint64_t DeviceState::slot_bytes() const {
  const uint64_t more = chunk_entries() - KB_CHUNK_ENTRIES;
  return opencl::slot_bytes(host_.spectra.layout, shape_) + more * sizeof(KbPathVertex);
}

void DeviceState::camera_moved() {
  const std::vector constants{scene_constants(host_.scene)};
  scene_.constants.upload(std::span(constants));
  const std::vector layout{host_.spectra.layout};
  spectra_.layout.upload(std::span(layout));
}

void DeviceState::release_pool() {
  evaluation_.reset();
  replicates_.reset();
  film_.reset();
  pool_.reset();
}

void DeviceState::make_pool(const PoolSize& size, uint64_t film_pixels, FilmForm form) {
  release_pool();
  pool_.emplace(context, memory, paths_, scene_, bvh_, spectra_, size,
                settings_.tuning.path_group.value_or(kPoolLocalSize));
  form.transposed = shape_.film_transposed;
  film_.emplace(context, memory, host_.spectra.layout, spectra_.layout, form, settings_.program_cache,
                film_pixels);
  if (form.moments != FilmForm::Moments::kNone)
    replicates_.emplace(context, memory, host_.spectra.layout, spectra_.layout, *film_,
                        form.moments == FilmForm::Moments::kMeanAndSquares, settings_.program_cache,
                        film_pixels);
  evaluation_.emplace(context, memory, host_.spectra.layout, shape_, evaluation_defines(host_, settings_),
                      settings_.program_cache, size, *film_);
  evaluation_->bind(scene_, spectra_, *pool_);
}

RoundOutcome DeviceState::generate(const KbRound& round, std::span<const KbRoundPixel> pixels,
                                   std::span<const float> mu, uint64_t film_pixel) {
  pool_->begin(round, pixels, mu);
  evaluation_->resample(round);
  if (method != Method::kPt) return pool_->run(round);
  return pool_->run(round, [&](const LaunchQueue& queue) { evaluation_->update(queue, film_pixel); });
}

void DeviceState::evaluate(const KbRound& round, uint64_t film_pixel) {
  if (method != Method::kPt) evaluation_->evaluate(round, film_pixel);
}

std::vector<AuxiliaryPixel> DeviceState::auxiliary(const PixelRect& rect) {
  release_pool();  // its memory may be all there is
  AuxiliaryKernel kernel(paths_.kernel("auxiliary"));
  kernel.set(scene_, bvh_);
  DeviceBuffer<KbFaults> faults = memory.upload("faults", std::vector<KbFaults>(1));
  const uint32_t rows_at_once = std::max(kAuxiliaryPixels / rect.width, 1u);
  DeviceBuffer<KbAuxiliary> out = memory.allocate<KbAuxiliary>(
      "auxiliary images", uint64_t{std::min(rows_at_once, rect.height)} * rect.width);
  std::vector<AuxiliaryPixel> pixels;
  for (uint32_t y = 0; y < rect.height; y += rows_at_once) {
    const uint32_t count = std::min(rows_at_once, rect.height - y) * rect.width;
    kernel.set(AuxiliaryArguments::Of<BufferRef>{
        .out = out, .faults = faults, .x0 = rect.x0, .y0 = rect.y0 + y, .width = rect.width, .count = count});
    kernel->launch(count, 64);
    std::vector<KbAuxiliary> values(count);
    const DeviceBuffer<KbAuxiliary>& device_values = out;
    device_values.download(std::span<KbAuxiliary>(values));
    for (const KbAuxiliary& v : values)
      pixels.push_back({v.depth, {v.normal[0], v.normal[1], v.normal[2]}, v.object, v.material});
  }
  throw_for_bugs(faults.read(0));
  return pixels;
}

}  // namespace kiloband::opencl
