// OpenEXR pictures: part 0, in scan lines or tiles, HALF and FLOAT.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <vector>

#include "pictures/readers/readers.hpp"
#include "pictures/readers/row_input.hpp"

namespace kiloband {
namespace {

struct ExrChannel {
  std::string name, layer;
  std::size_t rank = 0;  // R, G, B, A of a layer stand together, so that they are read in one go
  Imf::PixelType type = Imf::FLOAT;
  bool full = true;  // a sample for every pixel

  explicit ExrChannel(const Imf::ChannelList::ConstIterator& channel)
      : name(channel.name()),
        type(channel.channel().type),
        full(channel.channel().xSampling == 1 && channel.channel().ySampling == 1) {
    const std::size_t dot = name.rfind('.');
    if (dot != std::string::npos) layer = name.substr(0, dot);
    const std::string_view suffix = std::string_view(name).substr(dot == std::string::npos ? 0 : dot + 1);
    constexpr std::string_view kTogether = "RGBA";
    const std::size_t place = suffix.size() == 1 ? kTogether.find(suffix) : std::string_view::npos;
    rank = std::min(place, kTogether.size());
  }
};

/// By layers, those without first.
std::vector<ExrChannel> channels_of(const Imf::Header& header) {
  std::vector<ExrChannel> channels;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) channels.emplace_back(c);
  std::stable_sort(channels.begin(), channels.end(), [](const ExrChannel& a, const ExrChannel& b) {
    return std::tie(a.layer, a.rank) < std::tie(b.layer, b.rank);
  });
  return channels;
}

class ExrInput : public GuardedInput {
 public:
  explicit ExrInput(const std::string& file) : file_(file.c_str(), 0) {
    const Imf::Header& header = file_.header(0);
    const auto& window = header.dataWindow();
    spec_.width = window.max.x - window.min.x + 1;
    spec_.height = window.max.y - window.min.y + 1;
    spec_.deep = header.hasType() && Imf::isDeepData(header.type());
    if (header.hasTileDescription())
      spec_.rows_at_once = static_cast<int>(std::min<unsigned>(
          header.tileDescription().ySize, static_cast<unsigned>(std::max(spec_.height, 1))));
    left_ = window.min.x;
    top_ = window.min.y;
    channels_ = channels_of(header);
    describe_channels();
  }

  bool reads_it() const {
    return std::all_of(channels_.begin(), channels_.end(), [](const ExrChannel& c) { return c.full; });
  }

 protected:
  void read_rows(int begin, int end, int first, int count, float* target) override {
    if (!part_) part_ = std::make_unique<Imf::InputPart>(file_, 0);
    Imf::FrameBuffer frame;
    const std::size_t x_stride = static_cast<std::size_t>(count) * sizeof(float);
    const std::size_t y_stride = x_stride * static_cast<std::size_t>(spec_.width);
    for (int c = 0; c < count; ++c) {
      const ExrChannel& channel = channels_[static_cast<std::size_t>(first + c)];
      if (channel.type == Imf::UINT)
        throw std::runtime_error("channel " + channel.name + " has whole numbers, no light");
      // OpenEXR adds coordinates times strides, which may be negative: wrap-around is intended.
      const uintptr_t base = reinterpret_cast<uintptr_t>(target + c) -
                             static_cast<uintptr_t>(int64_t{left_}) * x_stride -
                             static_cast<uintptr_t>(int64_t{top_} + begin) * y_stride;
      frame.insert(channel.name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(base), x_stride, y_stride));
    }
    part_->setFrameBuffer(frame);
    part_->readPixels(top_ + begin, top_ + end - 1);
  }

 private:
  void describe_channels() {
    bool light = false, half = true;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      const ExrChannel& channel = channels_[i];
      spec_.channels.push_back(channel.name);
      light |= channel.type != Imf::UINT;
      half &= channel.type == Imf::HALF;
      const std::string suffix =
          channel.layer.empty() ? channel.name : channel.name.substr(channel.layer.size() + 1);
      if (spec_.alpha_channel < 0 && (suffix == "A" || suffix == "Alpha"))
        spec_.alpha_channel = static_cast<int>(i);
    }
    spec_.kind = light ? Kind::kLinear : Kind::kOther;
    spec_.type_name = !light ? "uint" : half ? "half" : "float";
  }

  Imf::MultiPartInputFile file_;
  std::unique_ptr<Imf::InputPart> part_;
  std::vector<ExrChannel> channels_;
  int left_ = 0, top_ = 0;
};

}  // namespace

std::unique_ptr<PictureInput> open_exr(const std::string& file) {
  auto input = std::make_unique<ExrInput>(file);
  if (!input->reads_it()) return nullptr;
  return input;
}

}  // namespace kiloband
