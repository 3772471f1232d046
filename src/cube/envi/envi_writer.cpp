// ENVI: band-sequential float32, little endian, written strip by strip at the bands' offsets.
#include <algorithm>
#include <bit>
#include <future>
#include <optional>

#include "cube/band_planes.hpp"
#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"
#include "cube/envi/envi_header.hpp"
#include "files/atomic_file.hpp"
#include "files/file_set.hpp"
#include "files/input_file.hpp"

namespace kiloband {
namespace {

static_assert(std::endian::native == std::endian::little, "files are written in the machine's byte order");

constexpr std::size_t kBandsAtOnce = kPlaneTile;  // one cache line of a pixel
constexpr std::size_t kWriteBytes = 8u << 20;     // at most, unless a single row needs more

/// One data file with its header: values, variances or auxiliary planes.
class EnviPart {
 public:
  EnviPart(const std::filesystem::path& stem, const std::filesystem::path& header, const CubeInfo& info,
           EnviContent content)
      : width_(info.width),
        height_(info.height),
        bands_(content == EnviContent::kAux ? info.aux.size() : info.bands.size()),
        data_(envi_file(stem, content, ".img")),
        header_(header) {
    data_.preallocate(uint64_t{width_} * height_ * bands_ * sizeof(float));
  }

  /// Again where the cube states less than before: empty lines take the place of what is gone.
  void write_header(const CubeInfo& info, EnviContent content) {
    std::string text = envi_header_text(info, content);
    if (text.size() < header_bytes_) text.resize(header_bytes_, '\n');
    header_bytes_ = text.size();
    header_.write_at(0, text);
  }

  /// values are [row][x][band]; change makes of them what is written, as to_planes() has it.
  template <class Change>
  void write_rows(uint32_t y0, uint32_t rows, std::span<const float> values, Change change) {
    const std::size_t bytes_per_row = kBandsAtOnce * width_ * sizeof(float);
    const auto rows_at_once = static_cast<uint32_t>(std::max<std::size_t>(1, kWriteBytes / bytes_per_row));
    for (uint32_t y = 0; y < rows; y += rows_at_once)
      for (std::size_t first = 0; first < bands_; first += kBandsAtOnce)
        write_block(y0, y, std::min(rows_at_once, rows - y), first, values, change);
  }

  AtomicFile& data() { return data_; }
  AtomicFile& header() { return header_; }

 private:
  /// Bands `first` and up to 15 more of `rows` rows from row y of the strip: transposed,
  /// then one write per band.
  template <class Change>
  void write_block(uint32_t y0, uint32_t y, uint32_t rows, std::size_t first, std::span<const float> values,
                   Change change) {
    const std::size_t count = std::min(kBandsAtOnce, bands_ - first), pixels = std::size_t{rows} * width_;
    const std::size_t stride =
        pixels + kPlaneTile;  // powers of two would put all bands into the same cache sets
    buffer_.resize(kBandsAtOnce * stride);
    const float* from = values.data() + std::size_t{y} * width_ * bands_;
    to_planes(from, pixels, bands_, first, count, buffer_.data(), stride, change);
    for (std::size_t k = 0; k < count; ++k) {
      const uint64_t row = uint64_t{first + k} * height_ + y0 + y;
      const auto* bytes = reinterpret_cast<const char*>(buffer_.data() + k * stride);
      data_.write_at(row * width_ * sizeof(float), {bytes, pixels * sizeof(float)});
    }
  }

