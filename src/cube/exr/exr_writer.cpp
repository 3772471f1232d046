// Spectral EXR: FLOAT, tiled, uncompressed, tiles in the order in which they come (RANDOM_Y), so that nothing
// is buffered but one tile.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfTiledOutputFile.h>

#include <algorithm>
#include <map>
#include <stdexcept>

#include "cube/band_planes.hpp"
#include "cube/cube_layout.hpp"
#include "cube/exr/exr_layout.hpp"
#include "cube/exr/exr_stream.hpp"
#include "files/atomic_file.hpp"
#include "files/file_set.hpp"

namespace kiloband {
namespace {

constexpr uint64_t kMaxTileBytes = uint64_t{1} << 26;

/// 32, the renderer's block, halved while a tile of so many channels would pass 64 MiB. Measured for 1 GB
/// files of 100, 1000 and 4000 channels: edges of 8, 16 and 32 take the same processor time to write and to
/// read (within 10 %).
uint32_t choose_tile_edge(std::size_t channels) {
  uint32_t edge = 32;
  while (edge > 1 && uint64_t{edge} * edge * channels * sizeof(float) > kMaxTileBytes) edge /= 2;
  return edge;
}

/// Weight of a band in R, G, B, for the bands that have any.
struct PreviewTerm {
  std::size_t band;
  std::array<float, 3> weight;  // of values as they are given
};

std::vector<PreviewTerm> preview_terms(const std::vector<Band>& bands, Quantity given) {
  std::vector<PreviewTerm> terms;
  const auto weights = preview_weights(bands);
  for (std::size_t k = 0; k < bands.size(); ++k) {
    const bool density = given == Quantity::kDensity && !bands[k].derived;
    const auto scale = density ? static_cast<float>(bands[k].channel.width_nm()) : 1.0f;
    const auto& w = weights[k];
    if (w[0] != 0 || w[1] != 0 || w[2] != 0) terms.push_back({k, {w[0] * scale, w[1] * scale, w[2] * scale}});
  }
  return terms;
}

class ExrWriter : public CubeWriter {
 public:
  ExrWriter(const std::filesystem::path& file, const CubeInfo& info, uint32_t rows_per_strip, Quantity given)
      : layout_(plan_exr(info, file.string())),
        order_(info, rows_per_strip),
        conversion_(info.bands, given, info.quantity),
        preview_(preview_terms(info.bands, given)),
        bands_(info.bands.size()),
        slots_(bands_ + layout_.variances.size() + 3 + info.aux.size()),
        edge_(choose_tile_edge(slots_)),
        staging_(std::size_t{edge_} * edge_ * slots_),
        file_(file),
        stream_(file_) {
    const uint64_t tiles = uint64_t{(info.width + edge_ - 1) / edge_} * ((info.height + edge_ - 1) / edge_);
    file_.preallocate(uint64_t{info.width} * info.height * slots_ * sizeof(float) + tiles * kChunkOverhead);
  }

  void set_counts(const SampleCounts& counts) override {
    layout_.info.samples_per_pixel = counts.samples_per_pixel;
    layout_.info.replicates = counts.replicates;
    layout_.info.replicate_samples = counts.replicate_samples;
  }

  void write_rows(const CubeRows& strip) override {
    order_.accept(strip);
    if (!output_) guarded([&] { write_header(); });
    for (uint32_t y = 0; y < strip.rows; y += edge_)
      for (uint32_t x = 0; x < layout_.info.width; x += edge_) {
        stage_tile(strip, x, y);
        guarded([&] {
          output_->writeTile(static_cast<int>(x / edge_), static_cast<int>((strip.y0 + y) / edge_));
        });
      }
  }

  uint64_t overflowed_values() const override { return conversion_.overflowed_values(); }
  uint64_t overflowed_variances() const override { return conversion_.overflowed_variances(); }

  void close(FileSet& files) override {
    order_.finish();
    output_.reset();  // writes the table of tile offsets
    guarded([&] {
      rewrite_counts();
      stream_.flush();
    });
    files.add(file_);
  }

 private:
  static constexpr uint64_t kChunkOverhead = 20 + 8;  // tile coordinates and size, entry in the offset table

  /// OpenEXR's failures while writing are the disk's (which the stream knows better) or ours.
  template <class Action>
  void guarded(Action&& action) {
    try {
      action();
    } catch (const std::exception& error) {
      stream_.rethrow_failure();
      throw std::logic_error("EXR writer: " + std::string(error.what()));
    }
    stream_.rethrow_failure();
  }

