// Spectral EXR files, ours and others': tiled or in scan lines, any compression, FLOAT, HALF or UINT.
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfTiledInputFile.h>

#include <algorithm>

#include "cube/cube_layout.hpp"
#include "cube/exr/exr_layout.hpp"
#include "cube/exr/exr_scan.hpp"
#include "cube/exr/exr_stream.hpp"
#include "files/input_file.hpp"

namespace kiloband {
namespace {

/// Some channels of the file and where their values go: [row][x][channel].
struct Planes {
  const std::vector<std::string>* channels;
  float* out;
};

class ExrReader : public CubeReader {
 public:
  ExrReader(const std::filesystem::path& file, const DiagnosticSink& sink)
      : bytes_(file), where_(file.string()), storage_(scan_exr(bytes_)), stream_(bytes_) {
    guarded([&] {
      layout_ = read_exr_layout(storage_.header, where_, sink);
      if (storage_.tiled)
        tiled_ = std::make_unique<Imf::TiledInputFile>(stream_, 0);
      else
        lines_ = std::make_unique<Imf::InputFile>(stream_, 0);
      if (!(storage_.tiled ? tiled_->isComplete() : lines_->isComplete()))
        throw InputError(where_ + ": the EXR file is incomplete: parts of the image were never written");
    });
  }

  const CubeInfo& info() const override { return layout_.info; }

  void read_rows(uint32_t y0, uint32_t rows, std::span<float> mean, std::span<float> variance) override {
    check_read(info(), y0, rows, mean.size(), info().bands.size());
    check_read(info(), y0, rows, variance.size(), variance.empty() ? 0 : layout_.variances.size());
    std::vector<Planes> wanted = {{&layout_.means, mean.data()}};
    if (!variance.empty()) wanted.push_back({&layout_.variances, variance.data()});
    read(y0, rows, wanted);
  }

  void read_aux(uint32_t y0, uint32_t rows, std::span<float> aux) override {
    check_read(info(), y0, rows, aux.size(), info().aux.size());
    if (!aux.empty()) read(y0, rows, {{&info().aux, aux.data()}});
  }

 private:
  /// Whatever OpenEXR complains about is the file's fault, unless the disk failed.
  template <class Action>
  void guarded(Action&& action) {
    try {
      action();
    } catch (const InputError&) {
      throw;
    } catch (const std::exception& error) {
      stream_.rethrow_failure();
      throw InputError(where_ + ": not a readable EXR file: " + error.what());
    }
  }

  void read(uint32_t y0, uint32_t rows, const std::vector<Planes>& wanted) {
    if (rows == 0) return;
    guarded([&] {
      if (storage_.tiled && fits_kept_row(y0, rows, wanted))
        read_kept_row(y0, rows, wanted);
      else if (storage_.tiled)
        read_tiles(y0, rows, wanted);
      else
        read_lines(y0, rows, wanted);
    });
  }

  /// Straight into the caller's memory.
  void read_lines(uint32_t y0, uint32_t rows, const std::vector<Planes>& wanted) {
    const auto& window = storage_.header.dataWindow();
    const int first = window.min.y + static_cast<int>(y0);
    Imf::FrameBuffer frame;
    for (const Planes& planes : wanted) {
      const std::size_t x_stride = planes.channels->size() * sizeof(float),
                        y_stride = x_stride * info().width;
      for (std::size_t c = 0; c < planes.channels->size(); ++c) {
        // OpenEXR adds coordinates times strides, which may be negative: wrap-around is intended.
        const uintptr_t base = reinterpret_cast<uintptr_t>(planes.out + c) -
                               static_cast<uintptr_t>(int64_t{window.min.x}) * x_stride -
                               static_cast<uintptr_t>(int64_t{first}) * y_stride;
        frame.insert((*planes.channels)[c],
                     Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(base), x_stride, y_stride));
      }
    }
    lines_->setFrameBuffer(frame);
    lines_->readPixels(first, first + static_cast<int>(rows) - 1);
  }

  /// Tile by tile through a staging buffer [y][channel][x] (the order inside a file), of which the wanted
  /// rows are transposed. Most of the time is OpenEXR's own decoding, 6 ns per number.
  void read_tiles(uint32_t y0, uint32_t rows, const std::vector<Planes>& wanted) {
    set_tile_buffer(wanted);
    const uint32_t last_row = (y0 + rows - 1) / storage_.tile_height;
    const uint32_t columns = (info().width - 1) / storage_.tile_width + 1;
    for (uint32_t ty = y0 / storage_.tile_height; ty <= last_row; ++ty)
      for (uint32_t tx = 0; tx < columns; ++tx) {
        tiled_->readTile(static_cast<int>(tx), static_cast<int>(ty));
        copy_tile(tx, ty, y0, rows, wanted);
      }
  }

  /// A part of one row of tiles, of which more may be asked for next.
  bool fits_kept_row(uint32_t y0, uint32_t rows, const std::vector<Planes>& wanted) const {
    std::size_t values = 0;
    for (const Planes& planes : wanted)
      values += std::size_t{info().width} * tile_rows() * planes.channels->size();
    const uint32_t first = y0 % storage_.tile_height;
    return rows < tile_rows() && first + rows <= tile_rows() && values <= kMostKept;
  }

