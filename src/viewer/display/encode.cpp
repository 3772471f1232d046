#include "viewer/display/encode.hpp"

#include <turbojpeg.h>
#include <zlib.h>

#include <algorithm>
#include <memory>
#include <string_view>

#include "base/error.hpp"

namespace kiloband::viewer {
namespace {

constexpr int kJpegQuality = 88;
constexpr int kPngLevel = 1;

void append_number(std::string& to, uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8) to += static_cast<char>(number >> shift & 0xff);
}

/// A chunk of a PNG file: length, type, data, CRC of type and data. W3C, Portable Network Graphics, second edition, 5.3.
void append_chunk(std::string& png, std::string_view type, std::string_view data) {
  append_number(png, static_cast<uint32_t>(data.size()));
  const std::size_t begin = png.size();
  png.append(type).append(data);
  append_number(png, static_cast<uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(&png[begin]),
                                                 static_cast<uInt>(png.size() - begin))));
}

/// Rows as differences to the row above (filter type 2), which suits images and costs little.
std::string filtered_rows(const Picture8& picture) {
  const std::size_t row = std::size_t{picture.width} * 3;
  std::string out;
  out.reserve((row + 1) * picture.height);
  for (uint32_t y = 0; y < picture.height; ++y) {
    out += '\2';
    const uint8_t* const here = &picture.rgb[y * row];
    for (std::size_t i = 0; i < row; ++i)
      out += static_cast<char>(y == 0 ? here[i] : static_cast<uint8_t>(here[i] - (here - row)[i]));
  }
  return out;
}

std::string packed(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                bytes.size(), kPngLevel) != Z_OK)
    throw DeviceError("out of memory for a picture");
  out.resize(size);
  return out;
}

}  // namespace

bool fits_jpeg(const Picture8& picture) {
  constexpr uint32_t kMostPixels = 65500;  // JPEG_MAX_DIMENSION of libjpeg-turbo
  return std::max(picture.width, picture.height) <= kMostPixels;
}

std::string encode_jpeg(const Picture8& picture) {
  const std::unique_ptr<void, int (*)(tjhandle)> codec(tjInitCompress(), tjDestroy);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int failed = codec ? tjCompress2(codec.get(), picture.rgb.data(), static_cast<int>(picture.width), 0,
                                         static_cast<int>(picture.height), TJPF_RGB, &bytes, &size,
                                         TJSAMP_444, kJpegQuality, TJFLAG_FASTDCT)
                           : -1;
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owner(bytes, tjFree);
  if (failed) throw DeviceError(std::string("cannot make a JPEG picture: ") + tjGetErrorStr2(codec.get()));
  return {reinterpret_cast<const char*>(bytes), size};
}

std::string encode_png(const Picture8& picture) {
  std::string png("\x89PNG\r\n\x1a\n", 8), header;
  append_number(header, picture.width);
  append_number(header, picture.height);
  header.append("\x08\x02\0\0\0", 5);  // 8 bits, RGB, deflate, filters by row, not interlaced
  append_chunk(png, "IHDR", header);
  append_chunk(png, "sRGB", std::string_view("\0", 1));
  append_chunk(png, "IDAT", packed(filtered_rows(picture)));
  append_chunk(png, "IEND", {});
  return png;
}

}  // namespace kiloband::viewer
