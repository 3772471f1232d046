#include "src_gpu/opencl_backend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>
#include <utility>

#include "src_gpu/delivery_pace.hpp"
#include "src_gpu/device/device.hpp"
#include "src_gpu/device/neutral_folder.hpp"
#include "src_gpu/device/pocl_cache.hpp"
#include "src_gpu/film_delivery.hpp"
#include "src_gpu/group_renderer.hpp"
#include "src_gpu/told_samples.hpp"
#include "src_gpu/tuning/tuning_store.hpp"

namespace kiloband::opencl {
namespace {

constexpr std::size_t kReportedInvalid = 16;
/// A device that is lost again and again, with nothing done in between, is not worth more attempts.
constexpr uint32_t kMostLosses = 3;
/// Halvings of the memory in use after a device refused what it had promised.
constexpr uint32_t kMostRetreats = 6;

/// Progress as it is told to who may be in any folder. Both must outlive it.
std::function<void(uint64_t)> outside(const NeutralFolder& neutral,
                                      const std::function<void(uint64_t)>& progress) {
  if (!progress) return {};
  return [&](uint64_t samples) { neutral.from_outside([&] { progress(samples); }); };
}

/// Of the film's sums, what the device has a copy of: those of these blocks, while the film has this seal.
struct LeftSums {
  uint64_t seal = 0;
  uint32_t replicate = 0;
  std::vector<uint32_t> blocks;
};

/// Replicates that have come to the film, and what they took.
struct Delivered {
  uint32_t replicates = 0;
  RunTally tally;
};

class Renderer final : public Backend {
 public:
  Renderer(std::shared_ptr<HostScene> host, const SamplingSettings& settings, const Options& options,
           DeviceInfo device)
      : options_(options),
        settings_(settings),
        host_(std::move(host)),
        method_(options.method.value_or(kDefaultMethod)),
        context_(std::move(device), {.profiling = true, .shared = true}) {
    limit_memory();
    if (options_.tuned) options_.tuning = merged(options_.tuning, kept_tuning());
    const NeutralFolder neutral;
    repeated([] {});
    rule_ = groups_->sum_rule();
    warn_of_cache();
  }

  void render(SpectralFilm& film, const SampleRange& range, const std::vector<uint32_t>& blocks,
              const std::atomic<bool>& stop, const std::function<void(uint64_t)>& progress) override;
  uint32_t render_replicates(SpectralFilm& film, const ReplicatePlan& plan, const std::atomic<bool>& stop,
                             const std::function<void(uint64_t)>& progress) override;
  std::vector<AuxiliaryPixel> auxiliary(const PixelRect& rect) override;

  std::vector<TracedPath> trace(const PixelRect& rect, const SampleRange& range) override {
    const NeutralFolder neutral;
    return repeated([&] { return groups_->trace(pixels_of(std::span(&rect, 1)), range); });
  }

  void camera_moved() override {
    host_->spectra.layout.film_width = host_->scene.camera.film_width;
    repeated([&] { state_->camera_moved(); });
  }

  BackendInfo info() const override {
    const DeviceInfo& device = context_.device();
    return {"opencl", device.name, "opencl " + device.driver_version, to_string(method_)};
  }
  BackendStatistics statistics() const override;
  std::vector<double> film_scale() const override { return host_->film_scale(); }

  SumRule sum_rule() const override { return rule_; }
  /// After a device that could not be set up again there are no groups.
  uint32_t blocks_at_once(uint32_t samples) const override {
    return groups_ ? groups_->blocks_at_once(samples) : 1;
  }

 private:
  void limit_memory();
  Tuning kept_tuning() const;
  void warn_of_cache() const;
  void make_device();
  void recover(const DeviceLost& loss);
  void retreat(const DeviceOutOfMemory& refusal);
  /// Calls `work` until it gets through without losing the device, which is set up where need be.
  template <class Work>
  std::invoke_result_t<Work> repeated(const Work& work);
  void render_group(std::span<const ImagePixel> pixels, const SampleRange& range, const SumsBefore* before,
                    const std::atomic<bool>& stop, ToldSamples& told);
  void add_replicates(SpectralFilm& film, const ReplicatePlan& plan, const std::atomic<bool>& stop,
                      ToldSamples& told, Delivered& delivered);
  void count(const RunTally& tally);

