#include "scene/image/format.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include "base/error.hpp"
#include "base/regular_file.hpp"
#include "base/text.hpp"

namespace kiloband {
namespace {

using namespace std::string_view_literals;

struct Signature {
  std::string_view bytes;
  ImageFormat format;
};

constexpr std::array<Signature, 16> kSignatures = {{{"\x76\x2f\x31\x01"sv, ImageFormat::kExr},
                                                    {"#?RADIANCE"sv, ImageFormat::kHdr},
                                                    {"#?RGBE"sv, ImageFormat::kHdr},
                                                    {"\x89PNG\r\n\x1a\n"sv, ImageFormat::kPng},
                                                    {"\xff\xd8\xff"sv, ImageFormat::kJpeg},
                                                    {"II*\0"sv, ImageFormat::kTiff},
                                                    {"MM\0*"sv, ImageFormat::kTiff},
                                                    {"BM"sv, ImageFormat::kBmp},
                                                    {"P1"sv, ImageFormat::kPnm},
                                                    {"P2"sv, ImageFormat::kPnm},
                                                    {"P3"sv, ImageFormat::kPnm},
                                                    {"P4"sv, ImageFormat::kPnm},
                                                    {"P5"sv, ImageFormat::kPnm},
                                                    {"P6"sv, ImageFormat::kPnm},
                                                    {"PF"sv, ImageFormat::kPnm},
                                                    {"Pf"sv, ImageFormat::kPnm}}};

// Targa has no signature.
bool is_targa_name(const std::filesystem::path& path) {
  return lowered_extension(path) == ".tga";
}

ImageFormat recognise(const ImageFile& file, const std::filesystem::path& path, std::ifstream& stream) {
  std::array<char, 16> head{};
  stream.read(head.data(), head.size());
  const std::string_view start(head.data(), static_cast<size_t>(stream.gcount()));
  for (const Signature& signature : kSignatures) {
    if (start.substr(0, signature.bytes.size()) == signature.bytes) return signature.format;
  }
  if (!is_targa_name(path))
    file.fail("not an image of a known format (EXR, HDR, PNG, JPEG, TIFF, BMP, PNM, PFM, TGA)");
  return ImageFormat::kTarga;
}

/// Reads up to the next marker outside of entropy-coded data.
/// returns its code, or -1 at the end of the file
int next_jpeg_marker(std::istream& stream) {
  for (int byte = stream.get(); byte >= 0; byte = stream.get()) {
    while (byte == 0xFF) {
      byte = stream.get();
      const bool is_data = byte == 0 || (byte >= 0xD0 && byte <= 0xD7);  // a stuffed byte or a restart
      if (byte > 0 && byte != 0xFF && !is_data) return byte;
    }
  }
  return -1;
}

/// Follows the segments by their lengths, so that the end marker of an embedded thumbnail does not count.
bool has_jpeg_end(std::istream& stream) {
  constexpr int kEnd = 0xD9, kStart = 0xD8;
  stream.clear();
  stream.seekg(0);
  for (int marker = next_jpeg_marker(stream); marker >= 0; marker = next_jpeg_marker(stream)) {
    if (marker == kEnd) return true;
    if (marker == kStart || marker == 1) continue;  // these have no length
    const int high = stream.get(), low = stream.get();
    if (high < 0 || low < 0) return false;
    stream.seekg(std::max(0, high * 256 + low - 2), std::ios::cur);
  }
  return false;
}

/// Follows the chunks (u32 big-endian length, name, data, checksum) to the last one, whose name is IEND.
bool has_png_end(std::istream& stream, uint64_t file_bytes) {
  constexpr uint64_t kSignatureBytes = 8, kChunkOverhead = 12;
  stream.clear();
  std::array<char, 8> head{};
  for (uint64_t at = kSignatureBytes; at + kChunkOverhead <= file_bytes;) {
    stream.seekg(static_cast<std::streamoff>(at));
    if (!stream.read(head.data(), head.size())) return false;
    uint64_t length = 0;
    for (int i = 0; i < 4; ++i) length = length * 256 + static_cast<unsigned char>(head[i]);
    at += kChunkOverhead + length;
    if (std::string_view(head.data() + 4, 4) == "IEND") return at <= file_bytes;
  }
  return false;
}

}  // namespace

void ImageFile::fail(const std::string& message) const {
  throw InputError(name + ": " + message);
}

ImageFile examine_image(const std::filesystem::path& path) {
  ImageFile file{path.string()};
  RegularFile input = open_regular_file(path);
  std::ifstream& stream = input.stream;
  file.bytes = input.bytes;
  file.format = recognise(file, path, stream);
  if (file.format == ImageFormat::kJpeg && !has_jpeg_end(stream))
    file.fail("the JPEG data is truncated: no end marker");
  if (file.format == ImageFormat::kPng && !has_png_end(stream, file.bytes))
    file.fail("the PNG data is truncated: no end chunk");
  return file;
}

void check_image_size(const ImageFile& file, int64_t width, int64_t height) {
  constexpr int64_t kLargest = 65535;
  const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
  if (width < 1 || height < 1 || width > kLargest || height > kLargest) {
    file.fail(size + ": each dimension must be in 1..65535");
  }
  // Decoders of interlaced PNG and progressive JPEG allocate the whole image first. DEFLATE expands at most
  // 1032 times (and a pixel has at least a bit); a JPEG pixel costs at least 1/64 of a code of one bit, which
  // is less than that.
  constexpr uint64_t kMostPixelsPerByte = 1032 * 8;
  const bool compressed_whole = file.format == ImageFormat::kPng || file.format == ImageFormat::kJpeg;
  if (compressed_whole && static_cast<uint64_t>(width * height) / kMostPixelsPerByte > file.bytes) {
    file.fail(size + " cannot be stored in " + std::to_string(file.bytes) + " bytes");
  }
}

}  // namespace kiloband
