#include "viewer/api/stored_image.hpp"

#include <algorithm>
#include <limits>
#include <thread>

#include "cube/cube_layout.hpp"
#include "files/scratch_memory.hpp"
#include "viewer/api/json_text.hpp"

namespace kiloband::viewer {
namespace {

constexpr uint32_t kRowsAtOnce = 32;

class StoredPixels final : public PixelSource {
 public:
  StoredPixels(CubeReader& cube, std::size_t memory_bytes)
      : info_(cube.info()),
        means_(info_.width * std::size_t{info_.height} * info_.bands.size(), memory_bytes),
        variances_(info_.variance ? means_.values().size() : 0, memory_bytes) {
    for (const Band& band : info_.bands) {
      const bool density = info_.quantity == Quantity::kDensity && !band.derived;
      units_.push_back(density ? band.channel.width_nm() : 1);
    }
    const std::size_t row = info_.width * info_.bands.size();
    for (uint32_t y = 0; y < info_.height; y += kRowsAtOnce) {
      const uint32_t rows = std::min(kRowsAtOnce, info_.height - y);
      const auto part = [&](ScratchFloats& floats) { return floats.values().subspan(y * row, rows * row); };
      cube.read_rows(y, rows, part(means_), info_.variance ? part(variances_) : std::span<float>());
    }
  }

  uint32_t width() const override { return info_.width; }
  uint32_t height() const override { return info_.height; }
  const std::vector<Band>& bands() const override { return info_.bands; }
  const std::vector<double>& units() const override { return units_; }
  bool has_variances() const override { return info_.variance; }
  void means(uint32_t y, std::span<float> out) const override { copy_row(means_, y, out); }
  void band_means(uint32_t y, std::size_t band, std::span<float> out, std::vector<float>&) const override {
    const std::size_t bands = info_.bands.size(), first = y * (info_.width * bands) + band;
    for (std::size_t x = 0; x < info_.width; ++x) out[x] = means_.values()[first + x * bands];
  }
  void variances(uint32_t y, std::span<float> out) const override {
    if (info_.variance) return copy_row(variances_, y, out);
    std::ranges::fill(out, std::numeric_limits<float>::quiet_NaN());
  }
  uint32_t replicates() const override { return info_.replicates; }
  const CubeInfo& info() const { return info_; }

 private:
  void copy_row(const ScratchFloats& from, uint32_t y, std::span<float> out) const {
    const std::size_t row = info_.width * info_.bands.size();
    std::ranges::copy(from.values().subspan(y * row, row), out.begin());
  }

  CubeInfo info_;
  std::vector<double> units_;
  ScratchFloats means_, variances_;
};

class StoredImage final : public ViewedImage {
 public:
  StoredImage(CubeReader& cube, std::string name, std::size_t memory_bytes, unsigned threads)
      : pixels_(cube, memory_bytes), name_(std::move(name)), threads_(threads) {
    memory_ = info().width * std::size_t{info().height} * info().bands.size() * sizeof(float) *
              (info().variance ? 2 : 1);
  }

  nlohmann::json scene() override {
    return {{"kind", "cube"},
            {"name", name_},
            {"revision", 1},
            {"width", info().width},
            {"height", info().height},
            {"channels", channels_json(info().bands)},
            {"errors", info().variance},
            {"camera", nullptr}};
  }
  uint64_t scene_number() override { return 1; }

  ViewStatus status() override {
    ViewStatus status;
    status.newest = stamp();
    status.state = "done";
    if (info().samples_per_pixel > 0) status.target_samples = info().samples_per_pixel;
    status.memory_bytes = memory_;
    return status;
  }

  bool wait_for_frame(uint64_t after, std::chrono::milliseconds most) override {
    if (after < 1) return true;
    std::this_thread::sleep_for(most);
    return false;
  }
  bool read_newer(uint64_t after, std::chrono::milliseconds most,
                  const std::function<void(const ImageView&)>& look) override {
    if (!wait_for_frame(after, most)) return false;
    read(look);
    return true;
  }
  void read(const std::function<void(const ImageView&)>& look) override {
    look({pixels_, stamp(), false, info().width, info().height, [this] { return info().metadata; }});
  }
  unsigned threads() const override { return threads_; }
  RenderControls* controls() override { return nullptr; }

 private:
  const CubeInfo& info() const { return pixels_.info(); }
  FrameStamp stamp() const { return {1, 1, info().samples_per_pixel}; }

  StoredPixels pixels_;
  std::string name_;
  unsigned threads_;
  uint64_t memory_ = 0;
};

}  // namespace

std::unique_ptr<ViewedImage> open_stored_image(const std::filesystem::path& file, std::size_t memory_bytes,
                                               unsigned threads, const DiagnosticSink& sink) {
  const std::unique_ptr<CubeReader> cube = open_cube(file, sink);
  check_holds_radiances(file, cube->info());
  return std::make_unique<StoredImage>(*cube, file.filename().string(), memory_bytes, threads);
}

}  // namespace kiloband::viewer