  Options options_;
  SamplingSettings settings_;
  std::shared_ptr<HostScene> host_;  // of all devices that render it
  Method method_;
  DeviceContext context_;
  std::unique_ptr<DeviceState> state_;
  std::unique_ptr<GroupRenderer> groups_;
  GroupResult result_;  // of the group that was rendered last
  FilmSums before_;     // of the group that was gone on with last
  LeftSums left_;
  SumRule rule_;
  uint32_t losses_in_a_row_ = 0;
  BackendStatistics done_;  // but for what the context and the device memory know
  uint32_t retreats_ = 0;
};

/// A budget beyond the device's memory would let allocations through that fail when they are used.
void Renderer::limit_memory() {
  const uint64_t most = context_.device().global_memory;
  if (!options_.device_memory || *options_.device_memory <= most) return;
  note(options_.sink, {},
       fmt::format("device memory: device '{}' has {} MiB, not {} MiB: these are used",
                   context_.device().name, most >> 20, *options_.device_memory >> 20));
  options_.device_memory = most;
}

/// What `kiloband tune` found for the device.
Tuning Renderer::kept_tuning() const {
  const EvaluationTask task = evaluation_task(
      host_->scene, method_, settings_.wavelengths == WavelengthMode::kShared, options_.specialised);
  return tuning_for(TuningStore::of_user().load(context_.device()), to_string(method_), task.channels,
                    evaluation_shape(context_.device(), task).local_size);
}

/// One warning: without a cache the render goes on, and the next one compiles again.
void Renderer::warn_of_cache() const {
  const std::string pocl = context_.device().is_pocl() ? pocl_cache_problem() : "";
  if (!pocl.empty()) {
    warn(options_.sink, {}, pocl);
  } else if (!context_.cache_problem().empty()) {
    warn(options_.sink, {},
         context_.cache_problem() + ": compiled kernels are not kept, and every run compiles anew");
  }
}

void Renderer::make_device() {
  groups_.reset();
  state_.reset();
  // PoCL keeps what it compiles itself; before it hands out a binary it compiles every kernel a second time, for groups of any size.
  const bool program_cache = options_.program_cache && !context_.device().is_pocl();
  state_ = std::make_unique<DeviceState>(
      context_, *host_,
      DeviceSettings{method_, settings_.wavelengths == WavelengthMode::kShared, options_.specialised,
                     program_cache, options_.device_memory, options_.tuning});
  groups_ = std::make_unique<GroupRenderer>(*state_, settings_, options_.launch_seconds, options_.tuning,
                                            options_.sink);
}

/// After a lost device: everything on it is made anew, and the work is repeated.
void Renderer::recover(const DeviceLost& loss) {
  ++done_.device_losses;
  if (++losses_in_a_row_ > kMostLosses) {
    context_.abandon();
    throw loss;
  }
  note(options_.sink, {}, fmt::format("{}: device lost, context rebuilt, work repeated", loss.what()));
  groups_.reset();
  if (state_) done_.device_memory_bytes = std::max(done_.device_memory_bytes, state_->memory.peak());
  state_.reset();
  context_.rebuild();
}

template <class Work>
std::invoke_result_t<Work> Renderer::repeated(const Work& work) {
  for (;;) {
    try {
      if (!groups_) make_device();
      return work();
    } catch (const DeviceLost& loss) {
      recover(loss);
    }
  }
}

/// The device refused memory in the middle of work: everything is made anew, with half of what was in use beside the scene. Where the
/// scene itself was refused, after a loss of the device, less would not help.
void Renderer::retreat(const DeviceOutOfMemory& refusal) {
  if (!state_ || ++retreats_ > kMostRetreats) throw refusal;
  const uint64_t peak = state_->memory.peak();
  groups_.reset();
  state_->release_pool();
  const uint64_t scene = state_->memory.used();
  options_.device_memory = scene + (peak - scene) / 2;
  note(options_.sink, {},
       fmt::format("{}: at most {} MiB of device memory from now on", refusal.what(),
                   *options_.device_memory >> 20));
  done_.device_memory_bytes = std::max(done_.device_memory_bytes, peak);
  repeated([] {});
}

BackendStatistics Renderer::statistics() const {
  BackendStatistics done = done_;
  if (state_) done.device_memory_bytes = std::max(done.device_memory_bytes, state_->memory.peak());
  if (groups_) done.pool_slots = groups_->pool_slots();
  done.kernel_seconds = context_.kernel_seconds();
  done.device_waits = context_.waits();
  done.kernel_launches = context_.kernel_launches();
  return done;
}

/// Of work that has got through.
void Renderer::count(const RunTally& tally) {
  losses_in_a_row_ = 0;
  done_.rays += tally.rays;
  done_.vertices += tally.vertices;
  done_.paths += tally.paths;
  done_.device_rounds += tally.rounds;
  done_.invalid_samples += tally.invalid;
  done_.longest_launch_seconds = std::max(done_.longest_launch_seconds, tally.longest_launch_seconds);
  for (const InvalidSample& sample : tally.invalid_samples) {
    if (done_.first_invalid.size() < kReportedInvalid) done_.first_invalid.push_back(sample);
  }
}

void Renderer::render_group(std::span<const ImagePixel> pixels, const SampleRange& range,
                            const SumsBefore* before, const std::atomic<bool>& stop, ToldSamples& told) {
  repeated([&] {
    RunTally tally;
    told.begin_attempt();
    groups_->render(
        pixels, range, before, stop, [&](uint64_t samples) { told.add(samples); }, tally, result_);
    count(tally);
  });
}

void Renderer::render(SpectralFilm& film, const SampleRange& range, const std::vector<uint32_t>& blocks,
                      const std::atomic<bool>& stop, const std::function<void(uint64_t)>& progress) {
  const NeutralFolder neutral;
  ToldSamples told(outside(neutral, progress));
  std::vector<PixelRect> rects;
  for (const uint32_t block : blocks) rects.push_back(film.blocks()[block]);
  const std::vector<ImagePixel> pixels = pixels_of(rects);
  FilmDelivery delivery(film, range, blocks, film_scale().size());
  const bool sums = film.keeps_sums();
  const bool left = sums && left_.seal != 0 && left_.seal == film.seal() &&
                    left_.replicate == range.replicate && left_.blocks == blocks;
  left_ = {};
  bool in_one = false;
  const std::atomic<bool> never{false};
  for (std::size_t at = 0; at < pixels.size();) {
    const std::size_t room =
        repeated([&] { return groups_->group_pixels(pixels.size(), sums, range.count); });
    const bool in_block = delivery.in_block();
    const std::size_t number = in_block ? std::min(room, delivery.missing()) : whole_blocks(pixels, at, room);
    const std::span<const ImagePixel> group = std::span(pixels).subspan(at, number);
    // The parts of a block that is larger than a group get the same samples, stopped or not.
    SampleRange part = range;
    if (in_block) part.count = delivery.attempted();
    in_one = number == pixels.size();
    const SumsBefore before{left && in_one, [&]() -> const FilmSums& {
                              delivery.read_sums(group, before_);
                              return before_;
                            }};
    try {
      render_group(group, part, sums ? &before : nullptr, in_block ? never : stop, told);
      delivery.add(result_);
      told.deliver();
      at += number;
    } catch (const DeviceOutOfMemory& refusal) {
      retreat(refusal);  // and the same pixels again, fewer at a time
    }
  }
  if (sums && in_one) left_ = {film.seal_sums(), range.replicate, blocks};
}

/// On the device, from where they come to the film at their end, and now and then before, so that not all is lost with the device.
/// delivered  what the film has
void Renderer::add_replicates(SpectralFilm& film, const ReplicatePlan& plan, const std::atomic<bool>& stop,
                              ToldSamples& told, Delivered& delivered) {
  using Moments = FilmForm::Moments;
  const std::vector<ImagePixel> pixels = pixels_of(film.blocks());
  std::vector<std::size_t> block_pixels;
  for (const PixelRect& block : film.blocks()) block_pixels.push_back(block.pixels());
  const bool open = film.keeps_sums();
  const Moments moments = film.options().variance ? Moments::kMeanAndSquares : Moments::kMean;
  const auto samples_of = [&](uint32_t r) { return static_cast<uint32_t>(plan.size(r)); };
  if (!groups_->begin_replicates(block_pixels, {.open = open, .moments = moments}, samples_of(0))) return;
  DeliveryPace pace;
  RunTally tally;
  for (uint32_t r = 0; r < plan.replicates; ++r) {
    const auto on_samples = [&](uint64_t samples) { told.add(samples); };
    const SampleRange range{r, 0, samples_of(r)};
    const uint32_t done = groups_->add_replicate(pixels, range, open, stop, on_samples, tally);
    if (done < range.count || r + 1 == plan.replicates || pace.is_due()) {
      delivered = {};  // of some blocks, should the device fail meanwhile: all is rendered again
      pace.measured([&] { deliver_replicates(film, groups_->replicates()); });
      delivered = {groups_->replicates().folded().number, tally};
      told.deliver();
      losses_in_a_row_ = 0;
    }
    if (done < range.count) return;
  }
}

uint32_t Renderer::render_replicates(SpectralFilm& film, const ReplicatePlan& plan,
                                     const std::atomic<bool>& stop,
                                     const std::function<void(uint64_t)>& progress) {
  if (plan.size(0) > DeviceReplicates::kMostSamples) return 0;
  const NeutralFolder neutral;
  left_ = {};
  ToldSamples told(outside(neutral, progress));
  uint32_t attempts = 0;
  Delivered delivered;
  try {
    repeated([&] {
      told.begin_attempt();
      if (delivered.replicates > 0) return;
      if (attempts++ > 0) forget_replicates(film);
      add_replicates(film, plan, stop, told, delivered);
    });
  } catch (const DeviceOutOfMemory& refusal) {
    if (delivered.replicates == 0) forget_replicates(film);
    retreat(refusal);
  }
  if (delivered.replicates > 0) count(delivered.tally);
  return delivered.replicates;
}

std::vector<AuxiliaryPixel> Renderer::auxiliary(const PixelRect& rect) {
  const NeutralFolder neutral;
  return repeated([&] { return state_->auxiliary(rect); });
}

}  // namespace

std::unique_ptr<Backend> make_backend(std::shared_ptr<const FlatScene> scene, const DerivedChannels& derived,
                                      const SamplingSettings& settings, const Options& options) {
  return backend_maker(std::move(scene), derived, settings, select_device(options.device))(options);
}

BackendMaker backend_maker(std::shared_ptr<const FlatScene> scene, const DerivedChannels& derived,
                           const SamplingSettings& settings, const DeviceInfo& device) {
  return [host = std::make_shared<HostScene>(std::move(scene), derived), settings,
          device](const Options& options) -> std::unique_ptr<Backend> {
    return std::make_unique<Renderer>(host, settings, options, device);
  };
}

std::vector<std::unique_ptr<Backend>> make_backends(std::shared_ptr<const FlatScene> scene,
                                                    const DerivedChannels& derived,
                                                    const SamplingSettings& settings,
                                                    const Options& options) {
  const std::vector<DeviceInfo> devices = select_devices(options.device);
  const auto host = std::make_shared<HostScene>(std::move(scene), derived);
  std::vector<std::unique_ptr<Backend>> backends;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    try {
      backends.push_back(std::make_unique<Renderer>(host, settings, options, devices[i]));
    } catch (const DeviceError& failure) {
      const bool last_hope = backends.empty() && i + 1 == devices.size();
      if (last_hope) throw;
      warn(options.sink, {},
           fmt::format("{}: the render goes without it (device {} of {})", failure.what(), i + 1,
                       devices.size()));
    }
  }
  return backends;
}

BackendEntry backend_entry() {
  return {
      "opencl",
      {to_string(Method::kDpeptBatch), to_string(Method::kDpeptPath), to_string(Method::kPt)},
      [](const BackendInput& input, const BackendRequest& request, const std::optional<std::string>& method) {
        Options options;
        options.device = request.device;
        options.device_memory = request.device_memory;
        if (method) options.method = find_method(*method);
        options.specialised = request.specialised;
        options.sink = request.sink;
        return make_backends(input.scene, input.derived, input.sampling, options);
      }};
}

}  // namespace kiloband::opencl
