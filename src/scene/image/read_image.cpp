// read_image: pixels of picture files, checked, linear.
#include <algorithm>
#include <cmath>
#include <span>
#include <thread>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/threads.hpp"
#include "pictures/picture_library.hpp"
#include "scene/image/channels.hpp"
#include "scene/image/format.hpp"
#include "scene/image/image.hpp"
#include "scene/image/negative_values.hpp"
#include "spectral/colour/colour.hpp"

namespace kiloband {
namespace {

/// The library's name of the reader. Choosing it ourselves keeps OpenImageIO's other readers (video, DICOM ...)
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

class Reader {
 public:
  explicit Reader(const ImageFile& file) : file_(file) {
    PictureLibrary& library = picture_library();
    // OpenEXR would fail for want of its threads; it reads as well without.
    if (file.format == ImageFormat::kExr && !can_start_threads(std::thread::hardware_concurrency()))
      library.spare_threads();
    std::string error;
    input_ = library.open(reader_name(file.format), file.name, error);
    if (!input_ && error.empty())
      throw DeviceError(std::string("OpenImageIO was built without its ") + reader_name(file.format) +
                        " reader");
    if (!input_) fail_input(error);
  }

  Image read(bool raw, const DiagnosticSink& sink) {
    check();
    const ImageChannels choice = choose();
    if (has_spectra(input_->spec().channels))
      warn(
          sink, {file_.name},
          "a spectral image: only its RGB picture is read here; spectral_bitmap and spectral_envmap read its "
          "bands");
    const PictureInput::Spec& spec = input_->spec();
    Image image{static_cast<uint32_t>(spec.width),
                static_cast<uint32_t>(spec.height),
                static_cast<uint32_t>(choice.count),
                {}};
    // Strip by strip: memory grows with what the file really delivers, not with what its header promises.
    for (int row = 0; row < spec.height; row += spec.rows_at_once) {
      read_strip(image, choice, row, std::min(spec.height, row + spec.rows_at_once));
    }
    if (!raw && spec.kind == PictureInput::Kind::kEncoded) decode(image);
    settle_values(image, sink);
    return image;
  }

 private:
  void check() const {
    const PictureInput::Spec& spec = input_->spec();
    check_image_size(file_, spec.width, spec.height);
    if (spec.depth > 1) file_.fail("volume images are not supported");
    if (spec.deep) file_.fail("deep images are not supported");
    if (spec.kind == PictureInput::Kind::kOther)
      file_.fail("pixels of type " + spec.type_name + " are not supported");
  }

  ImageChannels choose() const {
    const std::vector<std::string>& channels = input_->spec().channels;
    const ImageChannels choice = choose_channels(channels, input_->spec().alpha_channel);
    if (choice.count > 0) return choice;
    std::string names;
    for (size_t i = 0; i < channels.size() && i < 8; ++i) names += (i ? ", " : "") + channels[i];
    if (channels.size() > 8) names += ", ...";
    file_.fail("channels " + names + ": must be R, G, B, or Y, or a single one" +
               (has_spectra(channels) ? "; spectral_bitmap and spectral_envmap read bands" : ""));
  }

  /// Appends rows [begin, end), counted from the top. Channels that do not lie together are read one by one:
  /// a file may hold hundreds between them.
  void read_strip(Image& image, const ImageChannels& choice, int begin, int end) {
    const size_t pixels = static_cast<size_t>(end - begin) * image.width;
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

  void read_channels(int begin, int end, int first, int count, float* target) {
    if (!input_->read(begin, end, first, count, target)) fail_input(input_->error());
  }

  static void decode(Image& image) {
    // Textures have few distinct values in a row; the curve itself costs a pow.
    float last = 0, decoded = 0;
    for (float& value : image.pixels) {
      if (value != last) decoded = static_cast<float>(srgb_decode(last = value));
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

  [[noreturn]] void fail_input(const std::string& error) { file_.fail("cannot be read: " + reason(error)); }

  const ImageFile& file_;
  std::unique_ptr<PictureInput> input_;
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
