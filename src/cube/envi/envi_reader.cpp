// ENVI cubes, ours and others': any interleave, byte order and real data type; rows are read where they lie.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>

#include "base/number.hpp"
#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"
#include "cube/envi/envi_header.hpp"
#include "files/input_file.hpp"
#include "files/output_target.hpp"

namespace kiloband {
namespace {

constexpr uint64_t kMaxHeaderBytes = 1u << 28;  // a million bands need about 100 MB

/// The largest float in too few digits is a little more than it; what is nearer to the next power of two is infinite.
float nearest_float(double value) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  constexpr double kInfiniteFrom = 0x1.ffffffp127;
  if (!(std::abs(value) > kLargest)) return static_cast<float>(value);
  return std::copysign(std::abs(value) < kInfiniteFrom ? kLargest : INFINITY, value < 0 ? -1.0f : 1.0f);
}

/// As the type has it: no float is the double that its decimal number would be.
template <class Number>
bool is_ignored(Number value, double ignore) {
  if constexpr (std::is_same_v<Number, float>)
    return value == nearest_float(ignore) && (std::isinf(ignore) || !std::isinf(value));
  return static_cast<double>(value) == ignore;
}

/// Converts numbers of one type; from may be unaligned. Values that equal `ignore` become NaN.
template <class Number>
void convert(const char* from, std::size_t count, bool swap, std::optional<double> ignore, float* to,
             std::size_t stride) {
  for (std::size_t i = 0; i < count; ++i, from += sizeof(Number), to += stride) {
    char bytes[sizeof(Number)];
    std::memcpy(bytes, from, sizeof bytes);
    if (swap) std::reverse(std::begin(bytes), std::end(bytes));
    Number value;
    std::memcpy(&value, bytes, sizeof value);
    *to = static_cast<float>(value);
    if (ignore && is_ignored(value, *ignore)) *to = std::numeric_limits<float>::quiet_NaN();
  }
}

/// A double may be beyond float's range: the conversion would be undefined, IEEE arithmetic rounds or gives infinity.
struct WideDouble {
  double value;
  explicit operator float() const { return nearest_float(value); }
  explicit operator double() const { return value; }
};

/// The numbers of one data file.
class EnviPixels {
 public:
  EnviPixels(const std::filesystem::path& data, const EnviStorage& storage, std::optional<double> ignore)
      : storage_(storage), ignore_(ignore), file_(data) {
    if (storage.offset > file_.size() || storage.bytes() > file_.size() - storage.offset)
      throw InputError(data.string() + ": the file has " + std::to_string(file_.size()) +
                       " bytes, its header needs " + std::to_string(storage.offset + storage.bytes()));
  }

  /// Ours have nothing behind the numbers: what has is of another cube than the header. Other programs may
  /// put there what they like.
  void check_end(bool own, const DiagnosticSink& sink) const {
    const uint64_t end = storage_.offset + storage_.bytes();
    if (file_.size() == end) return;
    const std::string file = file_.path().string();
    const std::string sizes =
        "the file has " + std::to_string(file_.size()) + " bytes, its header says " + std::to_string(end);
    if (own) throw InputError(file + ": " + sizes + ": it belongs to another header, or is damaged");
    warn(sink, {file}, sizes + ": the rest is ignored");
  }

  /// out is [row][x][band].
  void read_rows(uint32_t y0, uint32_t rows, float* out) {
    const bool bsq = storage_.interleave == EnviInterleave::kBsq;
    const uint64_t block_rows = kBlockBytes / (storage_.samples * storage_.bytes_per_value());
    const auto at_once = static_cast<uint32_t>(bsq ? std::max<uint64_t>(1, block_rows) : 1);
    for (uint32_t y = 0; y < rows; y += at_once) {
      float* to = out + std::size_t{y} * storage_.samples * storage_.bands;
      if (bsq)
        read_bsq(y0 + y, std::min(at_once, rows - y), to);
      else
        read_row(y0 + y, to);
    }
  }

