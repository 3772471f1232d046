// PictureLibrary by OpenImageIO 2.4, as a module that is loaded when it is needed. It uses nothing of kiloband but the
// interface.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <utility>

#include "pictures/picture_library.hpp"

namespace kiloband {
namespace {

PictureInput::Kind kind_of(const OIIO::TypeDesc& type) {
  switch (type.basetype) {
    case OIIO::TypeDesc::UINT8:
    case OIIO::TypeDesc::UINT16:
      return PictureInput::Kind::kEncoded;
    case OIIO::TypeDesc::HALF:
    case OIIO::TypeDesc::FLOAT:
    case OIIO::TypeDesc::DOUBLE:
      return PictureInput::Kind::kLinear;
    default:
      return PictureInput::Kind::kOther;  // EXR holds 32-bit integers as object numbers, not as light
  }
}

class OiioInput : public PictureInput {
 public:
  OiioInput(std::unique_ptr<OIIO::ImageInput> input, const OIIO::ImageSpec& oiio, bool tiff)
      : input_(std::move(input)), oiio_(oiio), tiff_(tiff) {
    spec_.width = oiio.width;
    spec_.height = oiio.height;
    spec_.depth = oiio.depth;
    spec_.deep = oiio.deep;
    spec_.channels = oiio.channelnames;
    spec_.alpha_channel = oiio.alpha_channel;
    if (oiio.tile_height > 0) spec_.rows_at_once = oiio.tile_height;
    spec_.kind = kind_of(oiio.format);
    spec_.type_name = oiio.format.c_str();
  }

  const Spec& spec() const override { return spec_; }
  std::string error() override { return input_->geterror(); }

  bool read(int begin, int end, int first, int count, float* target) override {
    const int y0 = oiio_.y + begin, y1 = oiio_.y + end, last = first + count;
    if (oiio_.tile_width > 0)
      return input_->read_tiles(0, 0, oiio_.x, oiio_.x + oiio_.width, y0, y1, oiio_.z, oiio_.z + 1, first,
                                last, OIIO::TypeFloat, target);
    if (tiff_) return read_tiff_rows(y0, y1, first, count, target);
    return input_->read_scanlines(0, 0, y0, y1, oiio_.z, first, last, OIIO::TypeFloat, target);
  }

 private:
  /// Row by row: read_scanlines() of OpenImageIO 2.4.7 takes damaged and missing TIFF strips for good ones.
  bool read_tiff_rows(int y0, int y1, int first, int count, float* target) {
    const auto channels = static_cast<std::size_t>(oiio_.nchannels);
    std::vector<float> row(static_cast<std::size_t>(oiio_.width) * channels);
    for (int y = y0; y < y1; ++y) {
      if (!input_->read_scanline(y, oiio_.z, OIIO::TypeFloat, row.data())) return false;
      for (std::size_t x = 0; x < static_cast<std::size_t>(oiio_.width); ++x)
        target = std::copy_n(row.data() + x * channels + first, count, target);
    }
    return true;
  }

  std::unique_ptr<OIIO::ImageInput> input_;
  OIIO::ImageSpec oiio_;
  bool tiff_;
  Spec spec_;
};

class OiioLibrary : public PictureLibrary {
 public:
  std::unique_ptr<PictureInput> open(const std::string& format, const std::string& file,
                                     std::string& error) override {
    error.clear();
    auto input = OIIO::ImageInput::create(format);
    if (!input) return nullptr;
    OIIO::ImageSpec hints, spec;
    hints["oiio:UnassociatedAlpha"] = 1;  // alpha is dropped, so colours must not be multiplied by it
    if (input->open(file, spec, hints))
      return std::make_unique<OiioInput>(std::move(input), spec, format == "tiff");
    error = input->geterror();
    if (error.empty()) error = "the data is damaged or truncated";
    return nullptr;
  }

  void spare_threads() override { OIIO::attribute("exr_threads", -1); }
};

}  // namespace
}  // namespace kiloband

extern "C" kiloband::PictureLibrary* kiloband_picture_library() {
  static kiloband::OiioLibrary library;
  return &library;
}
