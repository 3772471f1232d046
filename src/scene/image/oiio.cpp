// read_image through OpenImageIO 2.4; no other file includes it.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <thread>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/threads.hpp"
#include "scene/image/channels.hpp"
#include "scene/image/format.hpp"
#include "scene/image/image.hpp"
#include "scene/image/negative_values.hpp"

namespace kiloband {
namespace {

/// OpenImageIO's name of the reader. Choosing it ourselves keeps its other readers (video, DICOM ...)
/// away from the file.
const char* reader_name(ImageFormat format) {
  switch (format) {
    case ImageFormat::kExr:
      return "openexr";
    case ImageFormat::kHdr:
      return "hdr";
    case ImageFormat::kPng:
      return "png";
    case ImageFormat::kJpeg:
      return "jpeg";
    case ImageFormat::kTiff:
      return "tiff";
    case ImageFormat::kBmp:
      return "bmp";
    case ImageFormat::kPnm:
      return "pnm";
    case ImageFormat::kTarga:
      return "targa";
  }
  return "";
}

/// The library's message on one line, or what we say when it has none.
std::string reason(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ';');
  return text.empty() ? "the data is damaged or truncated" : text;
}

/// OpenEXR would fail for want of its threads; it reads as well without.
void spare_threads(ImageFormat format) {
  if (format == ImageFormat::kExr && !can_start_threads(std::thread::hardware_concurrency()))
    OIIO::attribute("exr_threads", -1);
}

class Reader {
 public:
  explicit Reader(const ImageFile& file) : file_(file) {
    spare_threads(file.format);
    input_ = OIIO::ImageInput::create(reader_name(file.format));
    if (!input_)
      throw DeviceError(std::string("OpenImageIO was built without its ") + reader_name(file.format) +
                        " reader");
    OIIO::ImageSpec hints;
    hints["oiio:UnassociatedAlpha"] = 1;  // alpha is dropped, so colours must not be multiplied by it
    if (!input_->open(file.name, spec_, hints)) fail_input();
  }

  Image read(bool raw, const DiagnosticSink& sink) {
    check();
    const ChannelChoice choice = choose();
    Image image{static_cast<uint32_t>(spec_.width),
                static_cast<uint32_t>(spec_.height),
                static_cast<uint32_t>(choice.count),
                {}};
    // Strip by strip: memory grows with what the file really delivers, not with what its header promises.
    const int strip = spec_.tile_height > 0 ? spec_.tile_height : 64;
    for (int row = 0; row < spec_.height; row += strip) {
      read_strip(image, choice, row, std::min(spec_.height, row + strip));
    }
    if (!raw && is_encoded()) decode(image);
    settle_values(image, sink);
    return image;
  }

 private:
  void check() const {
    check_image_size(file_, spec_.width, spec_.height);
    if (spec_.depth > 1) file_.fail("volume images are not supported");
    if (spec_.deep) file_.fail("deep images are not supported");
    const auto base = spec_.format.basetype;
    const bool integer = base == OIIO::TypeDesc::UINT8 || base == OIIO::TypeDesc::UINT16;
    const bool real =
        base == OIIO::TypeDesc::HALF || base == OIIO::TypeDesc::FLOAT || base == OIIO::TypeDesc::DOUBLE;
    // EXR holds 32-bit integers as object numbers, not as light.
    if (!integer && !real)
      file_.fail(std::string("pixels of type ") + spec_.format.c_str() + " are not supported");
  }

  ChannelChoice choose() const {
    const ChannelChoice choice = choose_channels(spec_.channelnames, spec_.alpha_channel);
    if (choice.count > 0) return choice;
    std::string names;
    for (size_t i = 0; i < spec_.channelnames.size() && i < 8; ++i)
      names += (i ? ", " : "") + spec_.channelnames[i];
    if (spec_.channelnames.size() > 8) names += ", ...";
    file_.fail("channels " + names + ": must be R, G, B, or Y, or a single one");
  }

  /// Appends rows [begin, end), counted from the top. Channels that do not lie together are read one by one:
  /// a file may hold hundreds between them.
  void read_strip(Image& image, const ChannelChoice& choice, int begin, int end) {
    const size_t pixels = static_cast<size_t>(end - begin) * spec_.width;
    const bool together = choice.count == 1 ||
                          (choice.index[1] == choice.index[0] + 1 && choice.index[2] == choice.index[1] + 1);
    const size_t base = image.pixels.size();
    image.pixels.resize(base + pixels * choice.count);
    if (together) {
      read_channels(begin, end, choice.index[0], choice.count, image.pixels.data() + base);
      return;
    }
    std::vector<float> plane(pixels);
    for (int c = 0; c < choice.count; ++c) {
      read_channels(begin, end, choice.index[c], 1, plane.data());
      for (size_t i = 0; i < pixels; ++i) image.pixels[base + i * choice.count + c] = plane[i];
    }
  }

