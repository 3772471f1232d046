// PNG by libpng, whose errors are jumps: the function that a jump may leave holds nothing that would have to be destroyed.
#include <png.h>

#include <csetjmp>
#include <new>
#include <stdexcept>

#include "base/error.hpp"
#include "pictures/picture_library.hpp"

namespace kiloband {
namespace {

void append(png_structp png, png_bytep data, std::size_t bytes) {
  try {
    static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), bytes);
    return;
  } catch (const std::bad_alloc&) {  // must not pass libpng
  }
  png_error(png, "out of memory");
}

void flush_nothing(png_structp) {}

bool write_png(png_structp png, png_infop info, std::string* out, uint32_t width, uint32_t height,
               const uint8_t* rgb) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_write_fn(png, out, append, flush_nothing);
  png_set_IHDR(png, info, width, height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png, info);
  for (uint32_t y = 0; y < height; ++y) png_write_row(png, rgb + std::size_t{y} * width * 3);
  png_write_end(png, nullptr);
  return true;
}

}  // namespace

std::string png_file(uint32_t width, uint32_t height, const uint8_t* rgb) {
  if (width == 0 || height == 0 || width > PNG_USER_WIDTH_MAX || height > PNG_USER_HEIGHT_MAX)
    throw std::logic_error("png_file: a size that PNG does not have");
  std::string out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  const bool written = info && write_png(png, info, &out, width, height, rgb);
  png_destroy_write_struct(&png, &info);
  if (!written) throw DeviceError("out of memory for a picture");
  return out;
}

}  // namespace kiloband
