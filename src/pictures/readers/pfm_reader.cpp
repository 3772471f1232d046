// Portable float maps: "PF" (RGB) or "Pf" (grey), width, height, a scale whose sign is the byte order (negative: little-endian),
// and rows from the bottom up. Values are multiplied by the scale's amount.
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "base/number.hpp"
#include "base/text.hpp"
#include "pictures/readers/byte_file.hpp"
#include "pictures/readers/readers.hpp"
#include "pictures/readers/row_input.hpp"

namespace kiloband {
namespace {

static_assert(std::endian::native == std::endian::little);

class PfmDecoder : public RowDecoder {
 public:
  explicit PfmDecoder(const std::string& name) : file_(name) {
    const std::string kind{static_cast<char>(file_.byte()), static_cast<char>(file_.byte())};
    reads_it_ = kind == "PF" || kind == "Pf";
    if (!reads_it_) return;
    spec_.width = read_size();
    spec_.height = read_size();
    const std::string text = word();
    float scale = 0;
    if (read_number(text, scale) != NumberText::kNumber || scale == 0 || !std::isfinite(scale))
      throw std::runtime_error(quote_text(text) + " is no scale");
    scale_ = std::abs(scale);
    swapped_ = scale > 0;
    first_ = file_.position();
    name_channels(spec_, kind == "PF" ? 3 : 1);
    spec_.kind = PictureInput::Kind::kLinear;
    spec_.type_name = "float";
  }

  bool reads_it() const { return reads_it_; }
  const PictureInput::Spec& spec() const override { return spec_; }

  void next_row(float* target) override {
    const std::size_t samples = static_cast<std::size_t>(spec_.width) * spec_.channels.size();
    const std::size_t row = static_cast<std::size_t>(spec_.height - 1 - next_++);
    file_.seek(first_ + static_cast<std::streamoff>(row * samples * sizeof(float)));
    if (!file_.read(target, samples * sizeof(float))) throw std::runtime_error("the data is truncated");
    for (std::size_t i = 0; i < samples; ++i) {
      if (swapped_) target[i] = std::bit_cast<float>(__builtin_bswap32(std::bit_cast<uint32_t>(target[i])));
      target[i] *= scale_;
    }
  }

 private:
  /// The next word and the one byte of space that ends it.
  std::string word() {
    std::string text;
    for (int c = file_.byte(); c >= 0 && text.size() < 64; c = file_.byte()) {
      if (!std::isspace(c))
        text += static_cast<char>(c);
      else if (!text.empty())
        return text;
    }
    throw std::runtime_error("the header ends too early");
  }

  int read_size() {
    const std::string text = word();
    const auto size = whole_number<int>(text);
    if (!size) throw std::runtime_error(quote_text(text) + " is no size");
    return *size;
  }

  ByteFile file_;
  PictureInput::Spec spec_;
  bool reads_it_ = false, swapped_ = false;
  float scale_ = 1;
  std::streamoff first_ = 0;  // where the bottom row begins
  int next_ = 0;
};

}  // namespace

std::unique_ptr<PictureInput> open_pfm(const std::string& file) {
  return open_rows<PfmDecoder>(file);
}

}  // namespace kiloband
