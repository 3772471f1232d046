// Scenes that are right, but name files that are missing, truncated or wrong.
#include <gtest/gtest.h>

#include <cstring>

#include "tests/end_to_end/support/wrong_input.hpp"

namespace kiloband::test {
namespace {

std::string leaf(const std::string& parameter) {
  return complete_scene(R"xml(<bsdf type="diffuse" id="leaf">)xml" + parameter + "</bsdf>");
}

std::string mesh(const std::string& type, const std::string& file) {
  return complete_scene("<shape type=\"" + type + "\"><string name=\"filename\" value=\"" + file +
                        "\"/></shape>");
}

std::string environment(const std::string& file) {
  return scene_text("<emitter type=\"envmap\"><string name=\"filename\" value=\"" + file +
                    "\"/></emitter>\n" + kSensor + kSphere);
}

/// The bytes of a value as they lie in memory: the files below are little-endian.
template <typename T>
std::string bytes(T value) {
  std::string text(sizeof value, '\0');
  std::memcpy(text.data(), &value, sizeof value);
  return text;
}

std::string ply_header(const std::string& format, const std::string& vertices, int faces) {
  return "ply\nformat " + format + " 1.0\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(faces) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string radiance_image(const std::string& size, std::size_t pixels) {
  return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + size + "\n" + std::string(4 * pixels, '\x80');
}

void write_meshes(const TemporaryFolder& folder) {
  folder.write("empty.obj", "# nothing\n");
  folder.write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  folder.write("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 1 1 1\n");
  // A face of 13 bytes of which 5 are missing.
  folder.write("truncated.ply", ply_header("binary_little_endian", "3", 1) + std::string(36, '\0') + '\3' +
                                    std::string(7, '\0'));
  folder.write("truncated_ascii.ply", ply_header("ascii", "3", 1) + "0 0 0\n1 0 0\n");
  folder.write("index.ply", ply_header("ascii", "3", 1) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n");
  folder.write("huge.ply", ply_header("ascii", "4000000000", 1) + "0 0 0\n");
  folder.write("nofaces.ply", ply_header("ascii", "3", 0) + "0 0 0\n1 0 0\n0 1 0\n");
  folder.write("truncated.stl", std::string(80, '\0') + bytes<uint32_t>(2) + std::string(50, '\0'));
  const std::string serialized = bytes<uint16_t>(0x041C) + bytes<uint16_t>(4);
  folder.write("truncated.serialized", serialized + "\x78\x9c\x01");
  folder.write("notdeflate.serialized",
               serialized + "this is not deflate" + bytes<uint64_t>(0) + bytes<uint32_t>(1));
}

TEST(WrongFile, Meshes) {
  const TemporaryFolder folder;
  write_meshes(folder);
  expect_refused(
      folder,
      std::vector<WrongScene>{
          {"mesh none.obj", mesh("obj", "none.obj"), "broken.xml:2:50: error: file 'none.obj' not found"},
          {"mesh empty.obj", mesh("obj", "empty.obj"),
           "broken.xml:2:50: error: ./empty.obj: the mesh has no triangles"},
          {"mesh index.obj", mesh("obj", "index.obj"),
           "broken.xml:2:50: error: ./index.obj:4: f: corner '4': position index 4: must be in 1..3, the "
           "number of such lines above"},
          {"mesh nan.obj", mesh("obj", "nan.obj"),
           "broken.xml:2:50: error: ./nan.obj:1: v: 'nan' is not finite"},
          {"mesh flat.obj", mesh("obj", "flat.obj"),
           "broken.xml:2:50: error: ./flat.obj: 2 of 2 triangles have zero area: nothing is left to render"},
          {"mesh truncated.ply", mesh("ply", "truncated.ply"),
           "broken.xml:2:50: error: ./truncated.ply: byte 210: face 0: property 'vertex_indices': the file "
           "ends too early"},
          {"mesh truncated_ascii.ply", mesh("ply", "truncated_ascii.ply"),
           "broken.xml:2:50: error: ./truncated_ascii.ply:3: header: element 'vertex': 3 rows of at least 6 "
           "bytes, but only 12 bytes follow the header"},
          {"mesh index.ply", mesh("ply", "index.ply"),
           "broken.xml:2:50: error: ./index.ply:13: face 0: property 'vertex_indices': index 3: must be "
           "below 3, the number of vertices"},
          {"mesh huge.ply", mesh("ply", "huge.ply"),
           "broken.xml:2:50: error: ./huge.ply:3: header: element 'vertex': 4000000000 rows of at least 6 "
           "bytes, but only 6 bytes follow the header"},
          {"mesh nofaces.ply", mesh("ply", "nofaces.ply"),
           "broken.xml:2:50: error: ./nofaces.ply: the mesh has no triangles"},
          {"mesh truncated.stl", mesh("stl", "truncated.stl"),
           "broken.xml:2:50: error: ./truncated.stl: byte 80: 2 triangles need a file of 184 bytes, not of "
           "134 bytes"},
          {"mesh truncated.serialized", mesh("serialized", "truncated.serialized"),
           "broken.xml:2:57: error: ./truncated.serialized: too short for a serialized mesh: 7 bytes"},
          {"mesh notdeflate.serialized", mesh("serialized", "notdeflate.serialized"),
           "broken.xml:2:57: error: ./notdeflate.serialized: byte 6: bad zlib stream: incorrect header "
           "check"},
      });
}

TEST(WrongFile, Images) {
  const TemporaryFolder folder;
  folder.write("word.spd", "400 0.1\n500 high\n");
  folder.write("truncated.hdr", radiance_image("-Y 2 +X 4", 3));
  folder.write("huge.hdr", radiance_image("-Y 100000 +X 100000", 4));
  folder.write("one.hdr", radiance_image("-Y 1 +X 1", 1));
  // Signature and IHDR of a 4 x 4 image (checksum of zlib's crc32), then nothing.
  folder.write(
      "truncated.png",
      std::string("\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\x04\0\0\0\x04\x08\x02\0\0\0\x26\x93\x09\x29", 33));
  folder.write("scene.xml", complete_scene(""));
  ASSERT_EQ(run_program(folder,
                        quiet_render("scene.xml", {"--spp", "1", "--bands", "400:700:4", "-o", "whole.exr"}))
                .code,
            0);
  folder.write("truncated.exr", folder.read("whole.exr").substr(0, 2000));
  expect_refused(
      folder,
      std::vector<WrongScene>{
          {"environment none.exr", environment("none.exr"),
           "broken.xml:2:55: error: file 'none.exr' not found"},
          {"environment truncated.exr", environment("truncated.exr"),
           "broken.xml:2:55: error: ./truncated.exr: cannot be read: Failed OpenEXR read: Error reading "
           "pixel data from image file \"./truncated.exr\". Unexpected end of file."},
          {"environment truncated.hdr", environment("truncated.hdr"),
           "broken.xml:2:55: error: ./truncated.hdr: cannot be read: Read error reading pixels on scanline "
           "0"},
          {"environment word.spd", environment("word.spd"),
           "broken.xml:2:55: error: ./word.spd: not an image of a known format (EXR, HDR, PNG, JPEG, TIFF, "
           "BMP, PNM, PFM, TGA)"},
          {"environment huge.hdr", environment("huge.hdr"),
           "broken.xml:2:55: error: ./huge.hdr: 100000 x 100000 pixels: each dimension must be in 1..65535"},
          {"environment one.hdr", environment("one.hdr"),
           "broken.xml:2:55: error: envmap emitter: an environment map needs at least 2 x 2 pixels, "
           "'one.hdr' has 1 x 1"},
          {"bitmap truncated",
           leaf(
               R"xml(<texture type="bitmap" name="reflectance"><string name="filename" value="truncated.png"/></texture>)xml"),
           "broken.xml:2:105: error: ./truncated.png: the PNG data is truncated: no end chunk"},
      });
}

TEST(WrongFile, ScenesAndSpectra) {
  const TemporaryFolder folder;
  folder.write("loop.xml", "<scene version=\"3.0.0\">\n<include filename=\"loop.xml\"/></scene>");
  folder.write("bad.xml", "<scene version=\"3.0.0\">\n<bsdf typ=\"x\"/>\n</scene>");
  folder.write("empty.spd", "# nothing\n");
  folder.write("word.spd", "400 0.1\n500 high\n");
  folder.write("zigzag.spd", "400 0.1\n500 0.2\n450 0.1\n");
  folder.write("bright.spd", "400 0.1\n500 1.2\n");
  folder.write("reversed.csv", "min_nm,max_nm\n400,450\n500,450\n");
  expect_refused(
      folder,
      std::vector<WrongScene>{
          {"missing spectrum file", leaf(R"xml(<spectrum name="reflectance" filename="none.spd"/>)xml"),
           "broken.xml:2:71: error: file 'none.spd' not found"},
          {"spectrum file without data", leaf(R"xml(<spectrum name="reflectance" filename="empty.spd"/>)xml"),
           "broken.xml:2:71: error: ./empty.spd: no data"},
          {"spectrum file with a word", leaf(R"xml(<spectrum name="reflectance" filename="word.spd"/>)xml"),
           "broken.xml:2:71: error: ./word.spd:2: 'high' is not a number"},
          {"spectrum file out of order",
           leaf(R"xml(<spectrum name="reflectance" filename="zigzag.spd"/>)xml"),
           "broken.xml:2:71: error: ./zigzag.spd:3: wavelength 450 nm after 500 nm: the order changes"},
          {"spectrum file above 1", leaf(R"xml(<spectrum name="reflectance" filename="bright.spd"/>)xml"),
           "broken.xml:2:71: error: bsdf 'leaf': reflectance 1.2 at 500 nm: must be in [0, 1]"},
          {"missing include", complete_scene(R"xml(<include filename="none.xml"/>)xml"),
           "broken.xml:2:20: error: file 'none.xml' not found"},
          {"cyclic include", complete_scene(R"xml(<include filename="loop.xml"/>)xml"),
           "./loop.xml:2:20: error: file 'loop.xml' includes itself"},
          {"error in an include", complete_scene(R"xml(<include filename="bad.xml"/>)xml"),
           "./bad.xml:2:7: error: <bsdf>: unknown attribute 'typ'; did you mean 'type'?"},
          {"broken band file of the film",
           scene_text(
               R"xml(<sensor type="perspective"><film type="bandfilm"><string name="bands_file" value="reversed.csv"/></film></sensor>)xml" +
               kLight + kSphere),
           "broken.xml:2:83: error: ./reversed.csv:3: the interval is reversed: 500 nm is above 450 nm"},
      });
}

}  // namespace
}  // namespace kiloband::test
