// Images that are wrong: exact messages where they are ours, and never a picture from half a file.
#include <gtest/gtest.h>

#include <limits>

#include "image_support.hpp"
#include "scene/image/image.hpp"
#include "tests/support/mutations.hpp"

namespace kiloband::test {
namespace {

const float kNan = std::numeric_limits<float>::quiet_NaN();
const float kInfinity = std::numeric_limits<float>::infinity();

struct BrokenImages : testing::Test {
  TemporaryFolder folder;
  std::string error(const std::filesystem::path& path) {
    return error_of(folder, [&] { read_image(path, false); });
  }
  std::string error_of_bytes(const std::string& name, const std::string& bytes) {
    return error(folder.write(name, bytes));
  }
};

TEST_F(BrokenImages, Files) {
  EXPECT_EQ(error(folder / "none.exr"), "none.exr: no such file");
  std::filesystem::create_directory(folder / "folder.png");
  EXPECT_EQ(error(folder / "folder.png"), "folder.png: not a regular file");
  EXPECT_EQ(error_of_bytes("a.png", ""), "a.png: the file is empty");
  EXPECT_EQ(error_of_bytes("a.png", "hello"),
            "a.png: not an image of a known format (EXR, HDR, PNG, JPEG, TIFF, BMP, PNM, PFM, TGA)");
  EXPECT_EQ(error_of_bytes("a.jpg", "\xff\xd8\xff\xe0"), "a.jpg: the JPEG data is truncated: no end marker");
  EXPECT_EQ(error_of_bytes("b.png", "\x89PNG\r\n\x1a\n"), "b.png: the PNG data is truncated: no end chunk");
}

TEST_F(BrokenImages, Values) {
  const auto write = [&](float value) {
    std::vector<float> pixels(4 * 3 * 3, 0.5f);
    pixels[(2 * 4 + 1) * 3 + 2] = value;
    return write_image(folder / "a.exr", 4, 3, kRgb, pixels, OIIO::TypeFloat);
  };
  EXPECT_EQ(error(write(0.0f)), "accepted");
  EXPECT_EQ(error(write(-0.25f)),
            "a.exr: pixel (1, 2), channel 2: -0.25: must be finite and >= 0 (down to -0.00486, 1 % of the "
            "mean, is taken as 0)");
  EXPECT_EQ(error(write(kNan)), "a.exr: pixel (1, 2), channel 2: nan: must be finite and >= 0");
  EXPECT_EQ(error(write(kInfinity)), "a.exr: pixel (1, 2), channel 2: inf: must be finite and >= 0");
  EXPECT_EQ(error(write_image(folder / "b.exr", 1, 1, kRgb, {0, -1e-30f, 0}, OIIO::TypeFloat)),
            "b.exr: pixel (0, 0), channel 1: -1e-30: must be finite and >= 0");
}

TEST_F(BrokenImages, SlightlyNegativeValuesAreTakenAsZero) {
  const std::vector<float> pixels = {1, -5e-6f, 0.5f, -1e-3f, 1, -2e-3f, 1, 1, 1};
  const auto path = write_image(folder / "a.exr", 3, 1, kRgb, pixels, OIIO::TypeFloat);
  Messages messages;
  const Image image = read_image(path, false, messages.lines());
  EXPECT_EQ(image.pixels, (std::vector<float>{1, 0, 0.5f, 0, 1, 0, 1, 1, 1}));
  EXPECT_EQ(image.lowest, -2e-3f);
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_EQ(messages.texts[0],
            path.string() +
                ": warning: 2 texels are slightly negative and taken as 0, the lowest at pixel (1, 0), "
                "channel 2: -0.002");
  // The mean decides, not the maximum: one bright texel excuses little.
  std::vector<float> sun(3000, 0.01f);
  sun[0] = 1000;
  sun[4] = -0.01f;
  EXPECT_EQ(error(write_image(folder / "sun.exr", 1000, 1, kRgb, sun, OIIO::TypeFloat)),
            "sun.exr: pixel (1, 0), channel 1: -0.01: must be finite and >= 0 (down to -0.00343, 1 % of the "
            "mean, is taken as 0)");
}

TEST_F(BrokenImages, Channels) {
  const auto write = [&](const std::vector<std::string>& names) {
    return write_image(folder / "a.exr", 1, 1, names, std::vector<float>(names.size(), 1.0f),
                       OIIO::TypeFloat);
  };
  EXPECT_EQ(error(write({"X", "Y", "Z"})), "a.exr: channels X, Y, Z: must be R, G, B, or Y, or a single one");
  EXPECT_EQ(error(write({"s0", "s1", "s2", "s3", "s4", "s5", "s6", "s7", "s8"})),
            "a.exr: channels s0, s1, s2, s3, s4, s5, s6, s7, ...: must be R, G, B, or Y, or a single one");
  EXPECT_EQ(error(write({"S0.400nm", "S0.500nm"})),
            "a.exr: channels S0.400nm, S0.500nm: must be R, G, B, or Y, or a single one; spectral_bitmap and "
            "spectral_envmap read bands");
}

TEST_F(BrokenImages, PixelTypes) {
  EXPECT_EQ(error(write_image(folder / "a.exr", 1, 1, kRgb, {1, 1, 1}, OIIO::TypeUInt32)),
            "a.exr: pixels of type uint are not supported");
}

TEST_F(BrokenImages, HugeSizesCostNothing) {
  EXPECT_EQ(error_of_bytes("a.pfm", "PF\n100000 100000\n-1\n"),
            "a.pfm: 100000 x 100000 pixels: each dimension must be in 1..65535");
  const std::string start = error_of_bytes("b.pfm", "PF\n65535 65535\n-1\n");
  EXPECT_EQ(start.substr(0, 22), "b.pfm: cannot be read:");
}

/// Good files of every format, large enough to be written in several blocks.
std::vector<std::filesystem::path> good_files(const TemporaryFolder& folder) {
  std::vector<float> values(128 * 96 * 3);
  std::mt19937 random(5);
  for (float& value : values) value = std::uniform_real_distribution<float>(0, 1)(random);
  const auto write = [&](const char* name, OIIO::TypeDesc type,
                         const std::function<void(OIIO::ImageSpec&)>& adjust = {}) {
    return write_image(folder / name, 128, 96, kRgb, values, type, adjust);
  };
  const auto compression = [](const char* name) {
    return [name](OIIO::ImageSpec& spec) { spec["compression"] = name; };
  };
  const auto tiles = [](OIIO::ImageSpec& spec) { spec.tile_width = spec.tile_height = 32; };
  return {write("none.exr", OIIO::TypeFloat, compression("none")),
          write("zip.exr", OIIO::TypeHalf, compression("zip")),
          write("piz.exr", OIIO::TypeHalf, compression("piz")),
          write("tiles.exr", OIIO::TypeHalf, tiles),
          write("a.hdr", OIIO::TypeFloat),
          write("a.png", OIIO::TypeUInt8),
          write("b.png", OIIO::TypeUInt16),
          write("a.jpg", OIIO::TypeUInt8),
          write("a.tif", OIIO::TypeUInt8),
          write("b.tif", OIIO::TypeFloat, tiles),
          write("c.tif", OIIO::TypeUInt8, compression("none")),
          write("d.tif", OIIO::TypeUInt16, compression("lzw")),
          write("a.bmp", OIIO::TypeUInt8),
          write("a.ppm", OIIO::TypeUInt8),
          write("a.tga", OIIO::TypeUInt8)};
}

TEST_F(BrokenImages, TruncatedAtEveryEighthAndByOneBlock) {
  for (const auto& path : good_files(folder)) {
    const std::string whole = read_file(path);
    ASSERT_EQ(error(path), "accepted") << path;
    std::vector<size_t> sizes = {whole.size() - 1000};
    for (size_t eighth = 1; eighth < 8; ++eighth) sizes.push_back(whole.size() * eighth / 8);
    for (const size_t size : sizes) {
      const std::string text = error_of_bytes("cut" + path.extension().string(), whole.substr(0, size));
      EXPECT_EQ(text.substr(0, 4 + path.extension().string().size()), "cut" + path.extension().string() + ":")
          << path << " cut to " << size << " of " << whole.size();
    }
  }
}

// Formats with a checksum over their data: damage in the middle is refused.
TEST_F(BrokenImages, DamageUnderAChecksumIsNoticed) {
  for (const auto& path : good_files(folder)) {
    const std::string name = path.filename().string();
    if (name != "zip.exr" && name != "a.png" && name != "a.tif") continue;
    std::string bytes = read_file(path);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
    EXPECT_EQ(error_of_bytes(name, bytes).substr(0, name.size() + 16), name + ": cannot be read") << name;
  }
}

// Damage inside: a picture of the stated size, or InputError.
TEST_F(BrokenImages, Mutations) {
  for (const auto& path : good_files(folder)) {
    SCOPED_TRACE(path.string());
    use_mutants(
        read_file(path), {.times = 60, .head = 400, .longest_seconds = 10}, [&](const std::string& mutant) {
          const Image image = read_image(folder.write("bad" + path.extension().string(), mutant), false);
          EXPECT_EQ(image.pixels.size(), size_t(image.width) * image.height * image.channels);
        });
  }
}

}  // namespace
}  // namespace kiloband::test