  /// Who asks for a second part of a row of tiles asks for the others, too: then it is decoded whole, and kept until its end was asked for. A
  /// single look at a row, as at each replicate's, leaves nothing behind.
  void read_kept_row(uint32_t y0, uint32_t rows, const std::vector<Planes>& wanted) {
    const uint32_t begin = y0 / storage_.tile_height * storage_.tile_height;
    const uint32_t all = std::min(tile_rows(), info().height - begin);
    std::vector<const std::vector<std::string>*> channels;
    for (const Planes& planes : wanted) channels.push_back(planes.channels);
    if (kept_.channels != channels || kept_.begin != begin) {
      kept_ = {channels, begin, {}};
      return read_tiles(y0, rows, wanted);
    }
    if (kept_.values.empty()) kept_.values = decoded_rows(begin, all, channels);
    for (std::size_t p = 0; p < wanted.size(); ++p) {
      const std::size_t row = info().width * channels[p]->size();
      std::copy_n(&kept_.values[p][(y0 - begin) * row], rows * row, wanted[p].out);
    }
    if (y0 + rows == begin + all) kept_ = {};
  }

  std::vector<std::vector<float>> decoded_rows(uint32_t y0, uint32_t rows,
                                               const std::vector<const std::vector<std::string>*>& channels) {
    std::vector<std::vector<float>> values;
    std::vector<Planes> wanted;
    for (const auto* some : channels) {
      values.emplace_back(std::size_t{rows} * info().width * some->size());
      wanted.push_back({some, values.back().data()});
    }
    read_tiles(y0, rows, wanted);
    return values;
  }

  uint32_t tile_columns() const { return std::min(storage_.tile_width, info().width); }
  uint32_t tile_rows() const { return std::min(storage_.tile_height, info().height); }

  void set_tile_buffer(const std::vector<Planes>& wanted) {
    std::size_t slots = 0;
    for (const Planes& planes : wanted) slots += planes.channels->size();
    staging_.resize(slots * tile_columns() * tile_rows());
    const std::size_t channel_stride = tile_columns() * sizeof(float), y_stride = slots * channel_stride;
    Imf::FrameBuffer frame;
    char* base = reinterpret_cast<char*>(staging_.data());
    for (const Planes& planes : wanted)
      for (const std::string& name : *planes.channels) {
        frame.insert(name, Imf::Slice(Imf::FLOAT, base, sizeof(float), y_stride, 1, 1, 0.0, true, true));
        base += channel_stride;
      }
    tiled_->setFrameBuffer(frame);
  }

  void copy_tile(uint32_t tx, uint32_t ty, uint32_t y0, uint32_t rows,
                 const std::vector<Planes>& wanted) const {
    const uint32_t x_begin = tx * storage_.tile_width, y_tile = ty * storage_.tile_height;
    const uint32_t columns = std::min(tile_columns(), info().width - x_begin);
    const uint32_t y_begin = std::max(y0, y_tile);
    const uint32_t y_end = std::min(y0 + rows, y_tile + tile_rows());
    const std::size_t slots = staging_.size() / (std::size_t{tile_columns()} * tile_rows());
    for (uint32_t y = y_begin; y < y_end; ++y) {
      const float* from = staging_.data() + std::size_t{y - y_tile} * slots * tile_columns();
      for (const Planes& planes : wanted) {
        const std::size_t n = planes.channels->size(), pixel = std::size_t{y - y0} * info().width + x_begin;
        transpose(from, columns, n, planes.out + pixel * n);
        from += n * tile_columns();
      }
    }
  }

  /// [channel][x] to [x][channel] in blocks of 16 channels, one cache line of each pixel.
  void transpose(const float* from, uint32_t columns, std::size_t channels, float* to) const {
    constexpr std::size_t kBlock = 16;
    for (std::size_t first = 0; first < channels; first += kBlock) {
      const std::size_t last = std::min(first + kBlock, channels);
      for (uint32_t x = 0; x < columns; ++x)
        for (std::size_t c = first; c < last; ++c) to[x * channels + c] = from[c * tile_columns() + x];
    }
  }

  InputFileBytes bytes_;
  std::string where_;
  ExrStorage storage_;
  ExrInputStream stream_;
  ExrLayout layout_;
  std::unique_ptr<Imf::TiledInputFile> tiled_;
  std::unique_ptr<Imf::InputFile> lines_;
  std::vector<float> staging_;

  static constexpr std::size_t kMostKept = std::size_t{64} << 20;  // values
  /// The row of tiles that a part was asked for of: what of it, from which row of the image on; its values from the second part on.
  struct KeptRow {
    std::vector<const std::vector<std::string>*> channels;
    uint32_t begin = 0;
    std::vector<std::vector<float>> values;  // of each
  };
  KeptRow kept_;
};

}  // namespace

std::unique_ptr<CubeReader> open_exr_cube(const std::filesystem::path& file, const DiagnosticSink& sink) {
  return std::make_unique<ExrReader>(file, sink);
}

}  // namespace kiloband
