// PNM of whole numbers: "P2", "P5" (grey) and "P3", "P6" (RGB), of which P2 and P3 are text; width, height, the largest value, rows from the
// top down. Values are scaled to 8 bits, or to 16 if the largest is above 255 (two bytes each, high byte first), rounded down.
#include <algorithm>
#include <cctype>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "base/number.hpp"
#include "base/text.hpp"
#include "pictures/readers/byte_file.hpp"
#include "pictures/readers/readers.hpp"
#include "pictures/readers/row_input.hpp"

namespace kiloband {
namespace {

class PnmDecoder : public RowDecoder {
 public:
  explicit PnmDecoder(const std::string& name) : file_(name) {
    const std::string kind{static_cast<char>(file_.byte()), static_cast<char>(file_.byte())};
    text_ = kind == "P2" || kind == "P3";
    reads_it_ = text_ || kind == "P5" || kind == "P6";
    if (!reads_it_) return;
    spec_.width = read_number("a size", INT32_MAX);
    spec_.height = read_number("a size", INT32_MAX);
    largest_ = read_number("a largest value", 65535);
    if (largest_ == 0) throw std::runtime_error("the largest value is 0");
    name_channels(spec_, kind == "P3" || kind == "P6" ? 3 : 1);
    spec_.kind = PictureInput::Kind::kEncoded;
    spec_.type_name = wide() ? "uint16" : "uint8";
  }

  bool reads_it() const { return reads_it_; }
  const PictureInput::Spec& spec() const override { return spec_; }

  void next_row(float* target) override {
    const std::size_t samples = static_cast<std::size_t>(spec_.width) * spec_.channels.size();
    if (!text_) read_bytes(samples);
    const int most = wide() ? 65535 : 255;
    const float unit = 1.0f / static_cast<float>(most);
    for (std::size_t i = 0; i < samples; ++i) {
      const int value = text_ ? read_number("a value", largest_) : stored(i);
      if (value > largest_)
        throw std::runtime_error("the value " + std::to_string(value) + " is above the largest, " +
                                 std::to_string(largest_));
      target[i] = static_cast<float>(int64_t{value} * most / largest_) * unit;
    }
  }

 private:
  bool wide() const { return largest_ > 255; }

  void read_bytes(std::size_t samples) {
    bytes_.resize(samples * (wide() ? 2 : 1));
    if (!file_.read(bytes_.data(), bytes_.size())) throw std::runtime_error("the data is truncated");
  }

  int stored(std::size_t i) const { return wide() ? bytes_[2 * i] * 256 + bytes_[2 * i + 1] : bytes_[i]; }

  /// The next word, between 0 and `most`, and the one byte of space that ends it; from # on lines are comments.
  int read_number(const char* what, int most) {
    std::string word;
    int c = file_.byte();
    for (bool comment = false; c >= 0 && (comment || c == '#' || std::isspace(c)); c = file_.byte())
      comment = c == '#' || (comment && c != '\n');
    for (; c >= 0 && !std::isspace(c) && word.size() < 16; c = file_.byte()) word += static_cast<char>(c);
    if (word.empty()) throw std::runtime_error("the data is truncated");
    const auto number = whole_number<int>(word);
    if (!number || *number < 0 || *number > most)
      throw std::runtime_error(quote_text(word) + " is not " + what + " between 0 and " +
                               std::to_string(most));
    return *number;
  }

  ByteFile file_;
  PictureInput::Spec spec_;
  bool reads_it_ = false, text_ = false;
  int largest_ = 0;
  std::vector<unsigned char> bytes_;
};

}  // namespace

std::unique_ptr<PictureInput> open_pnm(const std::string& file) {
  return open_rows<PnmDecoder>(file);
}

}  // namespace kiloband
