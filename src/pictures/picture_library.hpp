// Picture files. EXR, PNG, JPEG, Radiance, PFM and PNM are read by the program itself (readers/); OpenImageIO, which brings some 250
// shared libraries (0.2 s of a start), is a module that is loaded for what is left: TIFF, BMP, Targa, PNM bitmaps, and EXR and JPEG files
// whose channels are stored in an unusual way. What is built without it has everything but these.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace kiloband {

/// An open picture file. Rows count from the top, from 0.
class PictureInput {
 public:
  enum class Kind { kEncoded, kLinear, kOther };  // 8 and 16 bits; floating point; neither

  struct Spec {
    int width = 0, height = 0, depth = 1;
    bool deep = false;
    std::vector<std::string> channels;
    int alpha_channel = -1;  // -1: none
    int rows_at_once = 64;   // of a row of tiles, or what is good for files without
    Kind kind = Kind::kOther;
    std::string type_name;  // of a sample, for messages
  };

  virtual ~PictureInput() = default;
  virtual const Spec& spec() const = 0;
  /// Channels [first, first + count) of rows [begin, end) into target[row][x][channel]. False: error() says why.
  virtual bool read(int begin, int end, int first, int count, float* target) = 0;
  /// What was wrong last; may be empty or have several lines.
  virtual std::string error() = 0;
};

class PictureLibrary {
 public:
  virtual ~PictureLibrary() = default;
  /// format: the name of a reader, such as "png", so that no other reader sees the file. Alpha is left
  /// unassociated. Null: `error` says why, empty if there is no such reader.
  virtual std::unique_ptr<PictureInput> open(const std::string& format, const std::string& file,
                                             std::string& error) = 0;
  /// EXR files are read without threads from now on.
  virtual void spare_threads() = 0;
};

/// The program's own readers, and OpenImageIO for what they leave to it.
/// open() throws DeviceError  OpenImageIO is needed and cannot be loaded
PictureLibrary& picture_library();

/// OpenImageIO, loaded by the first call: from the program's folder, from ../lib/kiloband beside it, or from where it was
/// built.
/// throws DeviceError  it cannot be loaded: the linker's reason
PictureLibrary& oiio_library();

/// An sRGB PNG file of rgb[y][x][3].
/// throws DeviceError  not enough memory; std::logic_error  sizes that PNG does not have
std::string png_file(uint32_t width, uint32_t height, const uint8_t* rgb);

}  // namespace kiloband
