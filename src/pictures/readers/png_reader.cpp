// PNG by libpng. Its errors are jumps: functions that a jump may leave hold nothing that would have to be destroyed.
#include <png.h>

#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <new>
#include <stdexcept>
#include <vector>

#include "pictures/readers/c_file.hpp"
#include "pictures/readers/readers.hpp"
#include "pictures/readers/row_input.hpp"

namespace kiloband {
namespace {

constexpr std::size_t kMessageBytes = 256;

[[noreturn]] void keep_message(png_structp png, png_const_charp message) {
  std::snprintf(static_cast<char*>(png_get_error_ptr(png)), kMessageBytes, "%s", message);
  png_longjmp(png, 1);
}

void ignore_warning(png_structp, png_const_charp) {}

/// Header and transformations: samples of 8 or 16 bits, 1 to 4 channels.
bool begin_png(png_structp png, png_infop info, std::FILE* stream) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_init_io(png, stream);
  png_read_info(png, info);
  png_set_expand(png);  // palettes to colours, few bits to 8, transparent colours to alpha
  png_set_swap(png);    // 16 bits as this machine has them
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  return true;
}

bool read_png_row(png_structp png, unsigned char* row) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_row(png, row, nullptr);
  return true;
}

bool read_png_image(png_structp png, unsigned char** rows) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_image(png, rows);
  return true;
}

/// What follows the last row: checksums of the data.
bool end_png(png_structp png) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_end(png, nullptr);
  return true;
}

struct Png {
  explicit Png(char* message)
      : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, message, keep_message, ignore_warning)) {
    if (png) info = png_create_info_struct(png);
    if (info) return;
    png_destroy_read_struct(&png, nullptr, nullptr);
    throw std::bad_alloc();
  }
  ~Png() { png_destroy_read_struct(&png, &info, nullptr); }
  Png(const Png&) = delete;
  Png& operator=(const Png&) = delete;

  png_structp png;
  png_infop info = nullptr;
};

class PngDecoder : public RowDecoder {
 public:
  explicit PngDecoder(const std::string& name) : file_(name), handle_(message_) {
    const auto [png, info] = std::pair(handle_.png, handle_.info);
    if (!begin_png(png, info, file_.stream())) throw std::runtime_error(message_);
    spec_.width = static_cast<int>(png_get_image_width(png, info));
    spec_.height = static_cast<int>(png_get_image_height(png, info));
    spec_.kind = PictureInput::Kind::kEncoded;
    interlaced_ = png_get_interlace_type(png, info) != PNG_INTERLACE_NONE;
    wide_ = png_get_bit_depth(png, info) == 16;
    spec_.type_name = wide_ ? "uint16" : "uint8";
    name_channels(spec_, png_get_channels(png, info));
    row_bytes_ = png_get_rowbytes(png, info);
  }

  static bool reads_it() { return true; }
  const PictureInput::Spec& spec() const override { return spec_; }

  void next_row(float* target) override {
    if (next_ == 0 && interlaced_) read_whole();
    if (!interlaced_) {
      bytes_.resize(row_bytes_);
      if (!read_png_row(handle_.png, bytes_.data())) throw std::runtime_error(message_);
    }
    if (next_ + 1 == spec_.height && !end_png(handle_.png)) throw std::runtime_error(message_);
    convert(bytes_.data() + (interlaced_ ? static_cast<std::size_t>(next_) * row_bytes_ : 0), target);
    ++next_;
  }

 private:
  void read_whole() {
    bytes_.resize(row_bytes_ * static_cast<std::size_t>(spec_.height));
    std::vector<unsigned char*> rows(static_cast<std::size_t>(spec_.height));
    for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = bytes_.data() + y * row_bytes_;
    if (!read_png_image(handle_.png, rows.data())) throw std::runtime_error(message_);
  }

  void convert(const unsigned char* row, float* target) const {
    const std::size_t samples = static_cast<std::size_t>(spec_.width) * spec_.channels.size();
    for (std::size_t i = 0; i < samples; ++i) {
      if (!wide_) {
        target[i] = static_cast<float>(row[i]) * (1.0f / 255);
        continue;
      }
      uint16_t value;
      std::memcpy(&value, row + 2 * i, sizeof value);
      target[i] = static_cast<float>(value) * (1.0f / 65535);
    }
  }

  CFile file_;
  char message_[kMessageBytes] = "";
  Png handle_;
  PictureInput::Spec spec_;
  bool wide_ = false, interlaced_ = false;
  std::size_t row_bytes_ = 0;
  std::vector<unsigned char> bytes_;  // a row; of interlaced files all of them
  int next_ = 0;
};

}  // namespace

std::unique_ptr<PictureInput> open_png(const std::string& file) {
  return open_rows<PngDecoder>(file);
}

}  // namespace kiloband
