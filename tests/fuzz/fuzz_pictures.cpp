// Pictures that the program reads by itself, but EXR, which fuzz_exr_cube reads.
#include <algorithm>
#include <stdexcept>
#include <vector>

#include "base/error.hpp"
#include "pictures/readers/readers.hpp"
#include "scene/image/format.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace kiloband::fuzz {
namespace {

std::unique_ptr<PictureInput> open(const ImageFile& image) {
  try {
    switch (image.format) {
      case ImageFormat::kHdr:
        return open_radiance(image.name);
      case ImageFormat::kPng:
        return open_png(image.name);
      case ImageFormat::kJpeg:
        return open_jpeg(image.name);
      case ImageFormat::kPnm:
        if (auto input = open_pfm(image.name)) return input;
        return open_pnm(image.name);
      default:
        return nullptr;
    }
  } catch (const std::runtime_error& reason) {
    image.fail(reason.what());
  }
}

void read(PictureInput& input, const ImageFile& image) {
  const PictureInput::Spec& spec = input.spec();
  const std::size_t channels = spec.channels.size(), width = static_cast<std::size_t>(spec.width);
  promise(channels >= 1 && channels <= 4 && spec.alpha_channel < static_cast<int>(channels), "channels");
  for (int row = 0; row < spec.height; row += spec.rows_at_once) {
    const int end = std::min(spec.height, row + spec.rows_at_once);
    std::vector<float> values(static_cast<std::size_t>(end - row) * width * channels);
    if (!input.read(row, end, 0, static_cast<int>(channels), values.data())) image.fail(input.error());
    if (spec.kind == PictureInput::Kind::kEncoded)
      promise(std::all_of(values.begin(), values.end(), [](float v) { return v >= 0 && v <= 1; }),
              "samples in [0, 1]");
  }
}

}  // namespace

void picture(std::string_view bytes) {
  const auto file = scratch_file("picture", bytes);
  accept_or_refuse([&] {
    const ImageFile image = examine_image(file);
    const auto input = open(image);
    if (!input) image.fail("left to others");
    check_image_size(image, input->spec().width, input->spec().height);
    read(*input, image);
  });
}

}  // namespace kiloband::fuzz
