#include "samples.hpp"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <png.h>

#include <cstdio>
#include <random>
#include <stdexcept>

#include "pictures/readers/jpeg.hpp"

namespace kiloband::test {
namespace {

std::vector<unsigned char> random_bytes(std::size_t count, unsigned below = 256) {
  std::mt19937 random(static_cast<unsigned>(count));
  std::vector<unsigned char> bytes(count);
  for (unsigned char& byte : bytes) byte = static_cast<unsigned char>(random() % below);
  return bytes;
}

std::FILE* open_for_writing(const std::filesystem::path& file) {
  std::FILE* const stream = std::fopen(file.c_str(), "wb");
  if (!stream) throw std::runtime_error("cannot write " + file.string());
  return stream;
}

void set_palette(png_structp png, png_infop info, bool alpha) {
  const std::vector<unsigned char> values = random_bytes(16 * 3);
  png_color colours[16];
  for (std::size_t i = 0; i < 16; ++i) colours[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  png_set_PLTE(png, info, colours, 16);
  const unsigned char opacity[5] = {0, 10, 77, 200, 255};
  if (alpha) png_set_tRNS(png, info, opacity, 5, nullptr);
}

}  // namespace

void write_png_sample(const std::filesystem::path& file, const PngSample& sample) {
  std::FILE* const stream = open_for_writing(file);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, stream);
  const auto width = static_cast<png_uint_32>(sample.width), height = static_cast<png_uint_32>(sample.height);
  png_set_IHDR(png, info, width, height, sample.bits, sample.colour_type,
               sample.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  const bool palette = sample.colour_type == PNG_COLOR_TYPE_PALETTE;
  if (palette) set_palette(png, info, sample.palette_alpha);
  const png_color_16 colour{0, 1, 2, 3, 1};
  if (sample.transparent) png_set_tRNS(png, info, nullptr, 0, &colour);
  if (sample.gamma) png_set_gAMA(png, info, 0.7);
  png_write_info(png, info);
  const std::size_t row = png_get_rowbytes(png, info);
  // Few values, so that the transparent colour occurs.
  std::vector<unsigned char> bytes =
      random_bytes(row * height, palette && sample.bits == 8              ? 16
                                 : sample.transparent && sample.bits == 8 ? 4
                                                                          : 256);
  std::vector<png_bytep> rows;
  for (std::size_t y = 0; y < height; ++y) rows.push_back(bytes.data() + y * row);
  png_write_image(png, rows.data());
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  std::fclose(stream);
}

void write_jpeg_sample(const std::filesystem::path& file, int components, bool progressive,
                       int restart_rows) {
  constexpr int kWidth = 61, kHeight = 45;
  std::FILE* const stream = open_for_writing(file);
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  jpeg_stdio_dest(&jpeg, stream);
  jpeg.image_width = kWidth;
  jpeg.image_height = kHeight;
  jpeg.input_components = components;
  jpeg.in_color_space = components == 1 ? JCS_GRAYSCALE : components == 3 ? JCS_RGB : JCS_CMYK;
  jpeg_set_defaults(&jpeg);  // colours at half the resolution
  jpeg_set_quality(&jpeg, 77, TRUE);
  if (progressive) jpeg_simple_progression(&jpeg);
  jpeg.restart_in_rows = restart_rows;
  jpeg_start_compress(&jpeg, TRUE);
  std::vector<unsigned char> row(static_cast<std::size_t>(kWidth * components));
  for (int y = 0; y < kHeight; ++y) {
    for (int i = 0; i < kWidth * components; ++i)
      row[static_cast<std::size_t>(i)] =
          static_cast<unsigned char>(i * (1 + i % components) + y * (3 - i % components) * 2);
    unsigned char* pointer = row.data();
    jpeg_write_scanlines(&jpeg, &pointer, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  std::fclose(stream);
}

void write_luminance_chroma_exr(const std::filesystem::path& file) {
  std::vector<Imf::Rgba> pixels;
  for (int i = 0; i < 16 * 16; ++i)
    pixels.emplace_back(static_cast<float>(i) / 256, 0.5f, static_cast<float>(i % 16) / 16);
  Imf::RgbaOutputFile output(file.c_str(), 16, 16, Imf::WRITE_YC);
  output.setFrameBuffer(pixels.data(), 1, 16);
  output.writePixels(16);
}

void write_two_part_exr(const std::filesystem::path& file) {
  constexpr int kSize = 9;
  std::vector<Imf::Header> headers;
  for (const char* name : {"first", "second"}) {
    Imf::Header header(kSize, kSize);
    header.setName(name);
    header.setType(Imf::SCANLINEIMAGE);
    for (const char* channel : {"B", "G", "R"}) header.channels().insert(channel, Imf::Channel(Imf::HALF));
    header.channels().insert("id", Imf::Channel(Imf::UINT));
    headers.push_back(header);
  }
  Imf::MultiPartOutputFile output(file.c_str(), headers.data(), 2);
  for (int part = 0; part < 2; ++part) {
    std::vector<half> values(kSize * kSize * 3);
    const std::vector<unsigned int> ids(kSize * kSize, 7u);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<float>(i) * (part ? -1.0f : 0.25f);
    Imf::FrameBuffer frame;
    const std::size_t step = 3 * sizeof(half);
    for (std::size_t c = 0; c < 3; ++c)
      frame.insert(std::string(1, "RGB"[c]),
                   Imf::Slice(Imf::HALF, reinterpret_cast<char*>(&values[c]), step, step * kSize));
    frame.insert("id", Imf::Slice(Imf::UINT, reinterpret_cast<char*>(const_cast<unsigned*>(ids.data())),
                                  sizeof(unsigned), sizeof(unsigned) * kSize));
    Imf::OutputPart out(output, part);
    out.setFrameBuffer(frame);
    out.writePixels(kSize);
  }
}

}  // namespace kiloband::test