 private:
  static constexpr uint64_t kBlockBytes = 1u << 18;  // of one band, in one read
  /// Read before they are interleaved: one cache line of a pixel.
  static constexpr std::size_t kBandsAtOnce = 16;

  const char* fetch(uint64_t first_value, uint64_t values, char* to) {
    const uint64_t size = storage_.bytes_per_value();
    file_.read_at(storage_.offset + first_value * size, {to, values * size});
    return to;
  }

  void read_bsq(uint32_t y, uint32_t rows, float* out) {
    const uint64_t pixels = uint64_t{rows} * storage_.samples, bytes = pixels * storage_.bytes_per_value();
    buffer_.resize(kBandsAtOnce * bytes);
    for (std::size_t first = 0; first < storage_.bands; first += kBandsAtOnce) {
      const std::size_t count = std::min<std::size_t>(kBandsAtOnce, storage_.bands - first);
      for (std::size_t k = 0; k < count; ++k) {
        const uint64_t row = uint64_t{first + k} * storage_.lines + y;
        fetch(row * storage_.samples, pixels, buffer_.data() + k * bytes);
      }
      // Runs of pixels small enough that their output stays in the cache while the bands pass.
      constexpr uint64_t kRun = 256;
      for (uint64_t p = 0; p < pixels; p += kRun)
        for (std::size_t k = 0; k < count; ++k)
          to_float(buffer_.data() + k * bytes + p * storage_.bytes_per_value(), std::min(kRun, pixels - p),
                   out + p * storage_.bands + first + k, storage_.bands);
    }
  }

  /// One line of a bil or bip file, which lies in one piece.
  void read_row(uint32_t y, float* out) {
    const uint64_t samples = storage_.samples, bands = storage_.bands, size = storage_.bytes_per_value();
    buffer_.resize(samples * bands * size);
    fetch(y * samples * bands, samples * bands, buffer_.data());
    if (storage_.interleave == EnviInterleave::kBip) return to_float(buffer_.data(), samples * bands, out, 1);
    for (uint64_t k = 0; k < bands; ++k)
      to_float(buffer_.data() + k * samples * size, samples, out + k, bands);
  }

  void to_float(const char* from, std::size_t count, float* to, std::size_t stride) const {
    const bool swap = storage_.big_endian;
    switch (storage_.data_type) {
      case 1:
        return convert<uint8_t>(from, count, swap, ignore_, to, stride);
      case 2:
        return convert<int16_t>(from, count, swap, ignore_, to, stride);
      case 3:
        return convert<int32_t>(from, count, swap, ignore_, to, stride);
      case 4:
        return convert<float>(from, count, swap, ignore_, to, stride);
      case 5:
        return convert<WideDouble>(from, count, swap, ignore_, to, stride);
      case 12:
        return convert<uint16_t>(from, count, swap, ignore_, to, stride);
      case 13:
        return convert<uint32_t>(from, count, swap, ignore_, to, stride);
      case 14:
        return convert<int64_t>(from, count, swap, ignore_, to, stride);
      default:
        return convert<uint64_t>(from, count, swap, ignore_, to, stride);
    }
  }