  /// Channels [first, first + count) of rows [begin, end) into target[row][x][channel].
  void read_channels(int begin, int end, int first, int count, float* target) {
    const int y0 = spec_.y + begin, y1 = spec_.y + end, last = first + count;
    bool good = true;
    if (spec_.tile_width > 0) {
      good = input_->read_tiles(0, 0, spec_.x, spec_.x + spec_.width, y0, y1, spec_.z, spec_.z + 1, first,
                                last, OIIO::TypeFloat, target);
    } else if (file_.format == ImageFormat::kTiff) {
      good = read_tiff_rows(y0, y1, first, count, target);
    } else {
      good = input_->read_scanlines(0, 0, y0, y1, spec_.z, first, last, OIIO::TypeFloat, target);
    }
    if (!good) fail_input();
  }

  /// Row by row: read_scanlines() of OpenImageIO 2.4.7 takes damaged and missing TIFF strips for good ones.
  bool read_tiff_rows(int y0, int y1, int first, int count, float* target) {
    std::vector<float> row(static_cast<size_t>(spec_.width) * spec_.nchannels);
    for (int y = y0; y < y1; ++y) {
      if (!input_->read_scanline(y, spec_.z, OIIO::TypeFloat, row.data())) return false;
      for (int x = 0; x < spec_.width; ++x) {
        target = std::copy_n(row.data() + static_cast<size_t>(x) * spec_.nchannels + first, count, target);
      }
    }
    return true;
  }

  bool is_encoded() const {
    return spec_.format.basetype == OIIO::TypeDesc::UINT8 || spec_.format.basetype == OIIO::TypeDesc::UINT16;
  }

  static void decode(Image& image) {
    // Textures have few distinct values in a row; the curve itself costs a pow.
    float last = 0, decoded = 0;
    for (float& value : image.pixels) {
      if (value != last) decoded = decode_srgb(last = value);
      value = decoded;
    }
  }

  static std::string place_in(const Image& image, std::size_t index) {
    const std::size_t pixel = index / image.channels;
    return "pixel (" + std::to_string(pixel % image.width) + ", " + std::to_string(pixel / image.width) +
           "), channel " + std::to_string(index % image.channels);
  }

  /// Refuses what is no light and sets slightly negative values to 0.
  void settle_values(Image& image, const DiagnosticSink& sink) const {
    NegativeValues negative;
    for (size_t i = 0; i < image.pixels.size(); ++i) {
      if (!std::isfinite(image.pixels[i])) refuse_value(image, i, "must be finite and >= 0");
      negative.add(image.pixels[i], i);
    }
    if (negative.negative() == 0) return;
    if (!negative.acceptable()) refuse_value(image, negative.lowest_index(), negative.rule());
    image.lowest = negative.lowest();
    uint64_t texels = 0;
    for (size_t first = 0; first < image.pixels.size(); first += image.channels) {
      const std::span<float> texel(&image.pixels[first], image.channels);
      texels += std::ranges::any_of(texel, [](float v) { return v < 0; });
      for (float& value : texel) value = std::max(value, 0.0f);
    }
    warn(sink, {file_.name},
         std::to_string(texels) + (texels == 1 ? " texel is" : " texels are") +
             " slightly negative and taken as 0, the lowest at " + place_in(image, negative.lowest_index()) +
             ": " + format_number(negative.lowest()));
  }

  [[noreturn]] void refuse_value(const Image& image, std::size_t index, const std::string& rule) const {
    file_.fail(place_in(image, index) + ": " + format_number(image.pixels[index]) + ": " + rule);
  }

  [[noreturn]] void fail_input() { file_.fail("cannot be read: " + reason(input_->geterror())); }

  const ImageFile& file_;
  std::unique_ptr<OIIO::ImageInput> input_;
  OIIO::ImageSpec spec_;
};

}  // namespace

Image read_image(const std::filesystem::path& path, bool raw, const DiagnosticSink& sink) {
  const ImageFile file = examine_image(path);
  try {
    return Reader(file).read(raw, sink);
  } catch (const std::bad_alloc&) {
    throw DeviceError(file.name + ": not enough memory for the image");
  }
}

}  // namespace kiloband
