#include "src_gpu/evaluate/device_replicates.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "film/moment_kernels.hpp"

namespace kiloband::opencl {
namespace {

constexpr uint64_t kFoldGroup = 64;
/// Pixels of a block that a work-item goes through: on GPUs few enough for many work-items, on CPU devices so few that their rows stay in
/// the caches from one vector of channels to the next (16: 0.6 of the time of 64 or 256).
constexpr uint32_t kGpuPixels = 256, kCpuPixels = 16;
/// Channels of a work-item of a CPU device, whose films are not transposed.
constexpr uint32_t kCpuWidth = 16;
/// Film values of a launch, which is to be short.
constexpr uint64_t kCpuValues = 1u << 22, kGpuValues = 1u << 26;

ProgramOptions fold_options(uint32_t width, bool transposed, bool cache) {
  ProgramOptions options;
  options.defines.push_back("KB_WIDTH=" + std::to_string(width));
  if (transposed) options.defines.emplace_back("KB_FILM_TRANSPOSED=1");
  options.disk_cache = cache;
  return options;
}

}  // namespace

uint64_t DeviceReplicates::bytes_per_pixel(const KbSpectraLayout& layout, bool variance) {
  constexpr uint64_t kSums = 1;  // 8 bytes for each column of a part
  return layout.film_columns * (sizeof(float) * (variance ? 2 : 1) + kSums) + sizeof(KbFloat2);
}

DeviceReplicates::DeviceReplicates(DeviceContext& context, DeviceMemory& memory,
                                   const KbSpectraLayout& layout,
                                   const DeviceBuffer<KbSpectraLayout>& device_layout, DeviceFilm& film,
                                   bool variance, bool program_cache, uint64_t pixels)
    : memory_(memory),
      layout_(layout),
      device_layout_(device_layout),
      film_(film),
      variance_(variance),
      on_cpu_(context.device().type == DeviceType::kCpu),
      width_(on_cpu_ && !film.form().transposed ? kCpuWidth : 1),
      mean_(memory.allocate<float>("means over replicates", pixels * layout.film_columns)),
      m2_(memory.allocate<float>("squares over replicates", variance ? mean_.size() : 0)),
      weights_(memory.allocate<KbFloat2>("weights of replicates", pixels)),
      program_(build_program(context, "film/replicates.cl",
                             fold_options(width_, film.form().transposed, program_cache))),
      fold_(program_.kernel("replicate_fold")) {}

uint32_t DeviceReplicates::pixels_of_part() const {
  return on_cpu_ ? kCpuPixels : kGpuPixels;
}

void DeviceReplicates::begin(std::span<const std::size_t> block_pixels) {
  folded_ = {};
  parts_.clear();
  block_of_part_.clear();
  uint32_t pixel = 0;
  for (std::size_t block = 0; block < block_pixels.size(); ++block) {
    for (auto left = static_cast<uint32_t>(block_pixels[block]); left > 0;) {
      const uint32_t some = std::min(left, pixels_of_part());
      parts_.push_back({pixel, some});
      block_of_part_.push_back(static_cast<uint32_t>(block));
      pixel += some;
      left -= some;
    }
  }
  folded_.samples.resize(pixel);
  folded_.replicates.resize(pixel);
  folded_.sums.resize(block_pixels.size());
  folded_.counts.resize(block_pixels.size());
  host_weights_.resize(pixel);
  device_parts_ = memory_.upload("parts of blocks", parts_);
  sums_ = memory_.allocate<float>("sums of parts", parts_.size() * layout_.film_columns);
  lost_ = memory_.allocate<float>("their rounding errors", sums_.size());
  mean_.clear();
  if (variance_) m2_.clear();
}

void DeviceReplicates::fold() {
  const uint64_t pixels = folded_.samples.size();
  film_.download_counts(pixels, counts_);
  weigh();
  weights_.upload(std::span<const KbFloat2>(host_weights_));
  launch();
  film_.clear_counts(pixels);
  add_sums();
  ++folded_.number;
}

/// What the replicate weighs in each pixel, by the host's own arithmetic.
void DeviceReplicates::weigh() {
  for (std::size_t p = 0; p < counts_.size(); ++p) {
    if (counts_[p] == 0) continue;
    const film::MomentWeights weights = film::moment_weights(folded_.samples[p], counts_[p]);
    host_weights_[p] = {weights.mean, weights.m2};
    folded_.samples[p] += counts_[p];
    ++folded_.replicates[p];
  }
}

void DeviceReplicates::launch() {
  const uint64_t columns = layout_.film_columns, of_part = pixels_of_part() * columns;
  const uint64_t at_once = std::max<uint64_t>((on_cpu_ ? kCpuValues : kGpuValues) / of_part, 1);
  for (uint64_t first = 0; first < parts_.size(); first += at_once) {
    const uint64_t end = std::min<uint64_t>(first + at_once, parts_.size());
    fold_.set(film_.arguments(0), ReplicatesArguments::Of<BufferRef>{
                                      .layout = device_layout_,
                                      .parts = device_parts_,
                                      .weights = weights_,
                                      .mean = mean_,
                                      .m2 = m2_,
                                      .sums = sums_,
                                      .lost = lost_,
                                      .first_part = static_cast<uint32_t>(first),
                                      .end_part = static_cast<uint32_t>(end),
                                      .variance = variance_ ? 1u : 0u,
                                  });
    fold_->launch((end - first) * columns / width_, kFoldGroup);
  }
}

/// The sums of parts to those of their blocks.
void DeviceReplicates::add_sums() {
  const std::vector<float> sums = std::as_const(sums_).download(), lost = std::as_const(lost_).download();
  const uint64_t values = film_values(layout_);
  for (auto& of_block : folded_.sums) of_block.resize(of_block.size() + values);
  for (auto& of_block : folded_.counts) of_block.push_back(0);
  for (std::size_t part = 0; part < parts_.size(); ++part) {
    double* const to = folded_.sums[block_of_part_[part]].data() + folded_.number * values;
    for (uint64_t v = 0; v < values; ++v) {
      const uint64_t column = v < layout_.channels ? v : layout_.stride + (v - layout_.channels);
      const std::size_t place = part * layout_.film_columns + column;
      to[v] += static_cast<double>(sums[place]) + lost[place];
    }
    const auto first = counts_.begin() + parts_[part].first;
    folded_.counts[block_of_part_[part]].back() +=
        std::accumulate(first, first + parts_[part].count, uint64_t{0});
  }
}

void DeviceReplicates::bring(const DeviceFilm::Pixels& pixels, std::vector<float>& mean,
                             std::vector<float>& m2) {
  film_.pack(pixels, mean_, mean);
  if (variance_) film_.pack(pixels, m2_, m2);
}

}  // namespace kiloband::opencl