  EnviStorage storage_;
  std::optional<double> ignore_;
  InputFileBytes file_;
  std::vector<char> buffer_;
};

bool is_file(const std::filesystem::path& file) {
  std::error_code unknown;  // a name that is too long is no file
  return std::filesystem::is_regular_file(file, unknown);
}

bool in_capitals(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  return extension != lowered(extension);
}

/// base.hdr or base.HDR
std::filesystem::path with_ending(std::filesystem::path base, std::string_view ending, bool capitals) {
  std::string spelled(ending);
  if (capitals)
    for (char& c : spelled) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  return base += spelled;
}

/// X.img -> X.hdr or X.img.hdr. Nothing if there is none. In capitals beside a name in capitals: X.HDR and X.hdr may be two cubes.
std::optional<std::filesystem::path> header_beside(const std::filesystem::path& file) {
  for (const bool capitals : {in_capitals(file), !in_capitals(file)})
    for (const auto& base : {envi_stem(file), file})
      if (const auto candidate = with_ending(base, ".hdr", capitals); is_file(candidate)) return candidate;
  return std::nullopt;
}

/// A header is taken as it is.
std::filesystem::path find_header(const std::filesystem::path& file) {
  if (lowered_extension(file) == ".hdr") return file;
  if (const auto header = header_beside(file)) return *header;
  const auto name = [&](const std::filesystem::path& base) {
    return with_ending(base, ".hdr", in_capitals(file)).filename().string();
  };
  throw InputError("'" + file.string() + "': no header '" + name(envi_stem(file)) + "' or '" + name(file) +
                   "' beside it");
}

/// X.hdr -> X.img or what other programs write; X.img.hdr -> X.img. Nothing if there is none.
std::optional<std::filesystem::path> data_beside(const std::filesystem::path& header) {
  for (const bool capitals : {in_capitals(header), !in_capitals(header)})
    for (const char* extension : {".img", "", ".dat", ".raw", ".bsq", ".bil", ".bip"})
      if (const auto candidate = with_ending(envi_stem(header), extension, capitals); is_file(candidate))
        return candidate;
  return std::nullopt;
}

/// The header itself, or what it is a link to, if that is what has data beside it.
std::filesystem::path header_with_data(const std::filesystem::path& header) {
  const std::filesystem::path target = find_output_target(header).file;
  return !data_beside(header) && data_beside(target) ? target : header;
}

std::filesystem::path find_data(const std::filesystem::path& header) {
  if (const auto data = data_beside(header)) return *data;
  throw InputError("'" + header.string() + "': no data file '" +
                   with_ending(envi_stem(header), ".img", in_capitals(header)).filename().string() +
                   "' beside it");
}

/// The largest double in too few digits is more than any, and meant all the same.
std::optional<double> ignore_value(const EnviHeader& header) {
  const auto* entry = header.find("data ignore value");
  if (!entry) return std::nullopt;
  double value = 0;
  switch (read_number(trimmed(entry->value), value)) {
    case NumberText::kNone:
      throw InputError(header.where(*entry) + " '" + printable(entry->value) + "': must be a number");
    case NumberText::kTooLarge:
      return std::copysign(std::numeric_limits<double>::max(), value);
    default:
      return value;
  }
}

class EnviReader : public CubeReader {
 public:
  EnviReader(const std::filesystem::path& file, const DiagnosticSink& sink) {
    const auto path = header_with_data(find_header(file));
    const EnviHeader header(path, read_small_file(path, kMaxHeaderBytes));
    const EnviStorage storage = read_envi_storage(header);
    info_ = read_envi_info(header, storage, sink);
    values_.emplace(find_data(path), storage, ignore_value(header));
    const bool own = header.find(kEnviLayoutKey) != nullptr;
    values_->check_end(own, sink);
    if (own && header.count(kEnviVarianceKey, 1, 0) == 1) open_variance(envi_stem(path));
    if (own && header.count(kEnviAuxKey, 1, 0) == 1) open_aux(envi_stem(path));
    check_cube_info(info_, path.string());
  }

  const CubeInfo& info() const override { return info_; }

  void read_rows(uint32_t y0, uint32_t rows, std::span<float> mean, std::span<float> variance) override {
    check_read(info_, y0, rows, mean.size(), info_.bands.size());
    check_read(info_, y0, rows, variance.size(), variance.empty() || !variance_ ? 0 : info_.bands.size());
    values_->read_rows(y0, rows, mean.data());
    if (!variance.empty()) variance_->read_rows(y0, rows, variance.data());
  }

  void read_aux(uint32_t y0, uint32_t rows, std::span<float> aux) override {
    check_read(info_, y0, rows, aux.size(), info_.aux.size());
    if (aux_) aux_->read_rows(y0, rows, aux.data());
  }

