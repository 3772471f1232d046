// JPEG by libjpeg-turbo. Its errors are jumps: functions that a jump may leave hold nothing that would have to be destroyed.

#include <csetjmp>
#include <cstdio>
#include <stdexcept>
#include <vector>

#include "pictures/readers/c_file.hpp"
#include "pictures/readers/jpeg.hpp"
#include "pictures/readers/readers.hpp"
#include "pictures/readers/row_input.hpp"

namespace kiloband {
namespace {

struct Errors {
  jpeg_error_mgr manager;  // first, so that libjpeg's pointer is ours
  jmp_buf back;
  char message[JMSG_LENGTH_MAX];
};

[[noreturn]] void keep_message(j_common_ptr jpeg) {
  auto* errors = reinterpret_cast<Errors*>(jpeg->err);
  jpeg->err->format_message(jpeg, errors->message);
  std::longjmp(errors->back, 1);
}

/// Warnings (data that can be repaired) are no errors.
void ignore_message(j_common_ptr) {}

bool begin_jpeg(jpeg_decompress_struct& jpeg, Errors& errors, std::FILE* stream) {
  if (setjmp(errors.back)) return false;
  jpeg_create_decompress(&jpeg);
  jpeg_stdio_src(&jpeg, stream);
  jpeg_read_header(&jpeg, TRUE);
  return true;
}

bool start_jpeg(jpeg_decompress_struct& jpeg, Errors& errors) {
  if (setjmp(errors.back)) return false;
  jpeg_start_decompress(&jpeg);
  return true;
}

bool read_jpeg_row(jpeg_decompress_struct& jpeg, Errors& errors, unsigned char* row) {
  if (setjmp(errors.back)) return false;
  return jpeg_read_scanlines(&jpeg, &row, 1) == 1;
}

struct Jpeg : jpeg_decompress_struct {
  Jpeg() : jpeg_decompress_struct{} {}
  ~Jpeg() { jpeg_destroy_decompress(this); }
  Jpeg(const Jpeg&) = delete;
  Jpeg& operator=(const Jpeg&) = delete;
};

class JpegDecoder : public RowDecoder {
 public:
  explicit JpegDecoder(const std::string& name) : file_(name) {
    jpeg_.err = jpeg_std_error(&errors_.manager);
    errors_.manager.error_exit = keep_message;
    errors_.manager.output_message = ignore_message;
    if (!begin_jpeg(jpeg_, errors_, file_.stream())) throw std::runtime_error(errors_.message);
    spec_.width = static_cast<int>(jpeg_.image_width);
    spec_.height = static_cast<int>(jpeg_.image_height);
    spec_.kind = PictureInput::Kind::kEncoded;
    spec_.type_name = "uint8";
    name_channels(spec_, jpeg_.num_components == 1 ? 1 : 3);
  }

  bool reads_it() const { return jpeg_.out_color_space == JCS_GRAYSCALE || jpeg_.out_color_space == JCS_RGB; }
  const PictureInput::Spec& spec() const override { return spec_; }

  void next_row(float* target) override {
    row_.resize(static_cast<std::size_t>(spec_.width) * spec_.channels.size());
    if ((!started_ && !start_jpeg(jpeg_, errors_)) || !read_jpeg_row(jpeg_, errors_, row_.data()))
      throw std::runtime_error(errors_.message);
    started_ = true;
    for (const unsigned char value : row_) *target++ = static_cast<float>(value) * (1.0f / 255);
  }

 private:
  CFile file_;
  Errors errors_{};
  Jpeg jpeg_;
  PictureInput::Spec spec_;
  bool started_ = false;
  std::vector<unsigned char> row_;
};

}  // namespace

std::unique_ptr<PictureInput> open_jpeg(const std::string& file) {
  return open_rows<JpegDecoder>(file);
}

}  // namespace kiloband