  void write_header() {
    Imf::Header header(static_cast<int>(layout_.info.width), static_cast<int>(layout_.info.height));
    header.compression() = Imf::NO_COMPRESSION;
    header.lineOrder() = Imf::RANDOM_Y;
    header.setTileDescription(Imf::TileDescription(edge_, edge_, Imf::ONE_LEVEL));
    write_exr_attributes(header, layout_);
    output_ = std::make_unique<Imf::TiledOutputFile>(stream_, header, 0);
    output_->setFrameBuffer(frame_buffer());
    stream_.head_ends();
    counts_ = exr_count_texts(layout_.info);
  }

  /// The header came before the rows. Where there turned out to be fewer samples its texts are replaced by shorter ones, and blanks.
  void rewrite_counts() {
    std::map<std::string, std::string> now = exr_count_texts(layout_.info);
    for (const auto& [name, text] : counts_) {
      std::string replacement = now.contains(name) ? now[name] : "0";
      if (replacement == text) continue;
      if (replacement.size() > text.size()) throw std::logic_error(name + " has become longer");
      replacement.resize(text.size(), ' ');
      const std::string before = name + '\0' + "string" + '\0';
      const std::size_t found = stream_.head().find(before);
      if (found == std::string::npos) throw std::logic_error(name + " is not in the header");
      stream_.seekp(found + before.size() + sizeof(uint32_t));  // behind the text's length
      stream_.write(replacement.data(), static_cast<int>(replacement.size()));
    }
  }

  /// The staging buffer is [y][slot][x] of one tile, the order of an uncompressed chunk up
  /// to the names' order.
  Imf::FrameBuffer frame_buffer() {
    Imf::FrameBuffer frame;
    std::size_t slot = 0;
    const auto add = [&](const std::string& name) {
      auto* base = reinterpret_cast<char*>(staging_.data() + edge_ * slot++);
      frame.insert(name, Imf::Slice(Imf::FLOAT, base, sizeof(float), sizeof(float) * edge_ * slots_, 1, 1,
                                    0.0, true, true));
    };
    for (const std::string& name : layout_.means) add(name);
    for (const std::string& name : layout_.variances) add(name);
    for (const std::string_view name : kPreviewChannels) add(std::string(name));
    for (const std::string& name : layout_.info.aux) add(name);
    return frame;
  }

  float* staging_row(uint32_t y, std::size_t slot) { return staging_.data() + (y * slots_ + slot) * edge_; }

  /// Fills the staging buffer from the strip's pixels at (x0, y0), y0 counted from the strip's first row.
  void stage_tile(const CubeRows& strip, uint32_t x0, uint32_t y0) {
    const uint32_t width = layout_.info.width;
    const uint32_t columns = std::min(edge_, width - x0), rows = std::min(edge_, strip.rows - y0);
    const std::size_t aux = layout_.info.aux.size(), variances = layout_.variances.size();
    for (uint32_t y = 0; y < rows; ++y) {
      const std::size_t pixel = std::size_t{y0 + y} * width + x0;
      const auto put = [&](std::span<const float> values, std::size_t planes, std::size_t slot, auto change) {
        to_planes(values.data() + pixel * planes, columns, planes, 0, planes, staging_row(y, slot), edge_,
                  change);
      };
      put(strip.mean, bands_, 0, [&](auto... band) { conversion_.values(band...); });
      put(strip.variance, variances, bands_, [&](auto... band) { conversion_.variances(band...); });
      stage_preview(strip.mean.data() + pixel * bands_, columns, staging_row(y, bands_ + variances));
      put(strip.aux, aux, bands_ + variances + 3,
          [](std::size_t, const float* from, float* to, std::size_t n) { std::copy_n(from, n, to); });
    }
  }

  void stage_preview(const float* mean, uint32_t columns, float* to) const {
    for (uint32_t x = 0; x < columns; ++x, mean += bands_) {
      std::array<float, 3> rgb = {};
      for (const PreviewTerm& term : preview_)
        for (std::size_t c = 0; c < 3; ++c) rgb[c] += term.weight[c] * mean[term.band];
      for (std::size_t c = 0; c < 3; ++c) to[c * edge_ + x] = rgb[c];
    }
  }

  ExrLayout layout_;
  StripOrder order_;
  QuantityConversion conversion_;
  std::vector<PreviewTerm> preview_;
  std::size_t bands_, slots_;
  uint32_t edge_;  // of a tile, pixels; divides 32
  std::vector<float> staging_;
  AtomicFile file_;
  ExrOutputStream stream_;
  std::unique_ptr<Imf::TiledOutputFile> output_;
  std::map<std::string, std::string> counts_;  // as the header has them
};

}  // namespace

std::unique_ptr<CubeWriter> create_exr_writer(const std::filesystem::path& file, const CubeInfo& info,
                                              uint32_t rows_per_strip, Quantity given) {
  return std::make_unique<ExrWriter>(file, info, rows_per_strip, given);
}

}  // namespace kiloband