 private:
  /// A cube that was written under the name of a part has replaced it.
  static void check_part(const EnviHeader& header, const std::filesystem::path& stem, EnviContent content) {
    if (is_envi_part(header, content)) return;
    const bool aux = content == EnviContent::kAux;
    const std::string cube = stem.filename().string() + ".hdr", parts = aux ? "planes" : "variances";
    throw InputError(header.file().string() + ": must hold the " + (aux ? "auxiliary " : "") + parts +
                     " of " + cube + " but is a cube of its own: put the " + parts + " back, or take '" +
                     std::string(aux ? kEnviAuxKey : kEnviVarianceKey) + "' out of " + cube);
  }

  /// Opens X.var or X.aux, whose image must have the cube's size.
  EnviHeader open_part(const std::filesystem::path& stem, EnviContent content,
                       std::optional<EnviPixels>& pixels) {
    const auto path = envi_file(stem, content, ".hdr");
    EnviHeader header(path, read_small_file(path, kMaxHeaderBytes));
    const EnviStorage storage = read_envi_storage(header);
    check_part(header, stem, content);
    const bool same_bands = content == EnviContent::kAux || storage.bands == info_.bands.size();
    if (storage.samples != info_.width || storage.lines != info_.height || !same_bands)
      throw InputError(path.string() + ": " + std::to_string(storage.samples) + "x" +
                       std::to_string(storage.lines) + "x" + std::to_string(storage.bands) +
                       " values do not fit the cube's " + std::to_string(info_.width) + "x" +
                       std::to_string(info_.height) + "x" + std::to_string(info_.bands.size()));
    pixels.emplace(envi_file(stem, content, ".img"), storage, std::nullopt);
    pixels->check_end(true, {});  // only our own cubes have parts
    return header;
  }

  void open_variance(const std::filesystem::path& stem) {
    open_part(stem, EnviContent::kVariance, variance_);
    info_.variance = true;
  }

  void open_aux(const std::filesystem::path& stem) {
    const EnviHeader header = open_part(stem, EnviContent::kAux, aux_);
    for (const std::string& name : header.texts("band names", header.count("bands", kMaxAuxPlanes)))
      info_.aux.push_back(decode_text(name));
    if (info_.aux.empty()) throw InputError(header.file().string() + ": 'band names' is missing");
  }

  CubeInfo info_;
  std::optional<EnviPixels> values_, variance_, aux_;
};

/// Begins as headers do: what is not ENVI (Radiance pictures end in .hdr, too) has one file.
bool is_envi_header(const std::filesystem::path& file) {
  std::string line;
  std::getline(std::ifstream(file), line);
  return line.find("ENVI") != std::string::npos;
}

}  // namespace

std::vector<std::filesystem::path> envi_files(const std::filesystem::path& file) {
  std::filesystem::path header = file;
  if (lowered_extension(file) == ".img") header = header_beside(file).value_or(file);
  std::vector<std::filesystem::path> files{file};
  if (!is_file(header) || !is_envi_header(header)) return files;
  header = header_with_data(header);
  files.push_back(header);
  if (const auto data = data_beside(header)) files.push_back(*data);
  for (const EnviContent content : {EnviContent::kVariance, EnviContent::kAux})
    for (const char* extension : {".hdr", ".img"})
      if (const auto part = envi_file(envi_stem(header), content, extension); is_file(part))
        files.push_back(part);
  return files;
}

std::vector<std::filesystem::path> envi_output_files(const std::filesystem::path& header) {
  const auto stem = envi_output_stem(header);
  std::vector<std::filesystem::path> files{header, envi_file(stem, EnviContent::kValues, ".img")};
  for (const EnviContent content : {EnviContent::kVariance, EnviContent::kAux})
    for (const char* extension : {".hdr", ".img"}) files.push_back(envi_file(stem, content, extension));
  return files;
}

std::unique_ptr<CubeReader> open_envi_cube(const std::filesystem::path& file, const DiagnosticSink& sink) {
  return std::make_unique<EnviReader>(file, sink);
}

}  // namespace kiloband