  uint32_t width_, height_;
  std::size_t bands_;
  std::vector<float> buffer_;
  std::size_t header_bytes_ = 0;
  AtomicFile data_, header_;
};

/// Of the ENVI image that stands under a part's name, if there is one.
std::optional<EnviHeader> part_header(const std::filesystem::path& stem, EnviContent content) {
  const auto header = envi_file(stem, content, ".hdr");
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(header, ignored)) return std::nullopt;
  try {
    return EnviHeader(header, read_small_file(header, 1u << 28));
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

/// A part takes the place of an earlier one; of another image nobody has said that it may go.
void check_place(const std::filesystem::path& stem, EnviContent content) {
  const auto header = part_header(stem, content);
  if (!header || is_envi_part(*header, content)) return;
  throw InputError("'" + header->file().string() + "': is a cube of its own, which the " +
                   (content == EnviContent::kAux ? "auxiliary planes" : "variances") + " of " +
                   stem.filename().string() + ".hdr would replace: give one of them another name");
}

/// Removes X.var.* or X.aux.* that an earlier cube of ours left and this one has not. Others stay, foreign ones and cubes of
/// their own: X.hdr does not refer to them, so nobody takes them for its parts.
void remove_stale(const std::filesystem::path& stem, EnviContent content) {
  const auto header = part_header(stem, content);
  if (!header || !is_envi_part(*header, content)) return;
  remove_output(header->file());
  remove_output(envi_file(stem, content, ".img"));
}

class EnviWriter : public CubeWriter {
 public:
  EnviWriter(const std::filesystem::path& file, const CubeInfo& info, uint32_t rows_per_strip, Quantity given)
      : stem_(envi_output_stem(file)),
        info_(info),
        order_(info, rows_per_strip),
        conversion_(info.bands, given, info.quantity),
        values_(std::make_unique<EnviPart>(stem_, file, info, EnviContent::kValues)) {
    const auto part = [&](EnviContent content) {
      return std::make_unique<EnviPart>(stem_, envi_file(stem_, content, ".hdr"), info, content);
    };
    if (info.variance) variance_ = part(EnviContent::kVariance);
    if (!info.aux.empty()) aux_ = part(EnviContent::kAux);
  }

  void set_counts(const SampleCounts& counts) override {
    info_.samples_per_pixel = counts.samples_per_pixel;
    info_.replicates = counts.replicates;
    info_.replicate_samples = counts.replicate_samples;
  }

  void write_rows(const CubeRows& strip) override {
    order_.accept(strip);
    if (strip.y0 == 0) write_headers();
    std::future<void> variances;  // of another file: both at once
    if (variance_)
      variances = std::async(std::launch::async | std::launch::deferred, [&] {
        variance_->write_rows(strip.y0, strip.rows, strip.variance,
                              [&](auto... band) { conversion_.variances(band...); });
      });
    values_->write_rows(strip.y0, strip.rows, strip.mean, [&](auto... band) { conversion_.values(band...); });
    if (variance_) variances.get();
    if (aux_)
      aux_->write_rows(
          strip.y0, strip.rows, strip.aux,
          [](std::size_t, const float* from, float* to, std::size_t n) { std::copy_n(from, n, to); });
  }

  uint64_t overflowed_values() const override { return conversion_.overflowed_values(); }
  uint64_t overflowed_variances() const override { return conversion_.overflowed_variances(); }

  /// An older cube's header goes first, so that no header ever describes data that are not its own; data
  /// follow, the main header comes last.
  void close(FileSet& files) override {
    order_.finish();
    values_->write_header(info_, EnviContent::kValues);
    files.before([this] {
      remove_output(values_->header().name());
      if (!variance_) remove_stale(stem_, EnviContent::kVariance);
      if (!aux_) remove_stale(stem_, EnviContent::kAux);
    });
    const auto parts = {variance_.get(), aux_.get(), values_.get()};
    for (EnviPart* part : parts)
      if (part) files.add(part->data());
    for (EnviPart* part : parts)
      if (part) files.add(part->header());
  }

 private:
  void write_headers() {
    values_->write_header(info_, EnviContent::kValues);
    if (variance_) variance_->write_header(info_, EnviContent::kVariance);
    if (aux_) aux_->write_header(info_, EnviContent::kAux);
  }

  std::filesystem::path stem_;
  CubeInfo info_;
  StripOrder order_;
  QuantityConversion conversion_;
  std::unique_ptr<EnviPart> values_, variance_, aux_;
};

}  // namespace

std::unique_ptr<CubeWriter> create_envi_writer(const std::filesystem::path& file, const CubeInfo& info,
                                               uint32_t rows_per_strip, Quantity given) {
  for (const auto& [key, value] : info.metadata)
    if (key.empty()) throw InputError(file.string() + ": a metadata entry has no name");
  if (info.variance) check_place(envi_output_stem(file), EnviContent::kVariance);
  if (!info.aux.empty()) check_place(envi_output_stem(file), EnviContent::kAux);
  return std::make_unique<EnviWriter>(file, info, rows_per_strip, given);
}

}  // namespace kiloband
