// Radiance pictures. G. Ward, "Real Pixels", Graphics Gems II; Radiance's color.c for both kinds of run lengths.
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "base/number.hpp"
#include "base/text.hpp"
#include "pictures/readers/byte_file.hpp"
#include "pictures/readers/readers.hpp"
#include "pictures/readers/row_input.hpp"

namespace kiloband {
namespace {

using Rgbe = std::array<unsigned char, 4>;

constexpr int kLeastRunWidth = 8, kMostRunWidth = 0x7fff;  // rows with run lengths per component

class RadianceDecoder : public RowDecoder {
 public:
  explicit RadianceDecoder(const std::string& name) : file_(name) {
    file_.line();  // the signature
    for (std::string line = file_.line(); !line.empty(); line = file_.line()) {
      if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
        throw std::runtime_error("pixels must be 32-bit_rle_rgbe, not " + quote_text(line.substr(7)));
    }
    read_size(file_.line());
    for (int e = 1; e < 256; ++e) units_[static_cast<std::size_t>(e)] = std::ldexp(1.0f, e - (128 + 8));
    name_channels(spec_, 3);
    spec_.kind = PictureInput::Kind::kLinear;
    spec_.type_name = "float";
  }

  static bool reads_it() { return true; }
  const PictureInput::Spec& spec() const override { return spec_; }

  void next_row(float* target) override {
    row_.resize(static_cast<std::size_t>(spec_.width));
    if (!read_row())
      throw std::runtime_error("the data of row " + std::to_string(next_) + " is damaged or truncated");
    ++next_;
    for (const Rgbe& pixel : row_) {
      for (std::size_t c = 0; c < 3; ++c) *target++ = static_cast<float>(pixel[c]) * units_[pixel[3]];
    }
  }

 private:
  void read_size(const std::string& line) {
    std::istringstream words(line);
    std::string down, right, rows, columns;
    words >> down >> rows >> right >> columns;
    const auto height = whole_number<int>(rows), width = whole_number<int>(columns);
    if (!height || !width) throw std::runtime_error(quote_text(line) + " is no size");
    if (down != "-Y" || right != "+X")
      throw std::runtime_error("rows must run from the top, left to right (-Y H +X W), not " +
                               quote_text(line));
    spec_.width = *width;
    spec_.height = *height;
  }

  bool read_row() {
    Rgbe head;
    if (spec_.width < kLeastRunWidth || spec_.width > kMostRunWidth) return read_plain(0);
    if (!file_.read(head.data(), 4)) return false;
    if (head[0] == 2 && head[1] == 2 && head[2] < 128)
      return head[2] * 256 + head[3] == spec_.width && read_components();
    row_[0] = head;
    return read_plain(1);
  }

  /// Pixels from x on; mantissas of 1 say that the pixel before is repeated, as often as the exponent says; one such after the
  /// other gives higher digits. (True mantissas of 1, 1, 1 are not normalised: none is written.)
  bool read_plain(std::size_t x) {
    int shift = 0;
    while (x < row_.size()) {
      if (!file_.read(row_[x].data(), 4)) return false;
      const Rgbe pixel = row_[x];
      if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1 || x == 0) {
        shift = 0;
        ++x;
        continue;
      }
      const std::size_t run = shift < 32 ? std::size_t{pixel[3]} << shift : row_.size() + 1;
      if (run > row_.size() - x) return false;
      std::fill_n(row_.begin() + static_cast<std::ptrdiff_t>(x), run, row_[x - 1]);
      x += run;
      shift += 8;
    }
    return true;
  }

  /// Component by component, in runs (128 + n, value) and lists (n, values).
  bool read_components() {
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t x = 0; x < row_.size();) {
        const int code = file_.byte();
        if (code <= 0) return false;
        const std::size_t count = static_cast<std::size_t>(code > 128 ? code - 128 : code);
        if (count > row_.size() - x) return false;
        int value = code > 128 ? file_.byte() : 0;
        for (std::size_t i = 0; i < count && value >= 0; ++i, ++x) {
          if (code <= 128) value = file_.byte();
          row_[x][c] = static_cast<unsigned char>(value);
        }
        if (value < 0) return false;
      }
    }
    return true;
  }

  ByteFile file_;
  PictureInput::Spec spec_;
  std::array<float, 256> units_{};  // of a mantissa, by exponent; exponent 0 is black
  std::vector<Rgbe> row_;
  int next_ = 0;
};

}  // namespace

std::unique_ptr<PictureInput> open_radiance(const std::string& file) {
  return open_rows<RadianceDecoder>(file);
}

}  // namespace kiloband
